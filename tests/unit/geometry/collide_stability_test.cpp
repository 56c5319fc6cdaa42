#include "geometry/collide.h"
#include "reference.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <vector>

namespace lockwind {
namespace {

using reference::Body;
using reference::kLengthUlp;
using reference::Random;
using reference::raw_length;
using reference::Vec;

ManifoldGeometry
run(const Body& a, const Body& b, const Vec& delta, const ManifoldCache& cache = {}) {
    const std::int32_t raw[3] = {raw_length(delta[0]), raw_length(delta[1]), raw_length(delta[2])};
    ManifoldGeometry manifold;
    collide(a.instance(), b.instance(), raw, cache, manifold);
    return manifold;
}

ManifoldCache cache_of(const ManifoldGeometry& manifold) {
    ManifoldCache cache;
    cache.axis = manifold.axis;
    cache.axis_separation = manifold.axis_separation;
    cache.touching = manifold.point_count != 0;
    return cache;
}

std::set<std::uint32_t> features(const ManifoldGeometry& manifold) {
    std::set<std::uint32_t> ids;
    for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
        ids.insert(manifold.points[index].feature);
    }
    return ids;
}

double length_of_normal(const ManifoldGeometry& manifold) {
    return reference::length(reference::unit(manifold.normal));
}

/// Small shakes of a resting pair: same normal within the shake, same features, throughout.
void expect_steady(const Body& a, const Body& b, const Vec& delta, double shake) {
    const ManifoldGeometry first = run(a, b, delta);
    ASSERT_GT(first.point_count, 0U);
    EXPECT_EQ(features(first).size(), first.point_count) << "a feature names two points";
    Random random(5);
    ManifoldCache cache = cache_of(first);
    for (int round = 0; round < 300; ++round) {
        Body moved = b;
        const Body turn = Body::box(1, 1, 1).turn(random.direction(), shake);
        for (int column = 0; column < 3; ++column) {
            const Vec axis = turn.to_world(b.axis(column));
            for (int row = 0; row < 3 && b.type != ShapeType::sphere; ++row) {
                moved.rotation[3 * row + column] =
                    static_cast<std::int32_t>(std::lround(axis[row] / reference::kUnitUlp));
            }
        }
        const ManifoldGeometry next =
            run(a, moved, delta + random.direction() * (shake / 2), cache);
        ASSERT_EQ(features(next), features(first)) << "round " << round;
        EXPECT_GT(reference::dot(reference::unit(next.normal), reference::unit(first.normal)),
                  1 - 4 * shake);
        cache = cache_of(next);
    }
}

TEST(CollideStability, RestingPairsKeepTheirFeatures) {
    const double half_pi = 1.5707963267948966;
    const Body ground = Body::box(20, 1, 20);
    const Body lying = Body::capsule(0.3, 0.8).turn({0, 0, 1}, half_pi);
    expect_steady(ground, Body::box(0.5, 0.5, 0.5), {0.3, 1.5, 0.2}, 0.002);
    expect_steady(Body::box(0.5, 0.5, 0.5), Body::box(0.5, 0.5, 0.5), {0.1, 1, 0.07}, 0.002);
    expect_steady(ground, Body::sphere(0.5), {0.3, 1.5, 0.2}, 0.002);
    expect_steady(ground, lying, {0.3, 1.3, 0.2}, 0.002);
    expect_steady(ground, Body::capsule(0.3, 0.8), {0.3, 2.1, 0.2}, 0.002);
    expect_steady(Body::plane(), Body::box(0.5, 0.4, 0.3), {0, 0.4, 0}, 0.002);
    expect_steady(Body::plane(), lying, {0, 0.3, 0}, 0.002);
    expect_steady(lying, lying, {0.2, 0.6, 0}, 0.002);
    expect_steady(Body::box(2, 0.5, 0.5).turn({1, 0, 0}, half_pi / 2),
                  Body::box(0.5, 0.5, 2).turn({0, 0, 1}, half_pi / 2),
                  {0.4, std::sqrt(2.0), -0.3},
                  0.002);
}

TEST(CollideStability, ReferenceFaceStaysWhileItsDepthChangesLittle) {
    // Two equal boxes, face to face: either face could be the reference.
    const Body a = Body::box(0.5, 0.5, 0.5);
    Body b = a;
    b.turn({0, 0, 1}, 0.004);
    ManifoldGeometry manifold = run(a, b, {0, 0.999, 0});
    const std::uint32_t axis = manifold.axis;
    for (int step = 0; step < 60; ++step) {
        // Rocks to and fro, so that in turn either box's face is the better one.
        Body rocked = a;
        rocked.turn({0, 0, 1}, 0.004 * std::sin(step * 0.7));
        manifold = run(a, rocked, {0, 0.999 + 0.001 * std::cos(step * 0.9), 0}, cache_of(manifold));
        EXPECT_EQ(manifold.axis, axis);
    }
}

TEST(CollideStability, ReferenceFaceGivesWayWhereItNoLongerFits) {
    const Body box = Body::box(0.5, 0.5, 0.5);
    ManifoldCache cache;
    cache.axis = 1; // A's x face, though B stands on its y face
    cache.axis_separation = 0;
    cache.touching = true;
    const ManifoldGeometry manifold = run(box, box, {0, 0.99, 0}, cache);
    ASSERT_EQ(manifold.point_count, 4U);
    EXPECT_EQ(manifold.axis, 2U);
    EXPECT_EQ(manifold.normal[1], kUnitOne);
}

TEST(CollideStability, AnyCacheGivesAResult) {
    // A corrupted state may hold any axis; the answer may differ, but it is one.
    Random random(6);
    for (int round = 0; round < 4000; ++round) {
        const Body a = Body::box(0.5, 0.3, 0.7).turn(random.direction(), random.uniform(0, 3));
        const Body b = Body::box(0.2, 0.9, 0.4).turn(random.direction(), random.uniform(0, 3));
        ManifoldCache cache;
        cache.axis = static_cast<std::uint32_t>(random.bits() % 300);
        cache.axis_separation = static_cast<std::int32_t>(random.bits());
        cache.touching = random.bits() % 2 != 0;
        const Vec delta = random.direction() * random.uniform(0, 2);
        const ManifoldGeometry manifold = run(a, b, delta, cache);
        ASSERT_LE(manifold.point_count, 4U);
        ASSERT_LE(manifold.axis, 15U);
        if (manifold.point_count > 0) {
            EXPECT_NEAR(length_of_normal(manifold), 1, 1e-7);
        } else if (!cache.touching || cache.axis == 0) {
            EXPECT_GT(reference::box_axes_separation(a, b, delta), -1e-6);
        }
    }
}

TEST(CollideStability, CoincidentCentresPartInAFixedDirection) {
    const std::vector<Body> bodies = {
        Body::sphere(0.5), Body::capsule(0.3, 0.6), Body::box(1, 2, 3)};
    for (const Body& a : bodies) {
        for (const Body& b : bodies) {
            const ManifoldGeometry manifold = run(a, b, {0, 0, 0});
            const ManifoldGeometry again = run(a, b, {0, 0, 0});
            ASSERT_GT(manifold.point_count, 0U);
            EXPECT_NEAR(length_of_normal(manifold), 1, 1e-8);
            for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
                EXPECT_LT(manifold.points[index].separation, -raw_length(0.5));
                EXPECT_EQ(manifold.points[index].separation, again.points[index].separation);
            }
        }
    }
}

