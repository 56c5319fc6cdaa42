#include "geometry/ray_cast.h"
#include "hull_points.h"
#include "reference.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

using reference::Body;
using reference::Random;
using reference::Vec;

struct Cast {
    bool hit;
    ShapeRayHit raw;

    double fraction() const { return static_cast<double>(raw.fraction) * 0x1p-32; }
    Vec point() const {
        return {static_cast<double>(raw.point[0]) * 0x1p-32,
                static_cast<double>(raw.point[1]) * 0x1p-32,
                static_cast<double>(raw.point[2]) * 0x1p-32};
    }
    Vec normal() const { return reference::unit(raw.normal); }
};

void to_raw(const Vec& v, std::int64_t raw[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        raw[axis] = std::llround(v[axis] * 0x1p32);
    }
}

Cast cast(const Body& body, const Vec& centre, const Vec& from, const Vec& to) {
    std::int64_t raw[3][3];
    to_raw(centre, raw[0]);
    to_raw(from, raw[1]);
    to_raw(to, raw[2]);
    Cast result{};
    result.hit = ray_cast(body.instance(), raw[0], raw[1], raw[2], result.raw);
    return result;
}

void expect_vector(const Vec& found, const Vec& expected, double tolerance) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(found[axis], expected[axis], tolerance);
    }
}

constexpr double kExact = 0x1p-31;

TEST(RayCast, SphereInTheMiddle) {
    const Cast hit = cast(Body::sphere(0.5), {10, 2, 0}, {0, 2, 0}, {20, 2, 0});
    ASSERT_TRUE(hit.hit);
    EXPECT_NEAR(hit.fraction(), 9.5 / 20, kExact);
    expect_vector(hit.point(), {9.5, 2, 0}, 4 * kExact);
    expect_vector(hit.normal(), {-1, 0, 0}, 1e-8);
}

TEST(RayCast, SphereGrazedAndMissed) {
    const Body sphere = Body::sphere(0.5);
    const Cast grazed = cast(sphere, {0, 0, 0}, {-5, 0.4, 0}, {5, 0.4, 0});
    ASSERT_TRUE(grazed.hit);
    expect_vector(grazed.point(), {-0.3, 0.4, 0}, 1e-8);
    expect_vector(grazed.normal(), {-0.6, 0.8, 0}, 1e-8);
    EXPECT_FALSE(cast(sphere, {0, 0, 0}, {-5, 0.5001, 0}, {5, 0.5001, 0}).hit);
    EXPECT_FALSE(cast(sphere, {0, 0, 0}, {-5, 0, 0}, {-0.51, 0, 0}).hit);
    EXPECT_TRUE(cast(sphere, {0, 0, 0}, {-5, 0, 0}, {-0.49, 0, 0}).hit);
    EXPECT_FALSE(cast(sphere, {0, 0, 0}, {5, 0, 0}, {6, 0, 0}).hit);
}

TEST(RayCast, BoxOnEachFace) {
    const Body box = Body::box(1, 2, 3);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            Vec from{0.25, 0.5, -0.75};
            Vec to = from;
            from.component[axis] = 10 * side;
            to.component[axis] = -10 * side;
            const Cast hit = cast(box, {0, 0, 0}, from, to);
            ASSERT_TRUE(hit.hit);
            EXPECT_NEAR(hit.fraction(), (10 - box.extent(axis)) / 20, kExact);
            Vec normal{0, 0, 0};
            normal.component[axis] = side;
            expect_vector(hit.normal(), normal, 0);
        }
    }
}

TEST(RayCast, BoxMissedBesideItsEdge) {
    const Body box = Body::box(1, 1, 1);
    // Past the edge x = y = 1, diagonally: x + y = 2.02 and 1.98.
    EXPECT_FALSE(cast(box, {0, 0, 0}, {3, -0.98, 0}, {-0.98, 3, 0}).hit);
    EXPECT_TRUE(cast(box, {0, 0, 0}, {3, -1.02, 0}, {-1.02, 3, 0}).hit);
    EXPECT_FALSE(cast(box, {0, 0, 0}, {3, 1.5, 0}, {-3, 1.5, 0}).hit);
}

