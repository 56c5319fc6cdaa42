#include "geometry/shape_distance.h"
#include "random_body.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

using reference::Body;
using reference::from_raw;
using reference::kConvexTypes;
using reference::Random;
using reference::random_body;
using reference::Vec;

ShapeDistance measured(const Body& a, const Body& b, const Vec& delta) {
    ConvexCore core_a{};
    ConvexCore core_b{};
    make_core(a.instance(), core_a);
    make_core(b.instance(), core_b);
    std::int64_t raw[3];
    reference::to_raw(delta, raw);
    ShapeDistance out{};
    shape_distance(core_a, core_b, raw, out);
    return out;
}

/// Holds every promise of ShapeDistance against double precision; `tolerance` in m.
void expect_promises(const Body& a, const Body& b, const Vec& delta, double tolerance) {
    const ShapeDistance found = measured(a, b, delta);
    const double expected = reference::distance(b, a, delta);
    if (expected <= tolerance) {
        EXPECT_TRUE(found.overlapping || expected > -tolerance) << expected;
        return;
    }
    ASSERT_FALSE(found.overlapping) << expected;
    EXPECT_NEAR(from_raw(found.distance), expected, tolerance);
    EXPECT_NEAR(from_raw(found.separation), expected, tolerance);
    const Vec normal = reference::unit(found.normal);
    EXPECT_NEAR(reference::length(normal), 1, 1e-8);
    // The point is on B's surface, and A is as near to it as to B.
    const Vec point = from_raw(found.point);
    EXPECT_NEAR(b.distance(point), 0, tolerance);
    EXPECT_NEAR(a.distance(point - delta), expected, tolerance);
    // The normal leads from it to A.
    EXPECT_NEAR(a.distance(point + normal * expected - delta), 0, 2 * tolerance);
}

TEST(ShapeDistance, AgreesWithDoublePrecision) {
    Random random(71);
    for (const ShapeType type_a : kConvexTypes) {
        for (const ShapeType type_b : kConvexTypes) {
            for (int round = 0; round < 150; ++round) {
                const Body a = random_body(random, type_a, 1);
                const Body b = random_body(random, type_b, 1);
                SCOPED_TRACE(testing::Message() << static_cast<int>(type_a) << " "
                                                << static_cast<int>(type_b) << " " << round);
                expect_promises(a, b, random.direction() * random.uniform(0.5, 8), 1e-6);
            }
        }
    }
}

TEST(ShapeDistance, AgreesWhereSurfacesNearlyTouch) {
    Random random(72);
    int apart = 0;
    for (int round = 0; round < 320; ++round) {
        const Body a = random_body(random, kConvexTypes[round % 4], 1);
        const Body b = random_body(random, kConvexTypes[round / 4 % 4], 1);
        const Vec direction = random.direction();
        // Bisected to where they touch, and off by up to 20 um from there.
        double low = 0;
        double high = 12;
        for (int step = 0; step < 40; ++step) {
            const double middle = (low + high) / 2;
            (reference::distance(b, a, direction * middle) > 0 ? high : low) = middle;
        }
        const Vec delta = direction * (high + random.uniform(-2e-5, 2e-5));
        apart += reference::distance(b, a, delta) > 1e-6 ? 1 : 0;
        SCOPED_TRACE(round);
        expect_promises(a, b, delta, 1e-6);
    }
    EXPECT_GT(apart, 100);
}

TEST(ShapeDistance, AgreesForTheLargestAndTheFarthest) {
    Random random(73);
    for (int round = 0; round < 200; ++round) {
        const Body a = random_body(random, kConvexTypes[round % 4], round % 3 == 0 ? 0.2 : 20);
        const Body ground = Body::box(250, 250, 250).turn(random.direction(), 1);
        expect_promises(a, ground, random.direction() * random.uniform(260, 500), 1e-5);
        const Body b = random_body(random, kConvexTypes[round / 4 % 4], 1);
        expect_promises(a, b, random.direction() * random.uniform(20000, 100000), 4e-3);
    }
}

TEST(ShapeDistance, HalfSpaceByItsNormal) {
    Random random(74);
    for (int round = 0; round < 400; ++round) {
        const Body a = random_body(random, kConvexTypes[round % 4], 1);
        const Body plane = random_body(random, ShapeType::plane, 1);
        const Vec delta = random.direction() * random.uniform(0, 10);
        const ShapeDistance found = measured(a, plane, delta);
        const double expected = reference::distance(plane, a, delta);
        ASSERT_EQ(found.overlapping, expected <= 0) << expected;
        if (!found.overlapping) {
            EXPECT_NEAR(from_raw(found.distance), expected, 1e-6);
            const Vec point = from_raw(found.point);
            EXPECT_NEAR(plane.distance(point), 0, 1e-6);
            EXPECT_NEAR(a.distance(point - delta), expected, 1e-6);
        }
    }
}

TEST(ShapeDistance, FlatFacesOnEachOtherByClosedForm) {
    // Parallel faces: every simplex that GJK meets is flat or has the origin on a border.
    const Body cube = Body::box(1, 1, 1);
    for (const double shift : {0.0, 0.25, 1.0, 1.75, 2.0}) {
        const ShapeDistance found = measured(cube, cube, {shift, 2.5, -shift});
        ASSERT_FALSE(found.overlapping);
        EXPECT_EQ(found.distance, std::int64_t{1} << 31);
        EXPECT_EQ(found.normal[1], kUnitOne);
    }
    EXPECT_TRUE(measured(cube, cube, {0.5, 2, 0.5}).overlapping);
    EXPECT_FALSE(measured(cube, cube, {0.5, 2 + 1e-6, 0.5}).overlapping);
    EXPECT_TRUE(measured(cube, cube, {0, 0, 0}).overlapping);
}

TEST(ShapeDistance, SwappedShapesGiveTheOppositeNormal) {
    Random random(75);
    for (int round = 0; round < 200; ++round) {
        const Body a = random_body(random, kConvexTypes[round % 4], 1);
        const Body b = random_body(random, kConvexTypes[round / 4 % 4], 1);
        const Vec delta = random.direction() * random.uniform(5, 8);
        const ShapeDistance found = measured(a, b, delta);
        const ShapeDistance swapped = measured(b, a, delta * -1);
        ASSERT_EQ(found.overlapping, swapped.overlapping);
        EXPECT_NEAR(from_raw(found.distance), from_raw(swapped.distance), 1e-6);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(found.normal[axis], -swapped.normal[axis], 4000);
        }
    }
}

} // namespace
} // namespace lockwind
