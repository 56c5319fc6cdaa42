#include "geometry/hull.h"
#include "geometry/hull_surface.h"
#include "hull_points.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace lockwind {
namespace {

using namespace reference;

constexpr double kTolerance = kHullTolerance * kLengthUlp;

Hull made(const Points& points) {
    const Result<Hull> hull = make_hull(to_real(points));
    EXPECT_TRUE(hull.ok()) << (hull.ok() ? "" : hull.error().message);
    return hull.ok() ? hull.value() : Hull{};
}

std::string error_of(const Points& points) {
    const Result<Hull> hull = make_hull(to_real(points));
    return hull.ok() ? "(no error)" : hull.error().message;
}

double volume(const Hull& hull) {
    return std::ldexp(static_cast<double>(hull.volume.mantissa), -hull.volume.fraction);
}

double moment(const Hull& hull, int axis) {
    return static_cast<double>(hull.inertia.moment[axis].raw()) * 0x1p-44;
}

/// Vertices, edges, faces.
void expect_counts(const Hull& hull, std::uint32_t v, std::uint32_t e, std::uint32_t f) {
    EXPECT_EQ(hull.vertex_count, v);
    EXPECT_EQ(hull.edge_count, e);
    EXPECT_EQ(hull.face_count, f);
}

void expect_moments(const Hull& hull, const Vec& expected, double tolerance) {
    double found[3] = {moment(hull, 0), moment(hull, 1), moment(hull, 2)};
    double sorted[3] = {expected[0], expected[1], expected[2]};
    std::sort(found, found + 3);
    std::sort(sorted, sorted + 3);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(found[axis], sorted[axis], tolerance * sorted[axis]);
    }
}

/// What every hull must be, whatever its points.
void expect_sound(const Hull& hull, const Points& points) {
    ASSERT_EQ(hull.vertex_count + hull.face_count, hull.edge_count + 2); // Euler
    std::uint32_t corners = 0;
    for (std::uint32_t index = 0; index < hull.face_count; ++index) {
        const HullFace& face = hull.faces[index];
        ASSERT_GE(face.corner_count, 3);
        ASSERT_EQ(face.first_corner, corners);
        corners += face.corner_count;
        const Vec normal = unit(face.normal);
        EXPECT_NEAR(length(normal), 1, 4 * kUnitUlp);
        for (std::uint32_t vertex = 0; vertex < hull.vertex_count; ++vertex) {
            const double height =
                dot(normal, metres(hull.vertices[vertex].place)) - face.offset * kLengthUlp;
            EXPECT_LE(height, kLengthUlp);
            const bool is_corner = (hull.vertices[vertex].faces >> index & 1U) != 0;
            if (is_corner) {
                EXPECT_GE(height, -kTolerance - 2 * kLengthUlp);
            }
        }
        for (std::uint32_t corner = 0; corner < face.corner_count; ++corner) {
            const HullCorner& here = hull.corners[face.first_corner + corner];
            const HullCorner& next =
                hull.corners[face.first_corner + (corner + 1) % face.corner_count];
            ASSERT_LT(here.edge, hull.edge_count);
            const HullEdge& edge = hull.edges[here.edge];
            const bool is_left = edge.left == index;
            ASSERT_TRUE(is_left || edge.right == index);
            EXPECT_NE(edge.left, edge.right);
            EXPECT_EQ(is_left ? edge.from : edge.to, here.vertex);
            EXPECT_EQ(is_left ? edge.to : edge.from, next.vertex);
            EXPECT_NE(hull.vertices[here.vertex].faces >> index & 1U, 0U);
        }
    }
    ASSERT_EQ(corners, 2 * hull.edge_count);
    for (std::uint32_t index = 0; index < hull.edge_count; ++index) {
        const HullEdge& edge = hull.edges[index];
        const Vec way =
            metres(hull.vertices[edge.to].place) - metres(hull.vertices[edge.from].place);
        EXPECT_LT(length(way * (1 / length(way)) - unit(edge.direction)), 1e-6);
        const Vec across =
            cross(unit(hull.faces[edge.left].normal), unit(hull.faces[edge.right].normal));
        EXPECT_GT(dot(across, way), 0);
    }
    for (const Vec& point : points) {
        double highest = -1e9;
        for (std::uint32_t index = 0; index < hull.face_count; ++index) {
            const HullFace& face = hull.faces[index];
            const Vec normal = given(hull, unit(face.normal)) - given(hull, {0, 0, 0});
            highest = std::max(
                highest, dot(normal, point - given(hull, {0, 0, 0})) - face.offset * kLengthUlp);
        }
        EXPECT_LE(highest, kTolerance + 4 * kLengthUlp);
    }
}

