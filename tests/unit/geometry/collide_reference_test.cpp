#include "geometry/bounds.h"
#include "geometry/collide.h"
#include "random_body.h"

#include <gtest/gtest.h>
#include <string>
#include <tuple>

namespace lockwind {
namespace {

using reference::Body;
using reference::kLengthUlp;
using reference::Random;
using reference::raw_length;
using reference::Vec;

constexpr double kMargin = kSpeculativeMargin * kLengthUlp;
constexpr double kSlop = kLinearSlop * kLengthUlp;
constexpr double kTolerance = 4 * kLengthUlp;

Body draw_body(Random& random, ShapeType type, double scale = 1) {
    return reference::random_body(random, type, scale, 12);
}

/// A pair of random shapes within centimetres of contact.
struct Pair {
    Body a;
    Body b;
    std::int32_t delta[3];

    Vec offset() const { return reference::metres(delta); }
    double distance() const { return reference::distance(a, b, offset()); }
    ManifoldGeometry collide_pair() const {
        ManifoldGeometry manifold;
        collide(a.instance(), b.instance(), delta, {}, manifold);
        return manifold;
    }
    Pair swapped() const { return {b, a, {-delta[0], -delta[1], -delta[2]}}; }
};

bool is_polytope(ShapeType type) {
    return type == ShapeType::box || type == ShapeType::hull;
}

Pair random_pair(Random& random, ShapeType type_a, ShapeType type_b) {
    Pair pair{draw_body(random, type_a), draw_body(random, type_b), {}};
    Vec direction = random.direction();
    double low = 0;
    double high = 8;
    if (type_a == ShapeType::plane || type_b == ShapeType::plane) {
        direction = type_a == ShapeType::plane ? pair.a.axis(1) : pair.b.axis(1) * -1;
    }
    const bool boxes = type_a == ShapeType::box && type_b == ShapeType::box;
    const bool polytopes = is_polytope(type_a) && is_polytope(type_b);
    while (high - low > 0.02) {
        const Vec middle = direction * ((low + high) / 2);
        double distance = 0;
        if (boxes) {
            distance = reference::box_axes_separation(pair.a, pair.b, middle);
        } else if (polytopes) {
            distance = axes_separation(solid_of(pair.a, {0, 0, 0}), solid_of(pair.b, middle));
        } else {
            distance = reference::distance(pair.a, pair.b, middle);
        }
        (distance > 0 ? high : low) = (low + high) / 2;
    }
    const Vec delta = direction * (low + random.uniform(-0.08, 0.06));
    for (int axis = 0; axis < 3; ++axis) {
        pair.delta[axis] = raw_length(delta[axis]);
    }
    return pair;
}

double least_separation(const ManifoldGeometry& manifold) {
    double least = 1e9;
    for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
        least = std::min(least, manifold.points[index].separation * kLengthUlp);
    }
    return least;
}

bool are_near(const std::int32_t a[3], const std::int32_t b[3]) {
    return reference::length(reference::metres(a) - reference::metres(b)) < 2 * kTolerance;
}

double thickness(const Body& body) {
    switch (body.type) {
    case ShapeType::box:
        return std::min({body.extent(0), body.extent(1), body.extent(2)});
    case ShapeType::plane:
        return 1e9;
    case ShapeType::hull:
        return body.shape->width_least * kLengthUlp;
    default:
        return body.extent(0);
    }
}

class CollidePairs : public testing::TestWithParam<std::tuple<ShapeType, ShapeType>> {
protected:
    ShapeType type_a() const { return std::get<0>(GetParam()); }
    ShapeType type_b() const { return std::get<1>(GetParam()); }
    bool has(ShapeType type) const { return type_a() == type || type_b() == type; }
    bool two_boxes() const { return type_a() == ShapeType::box && type_b() == ShapeType::box; }
    bool two_polytopes() const { return is_polytope(type_a()) && is_polytope(type_b()); }
    bool has_polytope() const { return is_polytope(type_a()) || is_polytope(type_b()); }
    bool two_capsules() const {
        return type_a() == ShapeType::capsule && type_b() == ShapeType::capsule;
    }
    /// Depth is only known where no polytope's inside is involved.
    bool has_exact_depth() const {
        return !two_polytopes() && !(has_polytope() && has(ShapeType::capsule));
    }
    std::uint64_t seed() const {
        return 100 + 4 * static_cast<std::uint64_t>(type_a()) +
               static_cast<std::uint64_t>(type_b());
    }
    int rounds() const {
        if (has(ShapeType::hull)) {
            return two_polytopes() ? 250 : 800;
        }
        return two_boxes() ? 600 : 1500;
    }
};

std::string pair_name(const testing::TestParamInfo<std::tuple<ShapeType, ShapeType>>& info) {
    constexpr const char* kNames[] = {"Sphere", "Capsule", "Box", "Plane", "Hull"};
    return std::string(kNames[static_cast<int>(std::get<0>(info.param))]) +
           kNames[static_cast<int>(std::get<1>(info.param))];
}

TEST_P(CollidePairs, TouchIfAndOnlyIfTheyAreNear) {
    Random random(seed());
    int touching = 0;
    int missed_near = 0;
    for (int round = 0; round < rounds(); ++round) {
        const Pair pair = random_pair(random, type_a(), type_b());
        const double distance = pair.distance();
        const ManifoldGeometry manifold = pair.collide_pair();
        touching += manifold.point_count != 0 ? 1 : 0;
        if (manifold.point_count != 0) {
            EXPECT_LE(distance, kMargin + kTolerance);
        } else {
            EXPECT_GT(distance, -kTolerance) << "overlap without a contact";
            missed_near += distance < kMargin - kTolerance ? 1 : 0;
        }
    }
    EXPECT_GT(touching, rounds() / 2);
    // Boxes whose nearest features are a corner and a corner or edge touch when they overlap only.
    EXPECT_LE(missed_near, two_boxes() ? rounds() / 100 : 0);
}

TEST_P(CollidePairs, SeparationIsTheDistance) {
    Random random(seed() + 1000);
    // A face may speak for a nearly aligned nearest point: by a slop at most.
    const bool by_faces = !has_exact_depth();
    for (int round = 0; round < rounds(); ++round) {
        const Pair pair = random_pair(random, type_a(), type_b());
        const double distance = pair.distance();
        const ManifoldGeometry manifold = pair.collide_pair();
        if (manifold.point_count == 0 || (distance < 0 && by_faces && !two_polytopes())) {
            continue;
        }
        const double found = least_separation(manifold);
        if (!by_faces) {
            EXPECT_NEAR(found, distance, kTolerance);
            continue;
        }
        EXPECT_GT(found, distance - (distance < 0 ? kSlop : 0) - kTolerance);
        if (!two_polytopes()) {
            EXPECT_LT(found, distance + kSlop + kTolerance);
        }
    }
}

TEST_P(CollidePairs, PointsLieMidwayBetweenTheSurfaces) {
    Random random(seed() + 2000);
    for (int round = 0; round < rounds(); ++round) {
        const Pair pair = random_pair(random, type_a(), type_b());
        const ManifoldGeometry manifold = pair.collide_pair();
        const Vec normal = reference::unit(manifold.normal);
        if (manifold.point_count == 0) {
            continue;
        }
        EXPECT_NEAR(reference::length(normal), 1, 8 * reference::kUnitUlp);
        const double least = least_separation(manifold);
        for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
            const ManifoldPoint& point = manifold.points[index];
            const double separation = point.separation * kLengthUlp;
            const Vec from_a = pair.a.to_world(reference::metres(point.local_a));
            const Vec from_b = pair.b.to_world(reference::metres(point.local_b));
            EXPECT_LT(reference::length(from_a - from_b - pair.offset()), kTolerance);
            // Deeper than that below the thinner shape's surface the point is not halfway any more.
            if (separation < -std::min(thickness(pair.a), thickness(pair.b)) / 2) {
                continue;
            }
            // A capsule's end that comes along need not be its surface's nearest part; and a face's
            // normal may stand in for the capsule's, 3.6 degrees off.
            if (has(ShapeType::capsule) &&
                (separation > least + kTolerance || (two_capsules() && manifold.point_count > 1))) {
                continue;
            }
            const double tolerance =
                has(ShapeType::capsule) && has_polytope() ? kSlop : 2 * kTolerance;
            const double half = separation / 2;
            EXPECT_NEAR(pair.a.distance(from_a - normal * half), 0, tolerance);
            EXPECT_NEAR(pair.b.distance(from_b + normal * half), 0, tolerance);
        }
    }
}