TEST(CollideStability, CrossingSegmentsPartAcrossBoth) {
    const Body a = Body::capsule(0.3, 1);
    const Body b = Body::capsule(0.2, 1).turn({0, 0, 1}, 1.2);
    const ManifoldGeometry manifold = run(a, b, {0, 0, 0});
    ASSERT_EQ(manifold.point_count, 1U);
    EXPECT_NEAR(manifold.points[0].separation * kLengthUlp, -0.5, 1e-6);
    const Vec normal = reference::unit(manifold.normal);
    EXPECT_NEAR(reference::dot(normal, a.axis(1)), 0, 1e-6);
    EXPECT_NEAR(reference::dot(normal, b.axis(1)), 0, 1e-6);
    // On one line, overlapping: sideways.
    const ManifoldGeometry line = run(a, a, {0, 1.5, 0});
    ASSERT_GT(line.point_count, 0U);
    EXPECT_EQ(line.normal[1], 0);
    EXPECT_NEAR(line.points[0].separation * kLengthUlp, -0.6, 1e-6);
}

TEST(CollideStability, CentresOnSurfacesAndAxesAreFinite) {
    const Body box = Body::box(1, 1, 1);
    const Body sphere = Body::sphere(0.5);
    for (const Vec& delta : {Vec{1, 0, 0}, Vec{1, 1, 0}, Vec{1, 1, 1}, Vec{-1, 0.2, 1}}) {
        const ManifoldGeometry manifold = run(box, sphere, delta);
        ASSERT_EQ(manifold.point_count, 1U);
        EXPECT_NEAR(manifold.points[0].separation * kLengthUlp, -0.5, 1e-6);
        EXPECT_NEAR(length_of_normal(manifold), 1, 1e-8);
    }
    const ManifoldGeometry on_axis = run(Body::capsule(0.3, 1), sphere, {0, 0.4, 0});
    ASSERT_EQ(on_axis.point_count, 1U);
    EXPECT_EQ(on_axis.normal[1], 0);
    EXPECT_NEAR(on_axis.points[0].separation * kLengthUlp, -0.8, 1e-6);
}

