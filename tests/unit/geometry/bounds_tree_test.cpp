#include "geometry/bounds_probe.h"
#include "geometry/bounds_tree.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace lockwind {
namespace {

constexpr double kMetre = 1 << 16;
constexpr std::int32_t kNoExtents[3] = {0, 0, 0};

class Draws {
public:
    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    Bounds bounds(double reach, double half_max) {
        Bounds made{};
        for (int axis = 0; axis < 3; ++axis) {
            const double middle = uniform(-reach, reach);
            const double half = uniform(0, half_max);
            made.low[axis] = static_cast<std::int32_t>((middle - half) * kMetre);
            made.high[axis] = static_cast<std::int32_t>((middle + half) * kMetre);
        }
        return made;
    }
    std::vector<Bounds> many(int count, double reach, double half_max) {
        std::vector<Bounds> all;
        for (int index = 0; index < count; ++index) {
            all.push_back(bounds(reach, half_max));
        }
        return all;
    }

private:
    std::mt19937 random_{11};
};

struct Segment {
    double from[3];
    double way[3];

    SegmentProbe probe(const std::int32_t half_extents[3]) const {
        std::int64_t start[3];
        std::int64_t raw[3];
        for (int axis = 0; axis < 3; ++axis) {
            start[axis] = std::llround(from[axis] * 0x1p32);
            raw[axis] = std::llround(way[axis] * 0x1p32);
        }
        return {start, raw, half_extents};
    }
    /// Whether it meets the bounds grown by `by`, up to a fraction of it: slabs.
    bool meets(const Bounds& bounds, double by, double fraction = 1) const {
        double enter = 0;
        double leave = fraction;
        for (int axis = 0; axis < 3; ++axis) {
            const double low = bounds.low[axis] / kMetre - by - from[axis];
            const double high = bounds.high[axis] / kMetre + by - from[axis];
            enter = std::max(enter, std::min(low / way[axis], high / way[axis]));
            leave = std::min(leave, std::max(low / way[axis], high / way[axis]));
        }
        return enter <= leave;
    }
};

Segment random_segment(Draws& draws, double reach, double length) {
    Segment segment{};
    for (int axis = 0; axis < 3; ++axis) {
        segment.from[axis] = draws.uniform(-reach, reach);
        segment.way[axis] = draws.uniform(-length, length);
    }
    return segment;
}

/// That passes within `miss` of the bounds' middle, or ends before.
Segment aimed_segment(Draws& draws, const Bounds& bounds, double length, double miss) {
    Segment segment = random_segment(draws, 0, length);
    const double back = draws.uniform(0, 1.5);
    for (int axis = 0; axis < 3; ++axis) {
        const double middle = (bounds.low[axis] / kMetre + bounds.high[axis] / kMetre) / 2;
        segment.from[axis] = middle + draws.uniform(-miss, miss) - segment.way[axis] * back;
    }
    return segment;
}

TEST(BoundsTree, FindsWhatAProbeTakesOnce) {
    Draws draws;
    for (const int count : {0, 1, 4, 5, 17, 300}) {
        std::vector<Bounds> all = draws.many(count, 10, 2);
        all.push_back(kUnbounded);
        all.push_back({{1, 0, 0}, {0, 1, 1}});
        BoundsTree tree(static_cast<std::uint32_t>(all.size()));
        tree.build(all);
        for (int round = 0; round < 200; ++round) {
            const OverlapProbe probe(draws.bounds(10, 4));
            std::vector<std::uint32_t> found;
            tree.visit(probe, [&](std::uint32_t row) { found.push_back(row); });
            std::sort(found.begin(), found.end());
            std::vector<std::uint32_t> expected;
            for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(count); ++row) {
                if (probe(all[row]) >= 0) {
                    expected.push_back(row);
                }
            }
            expected.push_back(
                static_cast<std::uint32_t>(count)); // the unbounded; the empty is not
            ASSERT_EQ(found, expected);
        }
    }
}

TEST(BoundsTree, VisitsFewOfMany) {
    Draws draws;
    const std::vector<Bounds> all = draws.many(4096, 60, 2);
    BoundsTree tree(4096);
    tree.build(all);
    int looks = 0;
    int visits = 0;
    constexpr int kRays = 200;
    for (int round = 0; round < kRays; ++round) {
        const Segment segment = random_segment(draws, 60, 60);
        const SegmentProbe probe = segment.probe(kNoExtents);
        tree.visit(
            [&](const Bounds& bounds) {
                ++looks;
                return probe(bounds);
            },
            [&](std::uint32_t) { ++visits; });
    }
    EXPECT_LT(looks, kRays * 500) << "an eighth of the bodies";
    EXPECT_GT(visits, kRays / 4);
    EXPECT_LT(visits, kRays * 20);
}

