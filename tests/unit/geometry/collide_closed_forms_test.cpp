#include "geometry/collide.h"
#include "reference.h"

#include <gtest/gtest.h>
#include <vector>

namespace lockwind {
namespace {

using reference::Body;
using reference::kLengthUlp;
using reference::kUnitUlp;
using reference::raw_length;
using reference::Vec;

constexpr double kTolerance = 4 * kLengthUlp;
constexpr double kPi = 3.14159265358979323846;

struct Collision {
    ManifoldGeometry manifold;
    Body a;
    Body b;
    Vec delta;

    double separation(std::uint32_t index = 0) const {
        return manifold.points[index].separation * kLengthUlp;
    }
    Vec normal() const { return reference::unit(manifold.normal); }
    /// From A's centre, world axes.
    Vec point(std::uint32_t index = 0) const {
        return a.to_world(reference::metres(manifold.points[index].local_a));
    }
    bool has_point(const Vec& expected, double tolerance = kTolerance) const {
        for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
            if (reference::length(point(index) - expected) < tolerance) {
                return true;
            }
        }
        return false;
    }
};

Collision run(const Body& a, const Body& b, const Vec& delta, const ManifoldCache& cache = {}) {
    const std::int32_t raw[3] = {raw_length(delta[0]), raw_length(delta[1]), raw_length(delta[2])};
    Collision collision{{}, a, b, reference::metres(raw)};
    collide(a.instance(), b.instance(), raw, cache, collision.manifold);
    return collision;
}

void expect_vector(const Vec& found, const Vec& expected, double tolerance) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(found[axis], expected[axis], tolerance);
    }
}

/// Both anchors of every point name the same place.
void expect_common_points(const Collision& collision) {
    for (std::uint32_t index = 0; index < collision.manifold.point_count; ++index) {
        const Vec from_b =
            collision.b.to_world(reference::metres(collision.manifold.points[index].local_b));
        expect_vector(from_b + collision.delta, collision.point(index), kTolerance);
    }
}

TEST(CollideSpheres, MeetOnTheLineBetweenTheirCentres) {
    const Collision hit = run(Body::sphere(1), Body::sphere(0.5), {0, 0, 1.25});
    ASSERT_EQ(hit.manifold.point_count, 1U);
    EXPECT_NEAR(hit.separation(), -0.25, kTolerance);
    expect_vector(hit.normal(), {0, 0, 1}, 0);
    expect_vector(hit.point(), {0, 0, 0.875}, kTolerance);
    expect_common_points(hit);
}

TEST(CollideSpheres, TouchWithinTheMarginOnly) {
    EXPECT_EQ(run(Body::sphere(1), Body::sphere(1), {2.0199, 0, 0}).manifold.point_count, 1U);
    EXPECT_EQ(run(Body::sphere(1), Body::sphere(1), {2.0201, 0, 0}).manifold.point_count, 0U);
    EXPECT_EQ(run(Body::sphere(1), Body::sphere(1), {300, 300, 300}).manifold.point_count, 0U);
}

TEST(CollideSphereCapsule, SideAndEnd) {
    const Body capsule = Body::capsule(0.25, 1);
    const Body sphere = Body::sphere(0.5);
    const Collision side = run(capsule, sphere, {0.7, 0.5, 0});
    ASSERT_EQ(side.manifold.point_count, 1U);
    EXPECT_NEAR(side.separation(), -0.05, kTolerance);
    expect_vector(side.normal(), {1, 0, 0}, 0);
    expect_vector(side.point(), {0.225, 0.5, 0}, kTolerance);

    const Collision end = run(sphere, capsule, {0, -1.8, 0});
    ASSERT_EQ(end.manifold.point_count, 0U);
    const Collision touching = run(sphere, capsule, {0, -1.74, 0});
    ASSERT_EQ(touching.manifold.point_count, 1U);
    EXPECT_NEAR(touching.separation(), -0.01, kTolerance);
    expect_vector(touching.normal(), {0, -1, 0}, 0);
    expect_vector(touching.point(), {0, -0.495, 0}, kTolerance);
    expect_common_points(touching);
}