TEST(Hull, OfACubeIsTheCube) {
    const Points points = box_points(0.5, 0.5, 0.5);
    const Hull hull = made(points);
    expect_counts(hull, 8, 12, 6);
    expect_sound(hull, points);
    EXPECT_DOUBLE_EQ(volume(hull), 1);
    expect_moments(hull, {1.0 / 6, 1.0 / 6, 1.0 / 6}, 1e-12);
    EXPECT_EQ(hull.orientation[3], kUnitOne);
    EXPECT_EQ(hull.centre[0], 0);
    EXPECT_EQ(hull.width_least, raw_length(0.5));
    EXPECT_EQ(hull.width_most, raw_length(0.5));
    EXPECT_NEAR(hull.bounding_radius * kLengthUlp, std::sqrt(0.75), 3 * kLengthUlp);
}

TEST(Hull, OfPlatonicSolidsHasThePublishedFigures) {
    // Edge a: volumes and moments / mass from H. S. M. Coxeter and any table of solids.
    const double a = 1;
    const Hull tetrahedron = made(tetrahedron_points(a / std::sqrt(8)));
    expect_counts(tetrahedron, 4, 6, 4);
    EXPECT_NEAR(volume(tetrahedron), 1 / (6 * std::sqrt(2)), 1e-6);
    expect_moments(tetrahedron, {0.05, 0.05, 0.05}, 1e-5);

    const Hull octahedron = made(octahedron_points(a / std::sqrt(2)));
    expect_counts(octahedron, 6, 12, 8);
    EXPECT_NEAR(volume(octahedron), std::sqrt(2) / 3, 1e-6);
    expect_moments(octahedron, {0.1, 0.1, 0.1}, 1e-5);

    const Hull icosahedron = made(icosahedron_points(a / 2));
    expect_counts(icosahedron, 12, 30, 20);
    const double phi = (1 + std::sqrt(5.0)) / 2;
    EXPECT_NEAR(volume(icosahedron), 5 * (3 + std::sqrt(5.0)) / 12, 3e-6);
    const double moment = phi * phi / 10;
    expect_moments(icosahedron, {moment, moment, moment}, 1e-5);
    // Rounded coordinates do not turn the axes of what has no other.
    EXPECT_EQ(icosahedron.orientation[3], kUnitOne);
}

TEST(Hull, OfAPrismHasThePublishedFigures) {
    const double radius = 0.5;
    const double half = 0.75;
    for (const int sides : {3, 6, 31}) {
        const Hull hull = made(prism_points(sides, radius, half));
        const auto n = static_cast<std::uint32_t>(sides);
        expect_counts(hull, 2 * n, 3 * n, n + 2);
        const double angle = 2 * 3.14159265358979323846 / sides;
        const double area = sides * radius * radius * std::sin(angle) / 2;
        EXPECT_NEAR(volume(hull), 2 * half * area, 1e-5);
        // Regular polygon about its axis: r^2 / 6 (2 + cos angle).
        const double along = radius * radius / 6 * (2 + std::cos(angle));
        expect_moments(
            hull, {along, along / 2 + half * half / 3, along / 2 + half * half / 3}, 1e-5);
    }
}

TEST(Hull, FindsThePrincipalAxesOfATurnedBoxAnywhere) {
    Random random(3);
    for (int round = 0; round < 200; ++round) {
        const double x = random.uniform(0.05, 0.4);
        const double y = random.uniform(0.5, 0.9);
        const double z = random.uniform(1, 2);
        const Vec place = random.direction() * random.uniform(0, 20);
        const Points points =
            turned_points(box_points(x, y, z), random.direction(), random.uniform(0, 3), place);
        const Hull hull = made(points);
        expect_counts(hull, 8, 12, 6);
        expect_sound(hull, points);
        EXPECT_NEAR(volume(hull), 8 * x * y * z, 1e-5 * x * y * z + 1e-5);
        expect_moments(hull, {(y * y + z * z) / 3, (z * z + x * x) / 3, (x * x + y * y) / 3}, 1e-5);
        EXPECT_LT(length(metres(hull.centre) - place), 1e-5);
        // In its own frame the box stands straight.
        double half[3] = {0, 0, 0};
        for (std::uint32_t vertex = 0; vertex < 8; ++vertex) {
            const Vec corner = metres(hull.vertices[vertex].place);
            for (int axis = 0; axis < 3; ++axis) {
                half[axis] = std::max(half[axis], std::abs(corner[axis]));
            }
        }
        std::sort(half, half + 3);
        EXPECT_NEAR(half[0], x, 2e-6);
        EXPECT_NEAR(half[1], y, 2e-6);
        EXPECT_NEAR(half[2], z, 2e-6);
    }
}

