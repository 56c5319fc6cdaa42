#include "geometry/collide.h"
#include "hull_points.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <set>

namespace lockwind {
namespace {

using namespace reference;

Hull made(const Points& points) {
    const Result<Hull> hull = make_hull(to_real(points));
    EXPECT_TRUE(hull.ok()) << (hull.ok() ? "" : hull.error().message);
    return hull.ok() ? hull.value() : Hull{};
}

ManifoldGeometry
touch(const Body& a, const Body& b, const Vec& offset, const ManifoldCache& cache = {}) {
    const std::int32_t delta[3] = {
        raw_length(offset[0]), raw_length(offset[1]), raw_length(offset[2])};
    ManifoldGeometry manifold;
    collide(a.instance(), b.instance(), delta, cache, manifold);
    return manifold;
}

/// Points of A's frame, Q9.22, with their separations, sorted.
std::vector<std::array<std::int64_t, 4>> sorted_points(const ManifoldGeometry& manifold) {
    std::vector<std::array<std::int64_t, 4>> points;
    for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
        const ManifoldPoint& point = manifold.points[index];
        points.push_back({point.local_a[0], point.local_a[1], point.local_a[2], point.separation});
    }
    return points;
}

/// Whether each point of one has a twin in the other, all components within `ulps`.
bool same_points(const ManifoldGeometry& a, const ManifoldGeometry& b, std::int64_t ulps) {
    const auto of_a = sorted_points(a);
    auto of_b = sorted_points(b);
    for (const auto& point : of_a) {
        const auto twin = std::find_if(of_b.begin(), of_b.end(), [&](const auto& other) {
            bool same = true;
            for (std::size_t index = 0; index < 4; ++index) {
                same = same && std::abs(point[index] - other[index]) <= ulps;
            }
            return same;
        });
        if (twin == of_b.end()) {
            return false;
        }
        of_b.erase(twin);
    }
    return of_b.empty();
}

std::set<std::uint32_t> features(const ManifoldGeometry& manifold) {
    std::set<std::uint32_t> result;
    for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
        result.insert(manifold.points[index].feature);
    }
    return result;
}

constexpr std::int64_t kUlps = 4;

TEST(CollideHull, CubeStandsOnCubeAsBoxOnBox) {
    const Body box = Body::box(0.5, 0.5, 0.5);
    const Body cube = Body::hull(made(box_points(0.5, 0.5, 0.5)));
    Random random(51);
    for (int round = 0; round < 200; ++round) {
        // Turned about y: four points where the squares overlap in four corners, else reduced ones.
        const double angle = random.uniform(-0.2, 0.2);
        const Vec offset{random.uniform(-0.3, 0.3), 0.999, random.uniform(-0.3, 0.3)};
        Body upper_box = box;
        Body upper_cube = cube;
        upper_box.turn({0, 1, 0}, round % 2 == 0 ? 0 : angle);
        upper_cube.turn({0, 1, 0}, round % 2 == 0 ? 0 : angle);
        const ManifoldGeometry boxes = touch(box, upper_box, offset);
        const ManifoldGeometry hulls = touch(cube, upper_cube, offset);
        const ManifoldGeometry mixed = touch(cube, upper_box, offset);
        ASSERT_EQ(boxes.point_count, 4U);
        ASSERT_EQ(hulls.point_count, 4U);
        ASSERT_EQ(mixed.point_count, 4U);
        EXPECT_LT(length(unit(boxes.normal) - unit(hulls.normal)), 1e-8);
        if (round % 2 == 0) { // straight: the overlap has four corners, nothing is reduced
            EXPECT_TRUE(same_points(boxes, hulls, kUlps));
            EXPECT_TRUE(same_points(boxes, mixed, kUlps));
        }
        EXPECT_EQ(features(hulls).size(), 4U);
    }
}