TEST(CollideBoxSphere, FaceEdgeAndCorner) {
    const Body box = Body::box(1, 2, 3);
    const Body sphere = Body::sphere(0.5);
    const Collision face = run(box, sphere, {0.3, 2.49, -1});
    ASSERT_EQ(face.manifold.point_count, 1U);
    EXPECT_NEAR(face.separation(), -0.01, kTolerance);
    expect_vector(face.normal(), {0, 1, 0}, 0);
    expect_vector(face.point(), {0.3, 1.995, -1}, kTolerance);

    const Collision edge = run(box, sphere, {1.3, 2.4, 0});
    ASSERT_EQ(edge.manifold.point_count, 1U);
    EXPECT_NEAR(edge.separation(), 0, kTolerance);
    expect_vector(edge.normal(), {0.6, 0.8, 0}, 1e-6);
    expect_vector(edge.point(), {1, 2, 0}, kTolerance);

    const Collision corner = run(sphere, box, {-1.2, -2.2, 3.2});
    ASSERT_EQ(corner.manifold.point_count, 1U);
    EXPECT_NEAR(corner.separation(), std::sqrt(0.12) - 0.5, kTolerance);
    const double third = 1 / std::sqrt(3.0);
    expect_vector(corner.normal(), {-third, -third, third}, 1e-5);
    expect_common_points(corner);
}

TEST(CollideBoxSphere, CentreInsideLeavesThroughTheNearestFace) {
    const Collision inside = run(Body::box(1, 2, 3), Body::sphere(0.5), {-0.9, 0, 0.1});
    ASSERT_EQ(inside.manifold.point_count, 1U);
    EXPECT_NEAR(inside.separation(), -0.6, kTolerance);
    expect_vector(inside.normal(), {-1, 0, 0}, 0);
    // Not halfway, but a quarter of the radius below the sphere's far side.
    expect_vector(inside.point(), {-0.4 - 0.125, 0, 0.1}, kTolerance);
    expect_common_points(inside);
}

TEST(CollideCapsules, ParallelOnesTouchAlongTheirOverlap) {
    const Collision hit = run(Body::capsule(0.5, 1), Body::capsule(0.25, 1), {0.74, 0.5, 0});
    ASSERT_EQ(hit.manifold.point_count, 2U);
    EXPECT_NEAR(hit.separation(0), -0.01, kTolerance);
    EXPECT_NEAR(hit.separation(1), -0.01, kTolerance);
    expect_vector(hit.normal(), {1, 0, 0}, 0);
    EXPECT_TRUE(hit.has_point({0.495, -0.5, 0}));
    EXPECT_TRUE(hit.has_point({0.495, 1, 0}));
    EXPECT_NE(hit.manifold.points[0].feature, hit.manifold.points[1].feature);
    expect_common_points(hit);
}

TEST(CollideCapsules, CrossingOnesTouchInOnePoint) {
    Body across = Body::capsule(0.25, 1);
    across.turn({1, 0, 0}, kPi / 2);
    const Collision hit = run(Body::capsule(0.5, 1), across, {-0.76, 0.5, 0.2});
    ASSERT_EQ(hit.manifold.point_count, 1U);
    EXPECT_NEAR(hit.separation(), 0.01, kTolerance);
    expect_vector(hit.normal(), {-1, 0, 0}, 1e-8);
    expect_vector(hit.point(), {-0.505, 0.5, 0}, kTolerance);
    expect_common_points(hit);
}

TEST(CollideCapsules, EndToEnd) {
    const Collision hit = run(Body::capsule(0.5, 1), Body::capsule(0.5, 1), {0, 2.99, 0});
    ASSERT_EQ(hit.manifold.point_count, 1U);
    EXPECT_NEAR(hit.separation(), -0.01, kTolerance);
    expect_vector(hit.normal(), {0, 1, 0}, 0);
}

TEST(CollideBoxCapsule, LyingOnAFaceRestsOnTwoPoints) {
    Body capsule = Body::capsule(0.25, 1);
    capsule.turn({0, 0, 1}, kPi / 2);
    const Collision hit = run(Body::box(5, 1, 5), capsule, {2, 1.24, 1});
    ASSERT_EQ(hit.manifold.point_count, 2U);
    EXPECT_NEAR(hit.separation(0), -0.01, kTolerance);
    EXPECT_NEAR(hit.separation(1), -0.01, kTolerance);
    expect_vector(hit.normal(), {0, 1, 0}, 0);
    EXPECT_TRUE(hit.has_point({1, 0.995, 1}));
    EXPECT_TRUE(hit.has_point({3, 0.995, 1}));
    expect_common_points(hit);
}