TEST(RayCast, HullOnItsFaces) {
    const Hull hull = make_hull(reference::to_real(reference::octahedron_points(1))).value();
    const Cast face = cast(Body::hull(hull), {5, 0, 0}, {8, 3, 3}, {2, -3, -3});
    ASSERT_TRUE(face.hit);
    // x + y + z = 1 along the diagonal.
    expect_vector(face.point(), {5 + 1.0 / 3, 1.0 / 3, 1.0 / 3}, 1e-6);
    const double third = 1 / std::sqrt(3.0);
    expect_vector(face.normal(), {third, third, third}, 1e-6);
    EXPECT_FALSE(cast(Body::hull(hull), {0, 0, 0}, {3, 1.01, 0}, {-3, 1.01, 0}).hit);
    EXPECT_FALSE(cast(Body::hull(hull), {0, 0, 0}, {0, 3, 0}, {0, 1.01, 0}).hit);
    EXPECT_TRUE(cast(Body::hull(hull), {0, 0, 0}, {0, 3, 0}, {0, 0.99, 0}).hit);
}

TEST(RayCast, CapsuleSideAndEnds) {
    const Body capsule = Body::capsule(0.5, 1);
    const Cast side = cast(capsule, {0, 0, 0}, {4, 0.9, 0}, {-4, 0.9, 0});
    ASSERT_TRUE(side.hit);
    expect_vector(side.point(), {0.5, 0.9, 0}, 1e-8);
    expect_vector(side.normal(), {1, 0, 0}, 1e-8);
    const Cast top = cast(capsule, {0, 0, 0}, {0, 9, 0}, {0, -9, 0});
    ASSERT_TRUE(top.hit);
    expect_vector(top.point(), {0, 1.5, 0}, 1e-8);
    expect_vector(top.normal(), {0, 1, 0}, 1e-8);
    const Cast shoulder = cast(capsule, {0, 0, 0}, {4, -1.3, 0}, {-4, -1.3, 0});
    ASSERT_TRUE(shoulder.hit);
    expect_vector(shoulder.point(), {0.4, -1.3, 0}, 1e-6);
    expect_vector(shoulder.normal(), {0.8, -0.6, 0}, 1e-6);
    EXPECT_FALSE(cast(capsule, {0, 0, 0}, {4, 1.51, 0}, {-4, 1.51, 0}).hit);
}

TEST(RayCast, PlaneFromAboveOnly) {
    const Body plane = Body::plane();
    const Cast hit = cast(plane, {100, 1, -50}, {3, 5, 7}, {3, -3, 7});
    ASSERT_TRUE(hit.hit);
    EXPECT_NEAR(hit.fraction(), 0.5, kExact);
    expect_vector(hit.point(), {3, 1, 7}, kExact);
    expect_vector(hit.normal(), {0, 1, 0}, 0);
    EXPECT_FALSE(cast(plane, {0, 0, 0}, {0, -1, 0}, {0, -2, 0}).hit);
    EXPECT_FALSE(cast(plane, {0, 0, 0}, {0, -1, 0}, {0, 2, 0}).hit);
    EXPECT_FALSE(cast(plane, {0, 0, 0}, {0, 2, 0}, {5, 2, 0}).hit);
}

TEST(RayCast, StartingInsideOrGoingNowhereDoesNotHit) {
    const Hull hull = make_hull(reference::to_real(reference::octahedron_points(1))).value();
    const Body bodies[] = {
        Body::sphere(1), Body::capsule(1, 1), Body::box(1, 1, 1), Body::hull(hull)};
    for (const Body& body : bodies) {
        EXPECT_FALSE(cast(body, {0, 0, 0}, {0.1, 0.2, 0.1}, {9, 0, 0}).hit);
        EXPECT_FALSE(cast(body, {0, 0, 0}, {3, 0, 0}, {3, 0, 0}).hit);
    }
}

TEST(RayCast, GroundOfThreeHundredMetresFromAfar) {
    const Body ground = Body::box(150, 1, 150);
    const Cast hit = cast(ground, {0, -1, 0}, {140, 1000, -140}, {140, -1000, -140});
    ASSERT_TRUE(hit.hit);
    EXPECT_NEAR(hit.fraction(), 0.5, kExact);
    expect_vector(hit.point(), {140, 0, -140}, kExact);
    expect_vector(hit.normal(), {0, 1, 0}, 0);
    // Nearly along its surface, over its whole width.
    const Cast flat = cast(ground, {0, -1, 0}, {-149, 0.001, 0}, {149, -0.001, 0});
    ASSERT_TRUE(flat.hit);
    EXPECT_NEAR(flat.fraction(), 0.5, 1e-6);
    EXPECT_FALSE(cast(ground, {0, -1, 0}, {-149, 0.002, 0}, {149, 0.001, 0}).hit);
}