TEST(CollideStability, ParallelEdgesAreNoAxis) {
    // Equal turns: all nine edge pairs are parallel or square to each other.
    Body a = Body::box(0.5, 0.5, 0.5);
    a.turn({0.6, 0, 0.8}, 0.7);
    const Vec delta = a.axis(0) * 0.7 + a.axis(1) * 0.999 + a.axis(2) * 0.2;
    const ManifoldGeometry manifold = run(a, a, delta);
    ASSERT_EQ(manifold.point_count, 4U);
    EXPECT_GT(reference::dot(reference::unit(manifold.normal), a.axis(1)), 1 - 1e-8);
}

TEST(CollideStability, RoundContactMovesContinuouslyAcrossFeatures) {
    // A sphere rolling over a box from one face across the edge to the next.
    const Body box = Body::box(1, 1, 1);
    const Body sphere = Body::sphere(0.5);
    Vec previous{0, 1, 0};
    for (int step = 0; step <= 400; ++step) {
        const double angle = step * 1.5707963267948966 / 400;
        const Vec way{std::sin(angle), std::cos(angle), 0};
        const ManifoldGeometry manifold = run(box, sphere, Vec{1, 1, 0} + way * 0.5);
        ASSERT_EQ(manifold.point_count, 1U);
        const Vec normal = reference::unit(manifold.normal);
        EXPECT_NEAR(manifold.points[0].separation * kLengthUlp, 0, 1e-6);
        EXPECT_LT(reference::length(normal - previous), 0.01);
        previous = normal;
    }
}

TEST(CollideStability, LargestAndSmallestBodiesMeet) {
    const Body ground = Body::box(250, 250, 250).turn({0.6, 0, 0.8}, 0.5);
    const Body small = Body::box(0.01, 0.01, 0.01);
    const Body moving = Body::box(43, 43, 43);
    const Vec up = ground.axis(1);
    const Vec corner = ground.axis(0) * 249.995 + ground.axis(2) * -249.995;
    Body aligned = ground;
    aligned.size[0] = aligned.size[1] = aligned.size[2] = small.size[0];
    const ManifoldGeometry tiny = run(ground, aligned, up * 250.005 + corner);
    ASSERT_EQ(tiny.point_count, 4U);
    EXPECT_NEAR(tiny.points[0].separation * kLengthUlp, -0.005, 1e-5);
    aligned.size[0] = aligned.size[1] = aligned.size[2] = moving.size[0];
    for (const double side : {1.0, -1.0}) {
        const Vec beside = ground.axis(0) * (240 * side) + ground.axis(2) * 230;
        const ManifoldGeometry large = run(aligned, ground, (up * 292.99 + beside) * -1);
        ASSERT_EQ(large.point_count, 4U);
        EXPECT_NEAR(large.points[0].separation * kLengthUlp, -0.01, 1e-5);
        EXPECT_LT(reference::dot(reference::unit(large.normal), up), -1 + 1e-8);
    }
}