TEST_P(CollidePairs, PointsStayNearTheThinnerShapeHoweverDeep) {
    Random random(seed() + 6000);
    int touching = 0;
    for (int round = 0; round < rounds(); ++round) {
        // Up to 40 m around shapes of 5 cm to 2 m.
        const bool grow = random.bits() % 2 != 0;
        Pair pair{draw_body(random, type_a(), grow ? 20 : 1),
                  draw_body(random, type_b(), grow ? 1 : 20),
                  {}};
        const Vec delta = random.direction() * random.uniform(0, 42);
        for (int axis = 0; axis < 3; ++axis) {
            pair.delta[axis] = raw_length(delta[axis]);
        }
        const ManifoldGeometry manifold = pair.collide_pair();
        touching += manifold.point_count != 0 ? 1 : 0;
        const bool a_is_thinner = thickness(pair.a) < thickness(pair.b);
        const Body& thinner = a_is_thinner ? pair.a : pair.b;
        for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
            const ManifoldPoint& point = manifold.points[index];
            const std::int32_t* local = a_is_thinner ? point.local_a : point.local_b;
            const double radius =
                (thinner.type == ShapeType::hull ? thinner.shape->bounding_radius
                                                 : bounding_radius(thinner.type, thinner.size)) *
                kLengthUlp;
            EXPECT_LT(reference::length(reference::metres(local)),
                      radius * 1.25 + kMargin / 2 + kTolerance);
        }
    }
    EXPECT_GT(touching, rounds() / 10);
}