TEST(CollideHull, RandomCubesTouchAsBoxesDo) {
    Random random(52);
    int compared = 0;
    int same = 0;
    for (int round = 0; round < 4000; ++round) {
        const double half[2] = {random.uniform(0.2, 1), random.uniform(0.2, 1)};
        const Vec axes[2] = {random.direction(), random.direction()};
        const double angles[2] = {random.uniform(0, 3), random.uniform(0, 3)};
        Body boxes[2] = {Body::box(half[0], half[0], half[0]),
                         Body::box(half[1], half[1], half[1])};
        Body hulls[2] = {Body::hull(made(box_points(half[0], half[0], half[0]))),
                         Body::hull(made(box_points(half[1], half[1], half[1])))};
        for (int side = 0; side < 2; ++side) {
            boxes[side].turn(axes[side], angles[side]);
            hulls[side].turn(axes[side], angles[side]);
        }
        const Vec offset = random.direction() * random.uniform(0.7, 1.5) * (half[0] + half[1]);
        const ManifoldGeometry of_boxes = touch(boxes[0], boxes[1], offset);
        const ManifoldGeometry of_hulls = touch(hulls[0], hulls[1], offset);
        if (of_boxes.point_count == 0 || of_hulls.point_count == 0) {
            continue;
        }
        ++compared;
        // Where the clip has more than four corners another four may be kept; and edges that are
        // as good as a face may be chosen instead.
        const bool equal = of_boxes.point_count == of_hulls.point_count &&
                           length(unit(of_boxes.normal) - unit(of_hulls.normal)) < 1e-7 &&
                           same_points(of_boxes, of_hulls, kUlps);
        same += equal ? 1 : 0;
    }
    EXPECT_GT(compared, 1500);
    EXPECT_GT(same, compared * 9 / 10) << "of " << compared;
}

/// What a pair that did not touch remembers may save time; it may not change what is found.
TEST(CollideHull, NoSeparatingAxisThatIsRememberedChangesTheContact) {
    Random random(53);
    int touching = 0;
    int trusted = 0;
    for (int round = 0; round < 3000; ++round) {
        const Vec half{random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.2, 1)};
        const bool hulls = round % 3 == 0;
        Body bodies[2] = {Body::box(half[0], half[1], half[2]), Body::box(0.5, 0.4, 0.6)};
        if (hulls) {
            bodies[0] = Body::hull(made(box_points(half[0], half[1], half[2])));
        }
        for (Body& body : bodies) {
            body.turn(random.direction(), random.uniform(0, 3));
        }
        const Vec offset = random.direction() * random.uniform(0.6, 2);
        const ManifoldGeometry plain = touch(bodies[0], bodies[1], offset);
        touching += plain.point_count != 0 ? 1 : 0;
        for (std::uint32_t axis = 1; axis <= (hulls ? 2 * kHullFacesMax : 15U); ++axis) {
            ManifoldCache cache;
            cache.axis = axis;
            const ManifoldGeometry other = touch(bodies[0], bodies[1], offset, cache);
            ASSERT_EQ(other.point_count, plain.point_count) << "axis " << axis;
            if (plain.point_count == 0) {
                trusted += other.axis == axis ? 1 : 0;
                continue;
            }
            ASSERT_TRUE(std::equal(plain.normal, plain.normal + 3, other.normal));
            ASSERT_EQ(sorted_points(plain), sorted_points(other));
            ASSERT_EQ(plain.axis, other.axis);
            ASSERT_EQ(plain.axis_separation, other.axis_separation);
        }
    }
    EXPECT_GT(touching, 500);
    EXPECT_GT(trusted, 2000);
}

TEST(CollideHull, CubeStandsOnThePlaneAsTheBoxDoes) {
    Random random(53);
    for (int round = 0; round < 300; ++round) {
        Body box = Body::box(0.3, 0.4, 0.5);
        Body hull = Body::hull(made(box_points(0.3, 0.4, 0.5)));
        const Vec axis = random.direction();
        const double tilt = random.uniform(-0.4, 0.4);
        box.turn(axis, tilt);
        hull.turn(axis, tilt);
        const Vec offset{0, random.uniform(0.1, 0.4), 0};
        const ManifoldGeometry of_box = touch(Body::plane(), box, offset);
        const ManifoldGeometry of_hull = touch(Body::plane(), hull, offset);
        ASSERT_EQ(of_box.point_count, 4U);
        EXPECT_TRUE(same_points(of_box, of_hull, kUlps));
        for (int component = 0; component < 3; ++component) {
            EXPECT_EQ(of_box.normal[component], of_hull.normal[component]);
        }
    }
}

TEST(CollideHull, FeaturesLastWhileAHullSlidesAndTurns) {
    const Body lower = Body::hull(made(prism_points(6, 1, 0.5)));
    Body upper = Body::hull(made(prism_points(5, 0.4, 0.3)));
    ManifoldCache cache;
    std::set<std::uint32_t> last;
    int changes = 0;
    for (int step = 0; step < 200; ++step) {
        // 1 mm and 1 mrad a step, well inside the lower face.
        upper.turn({0, 1, 0}, 0.001 * step);
        const ManifoldGeometry manifold =
            touch(lower, upper, {-0.1 + 0.001 * step, 0.7995, 0.05}, cache);
        ASSERT_GE(manifold.point_count, 3U);
        cache = {manifold.axis, manifold.axis_separation, true};
        changes += step > 0 && features(manifold) != last ? 1 : 0;
        last = features(manifold);
        EXPECT_EQ(last.size(), manifold.point_count);
    }
    // Of five corners four are kept: which ones may change as the polygon turns.
    EXPECT_LE(changes, 2);
}