TEST(CollideStability, LargeShapesAtEveryDeltaStayInRange) {
    // Any pair that may meet, at any offset that its bounds allow: no overflow (a sanitised build
    // says so), no far point.
    Random random(9);
    const auto fixed = [&]() -> Body {
        return random.bits() % 2 != 0 ? Body::box(250, 250, random.uniform(0.01, 250))
                                      : Body::capsule(random.uniform(0.01, 200), 230);
    };
    const auto moving = [&]() -> Body {
        switch (random.bits() % 3) {
        case 0:
            return Body::box(43, 43, random.uniform(0.01, 43));
        case 1:
            return Body::capsule(random.uniform(1, 30), 45);
        default:
            return Body::sphere(random.uniform(0.01, 75));
        }
    };
    int touching = 0;
    for (int round = 0; round < 20000; ++round) {
        Body a = fixed();
        Body b = moving();
        a.turn(random.direction(), random.uniform(0, 3));
        b.turn(random.direction(), random.uniform(0, 3));
        const Vec delta{
            random.uniform(-510, 510), random.uniform(-510, 510), random.uniform(-510, 510)};
        const bool swap = random.bits() % 2 != 0;
        const Vec scaled = delta * (random.bits() % 2 != 0 ? 1 : 0.5);
        const ManifoldGeometry manifold = swap ? run(b, a, scaled * -1) : run(a, b, scaled);
        touching += manifold.point_count != 0 ? 1 : 0;
        for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
            const ManifoldPoint& point = manifold.points[index];
            const std::int32_t* local = swap ? point.local_a : point.local_b;
            EXPECT_LT(reference::length(reference::metres(local)), 1.25 * 75 + 0.02);
        }
    }
    EXPECT_GT(touching, 2000);
}

// As a match had them: an edge of A, nearly flat on a face of B, overlaps it by a hair at its upper
// end; its lower corner is as deep, but 80 cm below B.
TEST(CollideStability, AnEdgeThatMeetsOnlyTheEndOfAFaceTouchesThere) {
    Body a = Body::box(0.4, 0.4, 0.4);
    Body b = Body::box(0.5, 0.4, 0.7);
    const std::int32_t rotation_a[9] = {17136695,
                                        -948679,
                                        1073604647,
                                        54139666,
                                        1072376051,
                                        83426,
                                        -1072239122,
                                        54131418,
                                        17162731};
    const std::int32_t rotation_b[9] = {991793338,
                                        11127315,
                                        411270789,
                                        7403854,
                                        1072692501,
                                        -46877339,
                                        -411354667,
                                        46135505,
                                        990747373};
    std::copy_n(rotation_a, 9, a.rotation);
    std::copy_n(rotation_b, 9, b.rotation);
    const std::int32_t delta[3] = {-2350016, 3571238, -4425288};
    for (const bool swapped : {false, true}) {
        const Body& first = swapped ? b : a;
        const Body& second = swapped ? a : b;
        const std::int32_t sign = swapped ? -1 : 1;
        const std::int32_t from_first[3] = {sign * delta[0], sign * delta[1], sign * delta[2]};
        ManifoldGeometry manifold;
        collide(first.instance(), second.instance(), from_first, {}, manifold);
        ASSERT_EQ(manifold.point_count, 1U);
        const ManifoldPoint& point = manifold.points[0];
        const Vec on_first = first.to_world(reference::metres(point.local_a));
        const Vec on_second = second.to_world(reference::metres(point.local_b));
        EXPECT_LT(std::abs(first.distance(on_first)), 0.005) << swapped;
        EXPECT_LT(std::abs(second.distance(on_second)), 0.005) << swapped;
        EXPECT_LT(reference::length(on_first - on_second - reference::metres(from_first)), 1e-5);
    }
}

} // namespace
} // namespace lockwind