TEST(CollideBoxCapsule, OverhangingItKeepsThePartAboveTheFace) {
    Body capsule = Body::capsule(0.25, 1);
    capsule.turn({0, 0, 1}, kPi / 2);
    const Collision hit = run(capsule, Body::box(5, 1, 5), {-4.5, -1.25, 0});
    ASSERT_EQ(hit.manifold.point_count, 2U);
    expect_vector(hit.normal(), {0, -1, 0}, 0);
    EXPECT_TRUE(hit.has_point({-1, -0.25, 0}));
    EXPECT_TRUE(hit.has_point({0.5, -0.25, 0}));
}

TEST(CollideBoxCapsule, StandingOnAFaceRestsOnItsEnd) {
    const Collision hit = run(Body::box(5, 1, 5), Body::capsule(0.25, 1), {0, 2.26, 0});
    ASSERT_EQ(hit.manifold.point_count, 1U);
    EXPECT_NEAR(hit.separation(), 0.01, kTolerance);
    expect_vector(hit.normal(), {0, 1, 0}, 0);
    expect_vector(hit.point(), {0, 1.005, 0}, kTolerance);
}

TEST(CollideBoxCapsule, AcrossAnEdge) {
    Body capsule = Body::capsule(0.25, 1);
    capsule.turn({0, 0, 1}, kPi / 4); // its axis runs towards -x +y
    const double s = std::sqrt(0.5);
    const Collision hit = run(Body::box(1, 1, 1), capsule, {1 + 0.26 * s, 1 + 0.26 * s, 0.3});
    ASSERT_EQ(hit.manifold.point_count, 1U);
    EXPECT_NEAR(hit.separation(), 0.01, kTolerance);
    expect_vector(hit.normal(), {s, s, 0}, 1e-6);
    expect_vector(hit.point(), {1 + 0.005 * s, 1 + 0.005 * s, 0.3}, 1e-5);
}

TEST(CollideBoxCapsule, SunkThroughAFaceIsPushedBackOutOfIt) {
    Body capsule = Body::capsule(0.1, 1);
    capsule.turn({0, 0, 1}, kPi / 2);
    const Collision hit = run(Body::box(5, 1, 5), capsule, {0, 0.9, 0});
    ASSERT_EQ(hit.manifold.point_count, 2U);
    EXPECT_NEAR(hit.separation(0), -0.2, kTolerance);
    EXPECT_NEAR(hit.separation(1), -0.2, kTolerance);
    expect_vector(hit.normal(), {0, 1, 0}, 0);
}

TEST(CollideBoxCapsule, SunkAcrossAnEdgeIsPushedOutAcrossIt) {
    Body capsule = Body::capsule(0.1, 2);
    capsule.turn({0, 0, 1}, kPi / 4);
    const double s = std::sqrt(0.5);
    const Collision hit = run(Body::box(1, 1, 1), capsule, {1 - 0.05 * s, 1 - 0.05 * s, 0});
    ASSERT_EQ(hit.manifold.point_count, 1U);
    EXPECT_NEAR(hit.separation(), -0.15, kTolerance);
    expect_vector(hit.normal(), {s, s, 0}, 1e-6);
    expect_common_points(hit);
}

TEST(CollideBoxes, FaceOnFaceGivesTheFourCornersOfTheOverlap) {
    const Collision hit = run(Body::box(1, 0.5, 1), Body::box(1, 0.5, 1), {0.5, 0.99, -0.25});
    ASSERT_EQ(hit.manifold.point_count, 4U);
    expect_vector(hit.normal(), {0, 1, 0}, 0);
    for (std::uint32_t index = 0; index < 4; ++index) {
        EXPECT_NEAR(hit.separation(index), -0.01, kTolerance);
    }
    EXPECT_TRUE(hit.has_point({1, 0.495, 0.75}));
    EXPECT_TRUE(hit.has_point({1, 0.495, -1}));
    EXPECT_TRUE(hit.has_point({-0.5, 0.495, 0.75}));
    EXPECT_TRUE(hit.has_point({-0.5, 0.495, -1}));
    expect_common_points(hit);
}

TEST(CollideBoxes, EightCornersAreReducedToFourThatSpanTheOctagon) {
    Body turned = Body::box(0.5, 0.5, 0.5);
    turned.turn({0, 1, 0}, kPi / 4);
    const Collision hit = run(Body::box(0.5, 0.5, 0.5), turned, {0, 1, 0});
    ASSERT_EQ(hit.manifold.point_count, 4U);
    // The octagon's corners are 0.5 / cos 22.5 degrees away; four of them hold half its area at
    // least.
    double area = 0;
    std::vector<double> angles;
    for (std::uint32_t index = 0; index < 4; ++index) {
        const Vec point = hit.point(index);
        EXPECT_NEAR(std::hypot(point[0], point[2]), 0.5 / std::cos(kPi / 8), 1e-5);
        angles.push_back(std::atan2(point[2], point[0]));
    }
    std::sort(angles.begin(), angles.end());
    for (std::size_t index = 0; index < 4; ++index) {
        const double next = index < 3 ? angles[index + 1] : angles[0] + 2 * kPi;
        area += std::sin(next - angles[index]) / 2 * 0.25 / std::pow(std::cos(kPi / 8), 2);
    }
    EXPECT_GT(area, 0.4); // of 0.83 m^2
}