/// Volume, first and second moments of a tetrahedron by its corners, in double precision.
TEST(Hull, OfRandomTetrahedraFollowsTheClosedForm) {
    Random random(4);
    int measured = 0;
    for (int round = 0; round < 500; ++round) {
        const Points points = cloud_points(random, 4);
        const Result<Hull> result = make_hull(to_real(points));
        if (!result) {
            continue; // too thin
        }
        ++measured;
        const Hull& hull = result.value();
        const Vec centre = (points[0] + points[1] + points[2] + points[3]) * 0.25;
        EXPECT_LT(length(metres(hull.centre) - centre), 1e-6);
        const double expected = std::abs(dot(cross(points[1] - points[0], points[2] - points[0]),
                                             points[3] - points[0])) /
                                6;
        EXPECT_NEAR(volume(hull), expected, 3e-6 * expected + 1e-7);
        // Sum of squares about the centre is a quarter and a twentieth of the corners'.
        double trace = 0;
        for (const Vec& point : points) {
            trace += dot(point - centre, point - centre) / 20;
        }
        EXPECT_NEAR((moment(hull, 0) + moment(hull, 1) + moment(hull, 2)) / 2, trace, 1e-5 * trace);
        expect_sound(hull, points);
    }
    EXPECT_GT(measured, 250);
}

TEST(Hull, HoldsItsPointsAndIsConvexWhateverTheyAre) {
    Random random(5);
    int made_count = 0;
    int refused = 0;
    for (int round = 0; round < 600; ++round) {
        const int count = 4 + static_cast<int>(random.bits() % 60);
        const Points points = round % 2 == 0 ? cloud_points(random, count)
                                             : sphere_points(random, 4 + count / 3, 0.5);
        const Result<Hull> hull = make_hull(to_real(points));
        made_count += hull.ok() ? 1 : 0;
        if (hull.ok()) {
            expect_sound(hull.value(), points);
        } else {
            ++refused;
            EXPECT_NE(hull.error().message.find("thin"), std::string::npos) << hull.error().message;
        }
    }
    EXPECT_GT(made_count, 500);
    EXPECT_LT(refused, 100);
}

/// On the exact integers, before faces are united.
TEST(HullSurface, IsExactlyConvexAndHoldsAllPoints) {
    Random random(6);
    for (int round = 0; round < 200; ++round) {
        std::vector<HullPoint> points;
        // A coarse grid: most points are coplanar or collinear with others.
        const auto coordinate = [&] {
            return static_cast<std::int32_t>(random.bits() % 5) * (1 << 20);
        };
        for (int index = 0; index < 40; ++index) {
            points.push_back({coordinate(), coordinate(), coordinate()});
        }
        std::sort(points.begin(), points.end());
        points.erase(std::unique(points.begin(), points.end()), points.end());
        const Result<HullSurface> result = triangulated_hull(points);
        ASSERT_TRUE(result.ok()) << result.error().message;
        const HullSurface& surface = result.value();
        for (const auto& face : surface.faces) {
            const HullPoint& a = surface.vertices[face[0]];
            const auto normal =
                hull_normal(a, surface.vertices[face[1]], surface.vertices[face[2]]);
            for (const HullPoint& point : points) {
                EXPECT_FALSE(Int128(0) < hull_height(normal, a, point));
            }
        }
    }
}

Points shuffled(Points points, Random& random) {
    for (std::size_t index = points.size(); index > 1; --index) {
        std::swap(points[index - 1], points[static_cast<std::size_t>(random.bits() % index)]);
    }
    return points;
}

TEST(Hull, DoesNotDependOnTheOrderOfThePointsNorOnTwins) {
    Random random(7);
    for (int round = 0; round < 100; ++round) {
        Points points =
            round % 2 == 0
                ? cloud_points(random, 30)
                : turned_points(prism_points(8, 0.5, 0.5), random.direction(), 1, {0.1, 0.2, 0.3});
        const Hull first = made(points);
        points.push_back(points[3]);
        const Hull second = made(shuffled(points, random));
        ASSERT_TRUE(first == second) << round;
    }
}