TEST(BoundsTree, NearerNodesComeFirst) {
    // A row of 1024; the probe gives up behind the first that it meets.
    std::vector<Bounds> all;
    for (int index = 0; index < 1024; ++index) {
        const auto x = static_cast<std::int32_t>((index - 512) * 2 * kMetre);
        all.push_back({{x, -1000, -1000}, {x + 60000, 1000, 1000}});
    }
    BoundsTree tree(1024);
    tree.build(all);
    for (const double sign : {-1.0, 1.0}) {
        const Segment segment{{-1100 * sign, 0, 0}, {2200 * sign, 0.01, 0.01}};
        SegmentProbe probe = segment.probe(kNoExtents);
        int visits = 0;
        tree.visit(probe, [&](std::uint32_t row) {
            ++visits;
            const double x = all[row].low[0] / kMetre;
            probe.shorten(std::llround((x + 1100 * sign) / (2200 * sign) * 0x1p32));
        });
        EXPECT_GT(visits, 0);
        EXPECT_LE(visits, 8);
    }
}

TEST(SegmentProbe, RefusesNothingThatItMeetsAndLittleElse) {
    Draws draws;
    int met = 0;
    int close = 0;
    for (int round = 0; round < 40000; ++round) {
        const bool is_long = round % 4 == 0;
        const Bounds bounds = draws.bounds(is_long ? 30000 : 10, is_long ? 400 : 3);
        const Segment segment =
            aimed_segment(draws, bounds, is_long ? 30000 : 15, is_long ? 600 : 4);
        SegmentProbe probe = segment.probe(kNoExtents);
        const double fraction = round % 2 == 0 ? 1 : draws.uniform(0, 1);
        if (fraction < 1) {
            probe.shorten(std::llround(fraction * 0x1p32));
        }
        if (segment.meets(bounds, 1e-4, fraction)) {
            ++met;
            EXPECT_GE(probe(bounds), 0) << round;
        } else if (!segment.meets(bounds, 0.01, std::min(1.0, fraction + 0.01))) {
            ++close;
            EXPECT_LT(probe(bounds), 0) << round;
        }
    }
    EXPECT_GT(met, 1000);
    EXPECT_GT(close, 1000);
}

TEST(SegmentProbe, GrowsBoundsByWhatMoves) {
    const Bounds cube{{-65536, -65536, -65536}, {65536, 65536, 65536}};
    const std::int32_t half_extents[3] = {1 << 22, 2 << 22, 3 << 22};
    const Segment beside{{-9, 2.9, 0.01}, {18, 0.01, 0.01}};
    EXPECT_LT(beside.probe(kNoExtents)(cube), 0);
    EXPECT_GE(beside.probe(half_extents)(cube), 0);
    const Segment farther{{-9, 3.1, 0.01}, {18, 0.01, 0.01}};
    EXPECT_LT(farther.probe(half_extents)(cube), 0);
}

TEST(PointProbe, RefusesNothingWithinTheDistanceAndLittleElse) {
    Draws draws;
    int within = 0;
    int beyond = 0;
    for (int round = 0; round < 20000; ++round) {
        const Bounds bounds = draws.bounds(10, 3);
        std::int64_t raw[3];
        double square = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double place = draws.uniform(-10, 10);
            raw[axis] = std::llround(place * 0x1p32);
            const double off = std::max(
                {bounds.low[axis] / kMetre - place, place - bounds.high[axis] / kMetre, 0.0});
            square += off * off;
        }
        const double limit = draws.uniform(0, 15);
        PointProbe probe(raw, std::int64_t{100} << 32);
        EXPECT_GE(probe(bounds), 0);
        probe.shorten(std::llround(limit * 0x1p32));
        if (std::sqrt(square) <= limit) {
            ++within;
            EXPECT_GE(probe(bounds), 0);
        } else if (std::sqrt(square) > limit + 0.01) {
            ++beyond;
            EXPECT_LT(probe(bounds), 0);
        }
    }
    EXPECT_GT(within, 1000);
    EXPECT_GT(beyond, 1000);
}

} // namespace
} // namespace lockwind