TEST(CollideBoxes, CornerOnFaceIsPenetratedByItsDepth) {
    Body tilted = Body::box(0.5, 0.5, 0.5);
    // A diagonal up: the lowest corner is sqrt(3)/2 below the centre.
    tilted.turn({1 / std::sqrt(2.0), 0, -1 / std::sqrt(2.0)}, std::acos(1 / std::sqrt(3.0)));
    const double depth = std::sqrt(3.0) / 2 - 0.01;
    const Collision hit = run(Body::box(5, 1, 5), tilted, {0, 1 + depth, 0});
    ASSERT_GE(hit.manifold.point_count, 1U);
    double lowest = 1;
    for (std::uint32_t index = 0; index < hit.manifold.point_count; ++index) {
        lowest = std::min(lowest, hit.separation(index));
    }
    EXPECT_NEAR(lowest, -0.01, kTolerance);
    expect_vector(hit.normal(), {0, 1, 0}, 1e-8);
}

TEST(CollideBoxes, CrossedEdgesTouchInOnePoint) {
    // Two ridges: A's along x, B's along z, meeting at the height sqrt(2)/2 of each.
    Body a = Body::box(2, 0.5, 0.5);
    a.turn({1, 0, 0}, kPi / 4);
    Body b = Body::box(0.5, 0.5, 2);
    b.turn({0, 0, 1}, kPi / 4);
    const double height = std::sqrt(2.0);
    const Collision hit = run(a, b, {0.4, height - 0.004, -0.3});
    ASSERT_EQ(hit.manifold.point_count, 1U);
    EXPECT_NEAR(hit.separation(), -0.004, kTolerance);
    expect_vector(hit.normal(), {0, 1, 0}, 1e-8);
    expect_vector(hit.point(), {0.4, height / 2 - 0.002, 0}, 1e-5);
    expect_common_points(hit);
}

TEST(CollideBoxes, SeparatingAxisIsRememberedAndTrusted) {
    const Body box = Body::box(0.5, 0.5, 0.5);
    const Collision apart = run(box, box, {0, 1.1, 0});
    EXPECT_EQ(apart.manifold.point_count, 0U);
    EXPECT_EQ(apart.manifold.axis, 2U);
    ManifoldCache cache;
    cache.axis = apart.manifold.axis;
    const Collision still_apart = run(box, box, {0.1, 1.03, 0}, cache);
    EXPECT_EQ(still_apart.manifold.point_count, 0U);
    EXPECT_EQ(still_apart.manifold.axis, 2U);
    const Collision together = run(box, box, {0.1, 1.01, 0}, cache);
    EXPECT_EQ(together.manifold.point_count, 4U);
}

TEST(CollidePlane, SphereRestsOnIt) {
    const Collision hit = run(Body::plane(), Body::sphere(0.5), {0, 0.49, 0});
    ASSERT_EQ(hit.manifold.point_count, 1U);
    EXPECT_NEAR(hit.separation(), -0.01, kTolerance);
    expect_vector(hit.normal(), {0, 1, 0}, 0);
    expect_vector(hit.point(), {0, -0.005, 0}, kTolerance);
    const Collision reverse = run(Body::sphere(0.5), Body::plane(), {0, -0.49, 0});
    expect_vector(reverse.normal(), {0, -1, 0}, 0);
    EXPECT_EQ(run(Body::plane(), Body::sphere(0.5), {0, 0.5201, 0}).manifold.point_count, 0U);
}

TEST(CollidePlane, CapsuleHasBothEnds) {
    Body capsule = Body::capsule(0.25, 1);
    capsule.turn({0, 0, 1}, kPi / 3); // 60 degrees off the vertical
    const Collision hit = run(Body::plane(), capsule, {0, 0.7, 0});
    ASSERT_EQ(hit.manifold.point_count, 2U);
    EXPECT_NEAR(hit.separation(0), 0.7 - 0.5 - 0.25, kTolerance);
    EXPECT_NEAR(hit.separation(1), 0.7 + 0.5 - 0.25, kTolerance);
    expect_common_points(hit);
}