TEST(CollideHull, AnyCacheIsSurvivedAndChangesNoTouch) {
    Random random(54);
    int touching = 0;
    for (int round = 0; round < 3000; ++round) {
        Body a = Body::hull(random_hull(random, 10, 1));
        Body b = round % 2 == 0 ? Body::hull(random_hull(random, 10, 1)) : Body::box(0.4, 0.3, 0.5);
        a.turn(random.direction(), random.uniform(0, 3));
        b.turn(random.direction(), random.uniform(0, 3));
        const Vec offset = random.direction() * random.uniform(0.2, 2);
        const ManifoldGeometry plain = touch(a, b, offset);
        const ManifoldCache cache{static_cast<std::uint32_t>(random.bits() % 256),
                                  static_cast<std::int32_t>(random.bits()),
                                  round % 3 == 0};
        const ManifoldGeometry found = touch(a, b, offset, cache);
        EXPECT_EQ(plain.point_count == 0, found.point_count == 0);
        EXPECT_LE(found.axis, 2 * kHullFacesMax);
        touching += plain.point_count != 0 ? 1 : 0;
    }
    EXPECT_GT(touching, 500);
}

TEST(CollideHull, RestingReferenceFaceIsKeptWhileItsSeparationHolds) {
    const Body lower = Body::hull(made(box_points(1, 0.5, 1)));
    Body upper = Body::hull(made(box_points(0.5, 0.5, 0.5)));
    const ManifoldGeometry first = touch(lower, upper, {0, 0.999, 0});
    ASSERT_NE(first.axis, 0U);
    // Tilted by 1 mrad the upper one's face separates as well: it must not take the lead.
    for (const double tilt : {-0.001, 0.001}) {
        upper.turn({1, 0, 0}, tilt);
        const ManifoldGeometry next =
            touch(lower, upper, {0, 0.999, 0}, {first.axis, first.axis_separation, true});
        EXPECT_EQ(next.axis, first.axis);
        EXPECT_EQ(next.axis_separation, first.axis_separation);
    }
    // Lifted by 10 mm it is chosen anew.
    const ManifoldGeometry lifted =
        touch(lower, upper, {0, 1.009, 0}, {first.axis, first.axis_separation, true});
    EXPECT_NE(lifted.axis_separation, first.axis_separation);
}

TEST(CollideHull, CapsuleLiesOnTwoPointsOfAFace) {
    const Body slab = Body::hull(made(prism_points(8, 2, 0.5)));
    Body capsule = Body::capsule(0.25, 0.6);
    capsule.turn({1, 0, 0}, 1.5707963);
    const ManifoldGeometry manifold = touch(slab, capsule, {0.1, 0.745, 0});
    ASSERT_EQ(manifold.point_count, 2U);
    for (std::uint32_t index = 0; index < 2; ++index) {
        EXPECT_NEAR(manifold.points[index].separation * kLengthUlp, -0.005, 1e-5);
        EXPECT_NEAR(std::abs(metres(manifold.points[index].local_a)[2]), 0.6, 1e-5);
    }
    EXPECT_NEAR(unit(manifold.normal)[1], 1, 1e-7);
}

TEST(CollideHull, BallDeepInsideLeavesThroughTheNearestFace) {
    const Body cube = Body::hull(made(box_points(1, 1, 1)));
    const ManifoldGeometry manifold = touch(cube, Body::sphere(0.25), {0.1, 0.8, -0.2});
    ASSERT_EQ(manifold.point_count, 1U);
    EXPECT_NEAR(unit(manifold.normal)[1], 1, 1e-8);
    EXPECT_NEAR(manifold.points[0].separation * kLengthUlp, -0.2 - 0.25, 2 * kLengthUlp);
}

TEST(CollideHull, SmallOnesMeetTheLargestFixedOneAtItsFarCorner) {
    const Body ground = Body::hull(made(box_points(249, 2, 249)));
    for (const double x : {-248.0, 0.0, 248.0}) {
        const Body hull = Body::hull(made(octahedron_points(0.3)));
        const ManifoldGeometry manifold = touch(ground, hull, {x, 2.29, -248});
        ASSERT_EQ(manifold.point_count, 1U) << x;
        EXPECT_NEAR(manifold.points[0].separation * kLengthUlp, -0.01, 1e-5);
        EXPECT_NEAR(metres(manifold.points[0].local_a)[0], x, 1e-5);
    }
}

} // namespace
} // namespace lockwind