TEST(Hull, LeavesOutWhatLiesInsideFacesAndEdges) {
    Random random(8);
    for (int round = 0; round < 100; ++round) {
        Points points;
        for (int x = -2; x <= 2; ++x) {
            for (int y = -2; y <= 2; ++y) {
                for (int z = -2; z <= 2; ++z) {
                    points.push_back({x * 0.25, y * 0.25, z * 0.25});
                }
            }
        }
        points = turned_points(points, random.direction(), random.uniform(0, 3), {0, 0, 0});
        const Hull hull = made(points);
        expect_counts(hull, 8, 12, 6);
        expect_sound(hull, points);
        EXPECT_NEAR(volume(hull), 1, 1e-4);
    }
}

TEST(Hull, OfNoisyPolygonsKeepsTheirFaces) {
    Random random(9);
    for (int round = 0; round < 100; ++round) {
        Points points = prism_points(5 + round % 20, 0.5, 0.3);
        for (Vec& point : points) {
            point = point + random.direction() * 1e-6;
        }
        const Hull hull = made(points);
        const auto sides = static_cast<std::uint32_t>(5 + round % 20);
        expect_counts(hull, 2 * sides, 3 * sides, sides + 2);
    }
}

TEST(HullErrors, SayWhatIsWrong) {
    EXPECT_EQ(error_of({}), "has 0 different points; give at least 4 that stand out of one plane");
    EXPECT_EQ(error_of({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}),
              "has 1 point; give at least 4 that stand out of one plane");
    EXPECT_EQ(error_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}),
              "has 3 different points; give at least 4 that stand out of one plane");
    EXPECT_EQ(error_of({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}}),
              "is a line: its points need to stand out of one plane");
    EXPECT_EQ(error_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}}),
              "is flat: its points need to stand out of one plane");
    EXPECT_EQ(error_of(box_points(1, 0.005, 1)),
              "is too thin: 0.010 m across a face; that must be at least 0.020 m");
    EXPECT_EQ(error_of(box_points(0.005, 0.005, 0.005)),
              "is too thin: 0.010 m across a face; that must be at least 0.020 m");
    EXPECT_EQ(error_of(box_points(1, 251, 1)), "has a coordinate beyond 250.000 m in point 0");
    EXPECT_EQ(
        error_of({{250, 250, 250}, {-250, -250, -250}, {-250, -250, -249}, {-249, -250, -250}}),
        "reaches 649.230 m from its centre of mass; that may be at most 434.000 m");
    Random random(10);
    EXPECT_EQ(error_of(sphere_points(random, 100, 1)), "has 100 vertices; it may have at most 64");
    EXPECT_EQ(error_of(sphere_points(random, 60, 1)), "has 116 faces; it may have at most 64");
    EXPECT_EQ(error_of(sphere_points(random, 900, 1)),
              "has more than 128 vertices; it may have at most 64");
    EXPECT_EQ(error_of(sphere_points(random, 1025, 1)), "has 1025 points; give at most 1024");
}

TEST(Hull, OfAlmostFlatPointsIsRefusedOrThin) {
    // Faces that lie within the tolerance of each other must not be united until none is left.
    Random random(61);
    int refused = 0;
    for (int round = 0; round < 20000; ++round) {
        const double thickness = std::pow(10, random.uniform(-4.5, -2));
        Points points;
        for (int index = 0; index < 4 + round % 8; ++index) {
            points.push_back({random.uniform(-0.3, 0.3),
                              random.uniform(-thickness, thickness),
                              random.uniform(-0.3, 0.3)});
        }
        refused += make_hull(to_real(points)).ok() ? 0 : 1;
    }
    EXPECT_GT(refused, 10000);
}

TEST(Hull, StandsAtItsLimitsOfSize) {
    for (const double size : {0.0101, 249.9}) {
        const Points points = box_points(size, size, size);
        const Hull hull = made(points);
        expect_counts(hull, 8, 12, 6);
        const double cube = 8 * size * size * size;
        EXPECT_NEAR(volume(hull), cube, 1e-4 * cube);
        expect_moments(hull, Vec{1, 1, 1} * (2 * size * size / 3), 1e-4);
    }
    // 34 vertices and 64 faces: as many triangles as there may be.
    Random random(11);
    const Hull hull = made(sphere_points(random, 34, 0.5));
    EXPECT_EQ(hull.vertex_count, 34U);
    EXPECT_EQ(hull.face_count, 64U);
}

} // namespace
} // namespace lockwind
