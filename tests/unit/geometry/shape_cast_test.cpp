#include "geometry/shape_cast.h"
#include "random_body.h"

#include <gtest/gtest.h>
#include <optional>

namespace lockwind {
namespace {

using reference::Body;
using reference::from_raw;
using reference::kConvexTypes;
using reference::Random;
using reference::random_body;
using reference::Vec;

constexpr double kGap = static_cast<double>(kCastGap) * 0x1p-32;
constexpr double kGapMost = static_cast<double>(kCastGapMost) * 0x1p-32;
constexpr double kError = 2e-6;

struct Sweep {
    Body shape;
    Body body;
    Vec start; // from the body's centre
    Vec way;

    double distance_at(double fraction) const {
        return reference::distance(body, shape, start + way * fraction);
    }
};

std::optional<ConvexCastHit> cast(const Sweep& sweep, const Vec& centre = {0, 0, 0}) {
    ConvexCore shape{};
    ConvexCore body{};
    make_core(sweep.shape.instance(), shape);
    make_core(sweep.body.instance(), body);
    std::int64_t raw[3][3];
    reference::to_raw(centre + sweep.start, raw[0]);
    reference::to_raw(sweep.way, raw[1]);
    reference::to_raw(centre, raw[2]);
    ConvexCastHit hit{};
    return shape_cast(shape, raw[0], raw[1], body, raw[2], hit) ? std::optional(hit) : std::nullopt;
}

/// Where a convex function is least on [0, 1].
double least(const Sweep& sweep) {
    double low = 0;
    double high = 1;
    for (int step = 0; step < 60; ++step) {
        const double third = (high - low) / 3;
        const bool falls = sweep.distance_at(low + third) > sweep.distance_at(high - third);
        (falls ? low : high) = falls ? low + third : high - third;
    }
    return (low + high) / 2;
}

/// A hit stops at the gap, while nearing, and not before it must; a miss stays clear.
int checked_hits(const Sweep& sweep, const std::optional<ConvexCastHit>& hit) {
    const double at_start = sweep.distance_at(0);
    if (at_start <= kError) {
        EXPECT_TRUE(at_start > -kError || (hit && hit->overlapping && hit->fraction == 0));
        return 0;
    }
    if (!hit) {
        EXPECT_GT(sweep.distance_at(least(sweep)), kGap - kError) << "went through";
        return 0;
    }
    EXPECT_FALSE(hit->overlapping);
    const double fraction = from_raw(hit->fraction);
    const double rounding = reference::length(sweep.way) * 0x1p-32;
    const double distance = sweep.distance_at(fraction);
    EXPECT_LE(distance,
              std::max(kGapMost, at_start <= kGapMost ? at_start : 0) + rounding + kError);
    if (fraction > 0) {
        EXPECT_GE(distance, kGap - kError);
        // Convex: farther away a moment earlier means farther at all earlier times.
        EXPECT_GT(sweep.distance_at(fraction * 0.999), distance - kError);
    }
    const Vec at = sweep.start + sweep.way * fraction;
    const Vec point = from_raw(hit->point);
    EXPECT_NEAR(sweep.body.distance(point), 0, kError);
    EXPECT_NEAR(sweep.shape.distance(point - at), distance, kError + rounding);
    EXPECT_LT(reference::dot(reference::unit(hit->normal), sweep.way), 0);
    return 1;
}

TEST(ShapeCast, StopsAtTheGapOfEveryPairOfShapes) {
    Random random(81);
    int hits = 0;
    for (int round = 0; round < 640; ++round) {
        Sweep sweep{random_body(random, kConvexTypes[round % 4], 0.5),
                    random_body(random, kConvexTypes[round / 4 % 4], 1),
                    random.direction() * random.uniform(0, 12),
                    {}};
        sweep.way = (random.direction() * random.uniform(0, 3) - sweep.start) * 2;
        SCOPED_TRACE(round);
        hits += checked_hits(sweep, cast(sweep));
    }
    EXPECT_GT(hits, 200);
}

TEST(ShapeCast, GrazesNeitherLoseNorInventHits) {
    Random random(82);
    int hits = 0;
    for (int round = 0; round < 400; ++round) {
        // Past a sphere at its radius and some micrometres more or less.
        const double off = random.uniform(-4e-5, 4e-5);
        const Vec along = random.direction();
        const Vec across = reference::cross(along, random.direction());
        const Vec side = across * (1 / reference::length(across));
        const Sweep sweep{
            Body::sphere(0.25), Body::sphere(0.5), side * (0.75 + off) - along * 10, along * 20};
        const auto hit = cast(sweep);
        hits += hit ? 1 : 0;
        if (off < kGap - kError) {
            EXPECT_TRUE(hit) << off;
        } else if (off > kGapMost + kError) {
            EXPECT_FALSE(hit) << off;
        }
        checked_hits(sweep, hit);
    }
    EXPECT_GT(hits, 100);
    EXPECT_LT(hits, 390);
}

TEST(ShapeCast, HalfSpaceInOneStep) {
    const Sweep sweep{Body::box(0.5, 0.25, 0.5), Body::plane(), {3, 10.25, -4}, {5, -20, 1}};
    const auto hit = cast(sweep);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(from_raw(hit->fraction), (10 - kGap) / 20, 1e-9);
    EXPECT_EQ(hit->normal[1], kUnitOne);
    EXPECT_FALSE(cast({sweep.shape, sweep.body, sweep.start, {5, 20, 1}}));
    EXPECT_FALSE(cast({sweep.shape, sweep.body, sweep.start, {5, -9, 1}}));
}

TEST(ShapeCast, FastAndSmallNeverPassesAThinWall) {
    Random random(83);
    const Body wall = Body::box(50, 50, 0.01);
    for (int round = 0; round < 300; ++round) {
        const Body shape = random_body(random, kConvexTypes[round % 4], 0.1);
        const Vec through{random.uniform(-40, 40), random.uniform(-40, 40), 0};
        const Vec way{
            random.uniform(-100, 100), random.uniform(-100, 100), random.uniform(200, 60000)};
        const Sweep sweep{shape, wall, through - way * random.uniform(0.01, 0.99), way};
        SCOPED_TRACE(round);
        const auto hit = cast(sweep);
        ASSERT_TRUE(hit);
        checked_hits(sweep, hit);
    }
}

TEST(ShapeCast, OverlapAtTheStartIsFractionZeroWithoutANormal) {
    const Sweep sweep{Body::sphere(0.5), Body::box(1, 1, 1), {1.25, 0, 0}, {9, 0, 0}};
    const auto hit = cast(sweep);
    ASSERT_TRUE(hit && hit->overlapping);
    EXPECT_EQ(hit->fraction, 0);
    EXPECT_EQ(hit->normal[0], 0);
    EXPECT_EQ(hit->point[0], std::int64_t{5} << 30);
    EXPECT_TRUE(cast({sweep.shape, sweep.body, sweep.start, {0, 0, 0}})) << "without a way too";
    EXPECT_FALSE(cast({sweep.shape, sweep.body, {1.6, 0, 0}, {0, 0, 0}}));
}

TEST(ShapeCast, WhoStandsAtTheGapMayLeaveAndSlide) {
    const Body box = Body::box(1, 1, 1);
    const Vec resting{0, 2 + kGap, 0};
    EXPECT_FALSE(cast({box, box, resting, {0, 3, 0}}));
    EXPECT_FALSE(cast({box, box, resting, {3, 0, 0}}));
    const auto down = cast({box, box, resting, {0, -1, 0}});
    ASSERT_TRUE(down);
    EXPECT_EQ(down->fraction, 0);
    EXPECT_EQ(down->normal[1], kUnitOne);
}

TEST(ShapeCast, SameBitsTenKilometresAway) {
    Random random(84);
    const Vec far{10000, -10000, 10000};
    int hits = 0;
    for (int round = 0; round < 400; ++round) {
        Sweep sweep{random_body(random, kConvexTypes[round % 4], 0.5),
                    random_body(random, kConvexTypes[round / 4 % 4], 1),
                    {},
                    {}};
        // On a grid of 2^-32 m that a double holds ten kilometres out.
        for (int axis = 0; axis < 3; ++axis) {
            sweep.start.component[axis] = std::round(random.uniform(-9, 9) * 0x1p20) * 0x1p-20;
            sweep.way.component[axis] = -2 * sweep.start[axis];
        }
        const auto here = cast(sweep);
        const auto there = cast(sweep, far);
        ASSERT_EQ(here.has_value(), there.has_value());
        if (here) {
            ++hits;
            EXPECT_EQ(here->fraction, there->fraction);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_EQ(here->normal[axis], there->normal[axis]);
                EXPECT_EQ(here->point[axis] + std::llround(far[axis] * 0x1p32), there->point[axis]);
            }
        }
    }
    EXPECT_GT(hits, 200);
}

} // namespace
} // namespace lockwind