TEST(CollidePlane, BoxRestsOnItsFourLowestCorners) {
    const Collision hit = run(Body::plane(), Body::box(1, 0.5, 2), {0, 0.49, 0});
    ASSERT_EQ(hit.manifold.point_count, 4U);
    for (std::uint32_t index = 0; index < 4; ++index) {
        EXPECT_NEAR(hit.separation(index), -0.01, kTolerance);
    }
    for (const double x : {-1.0, 1.0}) {
        for (const double z : {-2.0, 2.0}) {
            EXPECT_TRUE(hit.has_point({x, -0.005, z}));
        }
    }
    expect_common_points(hit);
}

TEST(CollidePlane, TallBoxOnItsEndKeepsThatEnd) {
    Body box = Body::box(0.1, 2, 0.1);
    box.turn({0, 0, 1}, 0.3);
    const Collision hit = run(Body::plane(), box, {0, 2 * std::cos(0.3), 0});
    ASSERT_EQ(hit.manifold.point_count, 4U);
    EXPECT_NEAR(hit.separation(0), -0.1 * std::sin(0.3), kTolerance);
    EXPECT_NEAR(hit.separation(3), 0.1 * std::sin(0.3), kTolerance);
}

TEST(CollidePlane, IsTheSameThirtyKilometresFromItsOrigin) {
    Body plane = Body::plane();
    const Body box = Body::box(1, 0.5, 2);
    const std::int64_t one = std::int64_t{1} << 32;
    const std::int64_t origin[3] = {-30000 * one, 7 * one, 30000 * one};
    const std::int64_t place[3] = {30000 * one, 7 * one + one / 2, -30000 * one};
    std::int32_t delta[3];
    centre_delta_plane(plane.instance(), origin, box.instance(), place, delta);
    EXPECT_EQ(delta[0], 0);
    EXPECT_EQ(delta[1], raw_length(0.5));
    EXPECT_EQ(delta[2], 0);
    ManifoldGeometry manifold;
    collide(plane.instance(), box.instance(), delta, {}, manifold);
    ASSERT_EQ(manifold.point_count, 4U);
    for (const ManifoldPoint& point : manifold.points) {
        EXPECT_EQ(point.separation, 0);
    }
    centre_delta_plane(box.instance(), place, plane.instance(), origin, delta);
    EXPECT_EQ(delta[1], -raw_length(0.5));
}

TEST(CollidePlane, TiltedAndFarIsRightToItsMatrix) {
    Body plane = Body::plane();
    plane.turn({0, 0, 1}, 0.2);
    const Vec normal = plane.axis(1);
    const double along = 40000;
    // 3 m above the plane, 40 km down its slope.
    const Vec place = normal * 3 + plane.axis(0) * along;
    std::int64_t raw[3];
    for (int axis = 0; axis < 3; ++axis) {
        raw[axis] = static_cast<std::int64_t>(place[axis] * 0x1p32);
    }
    const std::int64_t origin[3] = {0, 0, 0};
    std::int32_t delta[3];
    const Body sphere = Body::sphere(2.995);
    centre_delta_plane(plane.instance(), origin, sphere.instance(), raw, delta);
    EXPECT_NEAR(reference::length(reference::metres(delta)), 3, along * 2 * kUnitUlp);
    ManifoldGeometry manifold;
    collide(plane.instance(), sphere.instance(), delta, {}, manifold);
    ASSERT_EQ(manifold.point_count, 1U);
    EXPECT_NEAR(manifold.points[0].separation * kLengthUlp, 0.005, along * 2 * kUnitUlp);
}

TEST(CollidePlane, DeepBelowStaysFinite) {
    const Body plane = Body::plane();
    const Body box = Body::box(40, 40, 40);
    const std::int64_t origin[3] = {0, 0, 0};
    const std::int64_t place[3] = {0, -(std::int64_t{30000} << 32), 0};
    std::int32_t delta[3];
    centre_delta_plane(plane.instance(), origin, box.instance(), place, delta);
    ManifoldGeometry manifold;
    collide(plane.instance(), box.instance(), delta, {}, manifold);
    ASSERT_EQ(manifold.point_count, 4U);
    EXPECT_LT(manifold.points[0].separation * kLengthUlp, -400);
    EXPECT_EQ(manifold.normal[1], kUnitOne);
}

} // namespace
} // namespace lockwind