TEST_P(CollidePairs, MovingBAlongTheNormalByTheOverlapParts) {
    Random random(seed() + 3000);
    for (int round = 0; round < rounds(); ++round) {
        Pair pair = random_pair(random, type_a(), type_b());
        const ManifoldGeometry manifold = pair.collide_pair();
        if (manifold.point_count == 0 || two_polytopes()) {
            continue;
        }
        const double way = 0.03 - least_separation(manifold);
        for (int axis = 0; axis < 3; ++axis) {
            pair.delta[axis] += raw_length(manifold.normal[axis] * reference::kUnitUlp * way);
        }
        EXPECT_EQ(pair.collide_pair().point_count, 0U);
    }
}

TEST_P(CollidePairs, SwappingThemTurnsTheResultRound) {
    Random random(seed() + 4000);
    int compared = 0;
    for (int round = 0; round < rounds(); ++round) {
        const Pair pair = random_pair(random, type_a(), type_b());
        const ManifoldGeometry manifold = pair.collide_pair();
        const ManifoldGeometry swapped = pair.swapped().collide_pair();
        const Vec normal = reference::unit(manifold.normal);
        const Vec reverse = reference::unit(swapped.normal);
        if (two_polytopes() && manifold.point_count > 0 && swapped.point_count > 0 &&
            reference::length(normal + reverse) > 1e-6) {
            continue; // faces that are equally good: either may be the reference
        }
        ASSERT_EQ(manifold.point_count == 0, swapped.point_count == 0);
        if (manifold.point_count == 0) {
            continue;
        }
        ++compared;
        if (two_capsules()) {
            // Where along nearly parallel capsules they touch is A's to say.
            EXPECT_LT(reference::length(normal + reverse), 1e-4);
            EXPECT_NEAR(least_separation(manifold), least_separation(swapped), kTolerance);
            continue;
        }
        ASSERT_EQ(manifold.point_count, swapped.point_count);
        EXPECT_LT(reference::length(normal + reverse), 16 * reference::kUnitUlp);
        for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
            const ManifoldPoint& point = manifold.points[index];
            bool found = false;
            for (std::uint32_t other = 0; other < swapped.point_count; ++other) {
                const ManifoldPoint& candidate = swapped.points[other];
                found = found || (are_near(point.local_a, candidate.local_b) &&
                                  are_near(point.local_b, candidate.local_a) &&
                                  std::abs(point.separation - candidate.separation) <= 4);
            }
            EXPECT_TRUE(found) << "round " << round;
        }
    }
    EXPECT_GT(compared, rounds() / 3);
}

/// turn after body's own turn.
Body turned(const Body& body, const Body& turn) {
    Body result = body;
    if (body.type == ShapeType::sphere) {
        return result;
    }
    for (int column = 0; column < 3; ++column) {
        const Vec axis = turn.to_world(body.axis(column));
        for (int row = 0; row < 3; ++row) {
            result.rotation[3 * row + column] =
                static_cast<std::int32_t>(std::lround(axis[row] / reference::kUnitUlp));
        }
    }
    return result;
}

TEST_P(CollidePairs, TurningThePairTurnsTheResult) {
    Random random(seed() + 5000);
    int compared = 0;
    for (int round = 0; round < rounds(); ++round) {
        const Pair pair = random_pair(random, type_a(), type_b());
        Body turn = Body::box(1, 1, 1);
        turn.turn(random.direction(), random.uniform(0, 3));
        const Vec offset = turn.to_world(pair.offset());
        const Pair other{turned(pair.a, turn),
                         turned(pair.b, turn),
                         {raw_length(offset[0]), raw_length(offset[1]), raw_length(offset[2])}};
        const ManifoldGeometry manifold = pair.collide_pair();
        const ManifoldGeometry expected = other.collide_pair();
        if (manifold.point_count == 0 || expected.point_count == 0) {
            continue;
        }
        ++compared;
        EXPECT_NEAR(least_separation(manifold), least_separation(expected), 2 * kTolerance);
    }
    EXPECT_GT(compared, rounds() / 3);
}

INSTANTIATE_TEST_SUITE_P(Types,
                         CollidePairs,
                         testing::Values(std::tuple{ShapeType::sphere, ShapeType::sphere},
                                         std::tuple{ShapeType::sphere, ShapeType::capsule},
                                         std::tuple{ShapeType::sphere, ShapeType::box},
                                         std::tuple{ShapeType::sphere, ShapeType::plane},
                                         std::tuple{ShapeType::capsule, ShapeType::capsule},
                                         std::tuple{ShapeType::capsule, ShapeType::box},
                                         std::tuple{ShapeType::plane, ShapeType::capsule},
                                         std::tuple{ShapeType::box, ShapeType::box},
                                         std::tuple{ShapeType::plane, ShapeType::box},
                                         std::tuple{ShapeType::hull, ShapeType::sphere},
                                         std::tuple{ShapeType::hull, ShapeType::capsule},
                                         std::tuple{ShapeType::hull, ShapeType::plane},
                                         std::tuple{ShapeType::hull, ShapeType::box},
                                         std::tuple{ShapeType::hull, ShapeType::hull}),
                         pair_name);

} // namespace
} // namespace lockwind