TEST(RayCast, IsAsExactThirtyKilometresOut) {
    const Vec centre{30000, 5, -30000};
    const Cast box =
        cast(Body::box(1, 1, 1), centre, centre + Vec{0, 7, 0}, centre + Vec{0, -1, 0});
    ASSERT_TRUE(box.hit);
    EXPECT_NEAR(box.fraction(), 0.75, kExact);
    expect_vector(box.point(), centre + Vec{0, 1, 0}, kExact);
    const Cast sphere =
        cast(Body::sphere(1), centre, centre + Vec{7, 0, 0}, centre + Vec{-1, 0, 0});
    ASSERT_TRUE(sphere.hit);
    EXPECT_NEAR(sphere.fraction(), 0.75, 4 * kExact);
}

TEST(RayCast, SixtyKilometreRayFindsASmallSphere) {
    const Cast hit = cast(Body::sphere(0.1), {7, 3, -2}, {-30000, 3, -2}, {30000, 3, -2});
    ASSERT_TRUE(hit.hit);
    // The fraction's own resolution is 14 um here; the point is exact.
    expect_vector(hit.point(), {6.9, 3, -2}, 1e-6);
    EXPECT_FALSE(cast(Body::sphere(0.1), {7, 3, -2}, {-30000, 3.101, -2}, {30000, 3.101, -2}).hit);
}

TEST(RayCast, BeyondTheRangeHitsNothing) {
    EXPECT_FALSE(cast(Body::sphere(1), {0, 0, 0}, {0, 70000, 0}, {0, -70000, 0}).hit);
    EXPECT_TRUE(cast(Body::sphere(1), {0, 0, 0}, {0, 65000, 0}, {0, -65000, 0}).hit);
}

TEST(RayCast, TinySegmentsAreCastToo) {
    // A tenth of a millimetre across the surface.
    const Cast hit = cast(Body::sphere(0.5), {0, 0, 0}, {0.50005, 0, 0}, {0.49995, 0, 0});
    ASSERT_TRUE(hit.hit);
    EXPECT_NEAR(hit.fraction(), 0.5, 1e-5);
}

/// Marches along the ray by the distance to the surface (sphere tracing); negative where it misses.
double traced_fraction(const Body& body, const Vec& centre, const Vec& from, const Vec& to) {
    const Vec way = to - from;
    const double size = reference::length(way);
    double along = 0;
    for (int step = 0; step < 20000 && along <= size; ++step) {
        const double distance = body.distance(from + way * (along / size) - centre);
        if (distance < 1e-9) {
            return along / size;
        }
        along += distance;
    }
    return -1;
}

TEST(RayCast, AgreesWithSphereTracing) {
    Random random(41);
    int hits = 0;
    for (int round = 0; round < 4000; ++round) {
        const auto size = [&] { return random.uniform(0.05, 3); };
        Body body = Body::sphere(size());
        if (round % 4 == 1) {
            body = Body::capsule(size(), size());
        } else if (round % 4 == 2) {
            body = Body::box(size(), size(), size());
        } else if (round % 4 == 3) {
            body = Body::hull(reference::random_hull(random, 10, 2));
        }
        body.turn(random.direction(), random.uniform(0, 3));
        const Vec centre = random.direction() * random.uniform(0, 100);
        const Vec from = centre + random.direction() * random.uniform(0.1, 20);
        const Vec to = centre + random.direction() * random.uniform(0, 4);
        if (body.distance(from - centre) < 1e-3) {
            EXPECT_TRUE(body.distance(from - centre) > -1e-3 || !cast(body, centre, from, to).hit);
            continue;
        }
        const Cast found = cast(body, centre, from, to);
        const double expected = traced_fraction(body, centre, from, to);
        // Grazing rays may go either way.
        double nearest = 1e9;
        for (int step = 0; step <= 400; ++step) {
            nearest = std::min(
                nearest, std::abs(body.distance(from + (to - from) * (step / 400.0) - centre)));
        }
        if (found.hit != (expected >= 0)) {
            EXPECT_LT(nearest, 0.01);
            continue;
        }
        if (!found.hit) {
            continue;
        }
        ++hits;
        EXPECT_NEAR(found.fraction(), expected, 1e-5);
        EXPECT_NEAR(body.distance(found.point() - centre), 0, 2.4e-7); // a hull's faces: 2^-22 m
        EXPECT_NEAR(reference::length(found.normal()), 1, 1e-8);
        EXPECT_LT(reference::dot(found.normal(), to - from), 1e-6);
        // A small step along the normal leaves the surface by as much.
        EXPECT_NEAR(body.distance(found.point() + found.normal() * 1e-3 - centre), 1e-3, 1e-6);
    }
    EXPECT_GT(hits, 1000);
}

} // namespace
} // namespace lockwind
