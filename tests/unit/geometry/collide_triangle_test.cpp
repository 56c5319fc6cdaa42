#include "geometry/collide.h"
#include "random_body.h"
#include "surface_shapes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace lockwind {
namespace {

using namespace reference;

constexpr double kMargin = kSpeculativeMargin * kLengthUlp;
constexpr double kSlop = kLinearSlop * kLengthUlp;

/// A triangle alone, seen from anywhere; its frame's origin is the middle of its bounds.
Surface lone_triangle(Random& random, double size) {
    for (;;) {
        std::vector<Vec3> vertices;
        for (int corner = 0; corner < 3; ++corner) {
            const double distance = random.uniform(0.2, 1) * size;
            vertices.push_back(to_real(random.direction() * distance));
        }
        Result<Surface> surface = make_mesh({vertices, {0, 1, 2}});
        if (surface.ok()) {
            return std::move(surface).value();
        }
    }
}

double height_over(const Surface& surface, std::uint32_t index, const Vec& point) {
    return dot(unit(surface.triangle(index).normal), point - corner_of(surface, index, 0));
}

/// Somewhere near a triangle, no nearer to its plane than `low`.
Vec near_place(Random& random, const Surface& surface, double reach, double low) {
    const Vec a = corner_of(surface, 0, 0);
    const Vec b = corner_of(surface, 0, 1);
    const Vec c = corner_of(surface, 0, 2);
    const double s = random.uniform(-0.3, 1.3);
    const double t = random.uniform(-0.3, 1.3);
    const double height = random.uniform(low, reach);
    return a + (b - a) * s + (c - a) * t + unit(surface.triangle(0).normal) * height;
}

TEST(CollideTriangle, BallTouchesWhereItIsNear) {
    Random random(31);
    int touched = 0;
    int beside = 0;
    for (int round = 0; round < 20000; ++round) {
        const Surface surface = lone_triangle(random, 2);
        const double radius = random.uniform(0.05, 1);
        const Body ball = Body::sphere(radius);
        const Vec place = near_place(random, surface, radius + 0.1, 0.001);
        const double gap = point_surface(place, surface) - radius;
        const auto contacts = touch_all(surface, ball, place);
        if (gap > kMargin + 1e-5) {
            EXPECT_TRUE(contacts.empty());
        } else if (gap < kMargin - 1e-5) {
            ASSERT_EQ(contacts.size(), 1U);
            EXPECT_EQ(contacts[0].point_count, 1U);
            const double error = lowest_separation(contacts) - gap;
            // Snapped to the face within 2^-9: by a part 2^-19 of the distance.
            EXPECT_NEAR(error, 0, 5e-6);
            ++touched;
            beside += dot(unit(contacts[0].normal), unit(surface.triangle(0).normal)) < 0.99;
        }
    }
    EXPECT_GT(touched, 5000);
    EXPECT_GT(beside, 500);
}

TEST(CollideTriangle, NothingTouchesFromBehind) {
    Random random(32);
    for (int round = 0; round < 4000; ++round) {
        const Surface surface = lone_triangle(random, 1);
        for (const ShapeType type : kConvexTypes) {
            const Body body = random_body(random, type, 0.3);
            const Vec place = near_place(random, surface, -0.002, -0.6);
            EXPECT_TRUE(touch_all(surface, body, place).empty());
        }
    }
}

double capsule_distance(const Surface& surface, const Body& capsule, const Vec& place) {
    return minimum(-capsule.extent(1), capsule.extent(1), [&](double along) {
        return point_surface(place + capsule.axis(1) * along, surface);
    });
}

TEST(CollideTriangle, CapsuleTouchesWhereItIsNear) {
    Random random(33);
    int touched = 0;
    int lying = 0;
    for (int round = 0; round < 10000; ++round) {
        const Surface surface = lone_triangle(random, 2);
        const double radius = random.uniform(0.05, 0.5);
        Body capsule = Body::capsule(radius, random.uniform(0.05, 1));
        const Vec turn = random.direction();
        capsule.turn(turn, random.uniform(0, 3.14));
        const double low =
            std::abs(dot(capsule.axis(1), unit(surface.triangle(0).normal))) * capsule.extent(1) +
            0.001;
        const Vec place = near_place(random, surface, low + capsule.extent(0) + 0.1, low);
        const double gap = capsule_distance(surface, capsule, place) - capsule.extent(0);
        const auto contacts = touch_all(surface, capsule, place);
        if (gap > kMargin + 1e-4) {
            EXPECT_TRUE(contacts.empty());
        } else if (gap < kMargin - kSlop) {
            ASSERT_EQ(contacts.size(), 1U);
            // One that lies takes the face's normal within 3.6 degrees, and within a slop.
            EXPECT_NEAR(lowest_separation(contacts), gap, kSlop + 1e-5);
            ++touched;
            lying += contacts[0].point_count == 2;
        }
    }
    EXPECT_GT(touched, 2000);
    EXPECT_GT(lying, 100);
}

/// A point just beside the line over which a corner's outside and an edge's meet, as near to both
/// but for rounding; it lies off the triangle by `distance`.
Vec beside_corner(Random& random, const Surface& surface, double distance) {
    const auto edge = static_cast<std::uint32_t>(random.bits() % 3);
    const Vec from = corner_of(surface, 0, edge);
    const Vec way = corner_of(surface, 0, (edge + 1) % 3) - from;
    const Vec along = way * (1 / length(way));
    const Vec normal = unit(surface.triangle(0).normal);
    const double angle = random.uniform(0.01, 1.56);
    const Vec off = cross(along, normal) * std::cos(angle) + normal * std::sin(angle);
    const Vec end = random.bits() % 2 == 0 ? from : from + way;
    return end + along * random.uniform(-0.0008, 0.0008) + off * distance;
}

TEST(CollideTriangle, RoundShapesTouchWhereAnEdgeEndsInACorner) {
    // Feature and direction must be of one place: the corner's with the edge's point lay in
    // neither's cone, and six capsules of a million touched nothing.
    Random random(40);
    for (int round = 0; round < 20000; ++round) {
        const Surface surface = lone_triangle(random, 2);
        const double distance = random.uniform(0.1, 0.5);
        const Vec end = beside_corner(random, surface, distance);
        const double gap = point_surface(end, surface) - distance;
        const auto ball = touch_all(surface, Body::sphere(distance), end);
        ASSERT_EQ(ball.size(), 1U) << round;
        EXPECT_NEAR(lowest_separation(ball), gap, 5e-6);
        // A capsule that leads away from there: its end is nearest.
        const Vec normal = unit(surface.triangle(0).normal);
        Body capsule = Body::capsule(distance, random.uniform(0.05, 1));
        do {
            capsule.turn(random.direction(), random.uniform(0, 3.14));
        } while (dot(capsule.axis(1), normal) < 0.3);
        const Vec place = end + capsule.axis(1) * capsule.extent(1);
        const double capsule_gap = capsule_distance(surface, capsule, place) - distance;
        const auto contacts = touch_all(surface, capsule, place);
        ASSERT_EQ(contacts.size(), 1U) << round;
        EXPECT_NEAR(lowest_separation(contacts), capsule_gap, kSlop + 1e-5);
    }
}

/// A pyramid under a triangle that is not wider anywhere: as near as the triangle is to what lies
/// above it.
Solid solid_under(const Surface& surface) {
    const Vec a = corner_of(surface, 0, 0);
    const Vec b = corner_of(surface, 0, 1);
    const Vec c = corner_of(surface, 0, 2);
    const Vec middle = (a + b + c) * (1.0 / 3);
    return Solid({a, b, c, middle - unit(surface.triangle(0).normal)});
}

TEST(CollideTriangle, PolytopeTouchesWhereItIsNear) {
    Random random(34);
    int touched = 0;
    int missed = 0;
    int farther = 0;
    for (int round = 0; round < 12000; ++round) {
        const Surface surface = lone_triangle(random, 2);
        const Body body =
            random_body(random, round % 2 == 0 ? ShapeType::box : ShapeType::hull, 0.5);
        // All of it above the plane.
        double low = 0;
        for (const Vec& vertex : solid_of(body, {0, 0, 0}).vertices) {
            low = std::max(low, -dot(vertex, unit(surface.triangle(0).normal)));
        }
        const Vec place = near_place(random, surface, low + 0.03, low + 0.001);
        const double gap = distance(solid_under(surface), solid_of(body, place));
        const auto contacts = touch_all(surface, body, place);
        if (gap > kMargin + 1e-4) {
            EXPECT_TRUE(contacts.empty());
        } else if (gap < kMargin - 1e-4) {
            if (contacts.empty()) {
                ++missed; // corners and edges beside the triangle: no speculative contact
                continue;
            }
            ++touched;
            farther += lowest_separation(contacts) > gap + kSlop; // by which edges must beat faces
        }
    }
    EXPECT_GT(touched, 1000);
    EXPECT_LT(missed, touched / 4);
    EXPECT_LT(farther, touched / 50); // the nearest point lay beside what was clipped
}

TEST(CollideTriangle, PolytopeThatOverlapsTouches) {
    Random random(35);
    int touched = 0;
    int missed = 0;
    for (int round = 0; round < 4000; ++round) {
        const Surface surface = lone_triangle(random, 2);
        const Body body =
            random_body(random, round % 2 == 0 ? ShapeType::box : ShapeType::hull, 0.5);
        const Vec place = near_place(random, surface, 0.5, 0.001);
        const double depth = axes_separation(solid_under(surface), solid_of(body, place));
        if (depth > -0.01) {
            continue;
        }
        touch_all(surface, body, place).empty() ? ++missed : ++touched;
    }
    EXPECT_GT(touched, 500);
    EXPECT_LT(missed, touched / 4);
}

/// A flat floor of many triangles.
Surface flat_floor() {
    return made(make_height_field(field_of(16, 4, [](double, double) { return 0.0; })));
}

TEST(CollideTriangle, FlatFloorIsAPlane) {
    const Surface floor = flat_floor();
    const Body plane = Body::plane();
    Random random(36);
    int points = 0;
    int exact = 0;
    for (int round = 0; round < 3000; ++round) {
        const ShapeType type = kConvexTypes[round % 4];
        const Body body = random_body(random, type, 0.3);
        const double reach = distance(plane, body, {0, 0, 0}) * -1;
        const Vec place{
            random.uniform(-2, 2), reach + random.uniform(-0.05, 0.03), random.uniform(-2, 2)};
        const double gap = distance(plane, body, place);
        const auto contacts = touch_all(floor, body, place);
        if (gap > kMargin + 1e-5) {
            EXPECT_TRUE(contacts.empty());
            continue;
        }
        if (gap > kMargin - 1e-5 || place[1] < 0.001) {
            continue;
        }
        // No edge within the floor gives a normal of its own; the deepest point is the plane's.
        ASSERT_FALSE(contacts.empty());
        // Of more than four points over one triangle the deepest may be left out.
        const bool is_reduced =
            std::any_of(contacts.begin(), contacts.end(), [](const ManifoldGeometry& contact) {
                return contact.point_count == kManifoldPointsMax;
            });
        if (!is_reduced) {
            EXPECT_NEAR(lowest_separation(contacts), gap, 2e-5);
            ++exact;
        }
        for (const ManifoldGeometry& contact : contacts) {
            ASSERT_GT(contact.normal[1], kUnitOne - 1024);
            for (std::uint32_t point = 0; point < contact.point_count; ++point) {
                const Vec at = metres(contact.points[point].local_a);
                EXPECT_GE(contact.points[point].separation * kLengthUlp, gap - 2e-5);
                EXPECT_LT(std::abs(at[0]), 4.001);
                ++points;
            }
        }
    }
    EXPECT_GT(points, 3000);
    EXPECT_GT(exact, 1000);
}

TEST(CollideTriangle, BallOnRoughGroundTouchesItsNearestPlace) {
    // Edges and corners, convex and concave: whatever is nearest is told by some triangle, and
    // nothing is told to be nearer than it is.
    Random random(37);
    int touched = 0;
    int over_corners = 0;
    for (int field = 0; field < 20; ++field) {
        const double roughness = random.uniform(0.05, 0.8);
        const Surface ground = made(make_height_field(
            field_of(8, 2, [&](double, double) { return random.uniform(-roughness, roughness); })));
        for (int round = 0; round < 500; ++round) {
            const double radius = random.uniform(0.05, 0.6);
            const auto index = static_cast<std::uint32_t>(random.bits() % ground.triangle_count());
            // Above a triangle, along its normal; other ground may be nearer.
            const Vec on = corner_of(ground, index, 0) * 0.4 + corner_of(ground, index, 1) * 0.3 +
                           corner_of(ground, index, 2) * 0.3;
            const Vec place = on + random.direction() * (radius + 0.01);
            double above = 1e9; // of the nearest triangle's plane
            double nearest = 1e9;
            for (std::uint32_t other = 0; other < ground.triangle_count(); ++other) {
                const double gap = point_triangle(place,
                                                  corner_of(ground, other, 0),
                                                  corner_of(ground, other, 1),
                                                  corner_of(ground, other, 2));
                if (gap < nearest - 1e-7) {
                    nearest = gap;
                    above = height_over(ground, other, place);
                } else if (gap < nearest + 1e-7) {
                    // At a common edge or corner the one that it faces most tells the side.
                    const double height = height_over(ground, other, place);
                    above = std::abs(height) > std::abs(above) ? height : above;
                }
            }
            const auto contacts = touch_all(ground, Body::sphere(radius), place);
            if (above < 1e-3 || nearest - radius > kMargin - 1e-4 ||
                std::max(std::abs(place[0]), std::abs(place[2])) > 1.9) {
                continue;
            }
            ASSERT_FALSE(contacts.empty());
            EXPECT_NEAR(lowest_separation(contacts), nearest - radius, 1e-5);
            ++touched;
            over_corners += contacts.size() >= 4;
        }
    }
    EXPECT_GT(touched, 2000);
    EXPECT_GT(over_corners, 50);
}

TEST(CollideTriangle, BoxOnARidgeStandsOnIt) {
    // A roof of 45 degrees along z: a level box touches its ridge along a line, straight up.
    const Surface roof =
        made(make_height_field(field_of(4, 2, [](double x, double) { return -std::abs(x); })));
    const double top = 1; // above the middle of the bounds
    const Body box = Body::box(0.4, 0.3, 0.4);
    const auto contacts = touch_all(roof, box, {0.1, top + 0.299, 0});
    ASSERT_FALSE(contacts.empty());
    EXPECT_NEAR(lowest_separation(contacts), -0.001, 1e-5);
    double ends[2] = {1, -1};
    for (const ManifoldGeometry& contact : contacts) {
        EXPECT_NEAR(unit(contact.normal)[1], 1, 1e-6);
        for (std::uint32_t point = 0; point < contact.point_count; ++point) {
            if (contact.points[point].separation < 0) {
                ends[0] = std::min(ends[0], metres(contact.points[point].local_a)[2]);
                ends[1] = std::max(ends[1], metres(contact.points[point].local_a)[2]);
            }
        }
    }
    EXPECT_NEAR(ends[0], -0.4, 1e-3);
    EXPECT_NEAR(ends[1], 0.4, 1e-3);
}

TEST(CollideTriangle, ShapesInAValleyTouchItsSidesAlone) {
    // The valley's line is concave: nothing is pushed along any direction but the sides' normals.
    const Surface valley =
        made(make_height_field(field_of(4, 2, [](double x, double) { return std::abs(x); })));
    Random random(38);
    const double root = std::sqrt(0.5);
    int contacts_seen = 0;
    for (int round = 0; round < 2000; ++round) {
        const Body body = random_body(random, kConvexTypes[round % 4], 0.15);
        const Vec place{random.uniform(-0.3, 0.3), random.uniform(-0.9, -0.3), 0};
        if (place[1] + 1 < std::abs(place[0]) + 0.01) {
            continue; // below the ground
        }
        for (const ManifoldGeometry& contact : touch_all(valley, body, place)) {
            const Vec normal = unit(contact.normal);
            EXPECT_NEAR(normal[1], root, 1e-3);
            EXPECT_NEAR(std::abs(normal[0]), root, 1e-3);
            ++contacts_seen;
        }
    }
    EXPECT_GT(contacts_seen, 500);
}

TEST(CollideTriangle, FeaturesDifferAndStay) {
    Random random(39);
    int compared = 0;
    for (int round = 0; round < 2000; ++round) {
        const Surface surface = lone_triangle(random, 2);
        const Body body = random_body(random, kConvexTypes[round % 4], 0.5);
        const Vec place = near_place(random, surface, 0.6, 0.01);
        const auto before = touch_all(surface, body, place);
        const auto after = touch_all(surface, body, place + Vec{1e-6, 1e-6, 0});
        if (before.empty() || after.empty() || before[0].point_count != after[0].point_count) {
            continue;
        }
        for (std::uint32_t i = 0; i < before[0].point_count; ++i) {
            for (std::uint32_t j = 0; j < i; ++j) {
                EXPECT_NE(before[0].points[i].feature, before[0].points[j].feature);
            }
        }
        ++compared;
    }
    EXPECT_GT(compared, 500);
}

} // namespace
} // namespace lockwind
