#include "geometry/bounds.h"
#include "reference.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

using reference::Body;
using reference::kLengthUlp;
using reference::Random;
using reference::raw_length;

TEST(Bounds, OfAnUnturnedBoxAreItsHalfExtents) {
    const Body box = Body::box(0.5, 2, 30);
    std::int32_t half[3];
    bounds_half_extents(box.instance(), half);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(half[axis], box.size[axis]);
        EXPECT_LE(half[axis], box.size[axis] + 3);
    }
}

TEST(Bounds, OfASphereAreItsRadius) {
    const Body sphere = Body::sphere(0.75);
    std::int32_t half[3];
    bounds_half_extents(sphere.instance(), half);
    for (const std::int32_t extent : half) {
        EXPECT_EQ(extent, raw_length(0.75));
    }
}

TEST(Bounds, HoldTurnedShapesTightly) {
    Random random(21);
    for (int round = 0; round < 2000; ++round) {
        const bool capsule = round % 2 != 0;
        Body body = capsule ? Body::capsule(random.uniform(0.01, 3), random.uniform(0.01, 30))
                            : Body::box(random.uniform(0.01, 250),
                                        random.uniform(0.01, 250),
                                        random.uniform(0.01, 250));
        body.turn(random.direction(), random.uniform(0, 6.28));
        std::int32_t half[3];
        bounds_half_extents(body.instance(), half);
        for (int axis = 0; axis < 3; ++axis) {
            double exact = 0;
            if (capsule) {
                exact = body.extent(0) + std::abs(body.rotation[3 * axis + 1]) *
                                             reference::kUnitUlp * body.extent(1);
            } else {
                for (int column = 0; column < 3; ++column) {
                    exact += std::abs(body.rotation[3 * axis + column]) * reference::kUnitUlp *
                             body.extent(column);
                }
            }
            EXPECT_GE(half[axis] * kLengthUlp, exact);
            EXPECT_LE(half[axis] * kLengthUlp, exact + 4 * kLengthUlp);
        }
    }
}

TEST(Bounds, RadiusReachesTheFarthestCornerRoundedUp) {
    const Body box = Body::box(3, 4, 12);
    EXPECT_EQ(bounding_radius(ShapeType::box, box.size), raw_length(13));
    const Body odd = Body::box(1, 1, 1);
    const std::int32_t radius = bounding_radius(ShapeType::box, odd.size);
    EXPECT_GE(radius * kLengthUlp, std::sqrt(3.0));
    EXPECT_LT(radius * kLengthUlp, std::sqrt(3.0) + kLengthUlp);
    const Body capsule = Body::capsule(0.5, 2);
    EXPECT_EQ(bounding_radius(ShapeType::capsule, capsule.size), raw_length(2.5));
    EXPECT_EQ(bounding_radius(ShapeType::sphere, Body::sphere(7).size), raw_length(7));
    EXPECT_EQ(bounding_radius(ShapeType::plane, Body::plane().size), 0);
}

TEST(Bounds, OfTheLargestBoxFitTheFormat) {
    const Body box = Body::box(250, 250, 250);
    const std::int32_t radius = bounding_radius(ShapeType::box, box.size);
    EXPECT_NEAR(radius * kLengthUlp, 250 * std::sqrt(3.0), 1e-6);
}

TEST(Bounds, OnlyAPlaneHasNone) {
    EXPECT_TRUE(is_bounded(ShapeType::sphere));
    EXPECT_TRUE(is_bounded(ShapeType::capsule));
    EXPECT_TRUE(is_bounded(ShapeType::box));
    EXPECT_FALSE(is_bounded(ShapeType::plane));
}

} // namespace
} // namespace lockwind
