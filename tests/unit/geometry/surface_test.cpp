#include "geometry/bounds_probe.h"
#include "geometry/surface.h"
#include "surface_shapes.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

namespace lockwind {
namespace {

using namespace reference;

/// A tetrahedron seen from outside.
MeshDefinition tetrahedron() {
    return {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
            {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2}};
}

std::string refusal(const MeshDefinition& mesh) {
    const Result<Surface> surface = make_mesh(mesh);
    return surface.ok() ? "" : surface.error().message;
}

std::string refusal(const HeightFieldDefinition& field) {
    const Result<Surface> surface = make_height_field(field);
    return surface.ok() ? "" : surface.error().message;
}

TEST(Surface, LooksOutwardsAndKnowsItsNeighbours) {
    const Surface surface = made(make_mesh(tetrahedron()));
    ASSERT_EQ(surface.triangle_count(), 4U);
    for (std::uint32_t index = 0; index < 4; ++index) {
        const SurfaceTriangle& triangle = surface.triangle(index);
        const Vec middle = (corner_of(surface, index, 0) + corner_of(surface, index, 1) +
                            corner_of(surface, index, 2)) *
                           (1.0 / 3);
        EXPECT_NEAR(dot(unit(triangle.normal), middle) / length(middle), 1, 1e-8);
        for (std::uint32_t corner = 0; corner < 3; ++corner) {
            // Every other triangle of a tetrahedron is a neighbour, across the common edge.
            const SurfaceTriangle& other = surface.triangle(triangle.neighbours[corner]);
            const std::set<std::uint32_t> others(other.corners, other.corners + 3);
            EXPECT_EQ(others.count(triangle.corners[corner]), 1U);
            EXPECT_EQ(others.count(triangle.corners[(corner + 1) % 3]), 1U);
            EXPECT_EQ(others.count(triangle.corners[(corner + 2) % 3]), 0U);
        }
    }
    for (std::uint32_t vertex = 0; vertex < 4; ++vertex) {
        EXPECT_EQ(surface.ring(vertex).size(), 3U);
        const Vec place = metres(surface.place(vertex));
        EXPECT_NEAR(dot(unit(surface.outwards(vertex)), place) / length(place), 1, 1e-5);
    }
}

TEST(Surface, WeldsVerticesAtOnePlace) {
    const MeshDefinition whole = tetrahedron();
    MeshDefinition loose; // three vertices of its own for each triangle
    for (const std::uint32_t index : whole.indices) {
        loose.indices.push_back(static_cast<std::uint32_t>(loose.vertices.size()));
        loose.vertices.push_back(whole.vertices[index]);
    }
    const Surface a = made(make_mesh(whole));
    const Surface b = made(make_mesh(loose));
    for (std::uint32_t index = 0; index < 4; ++index) {
        for (std::uint32_t corner = 0; corner < 3; ++corner) {
            EXPECT_EQ(a.triangle(index).neighbours[corner], b.triangle(index).neighbours[corner]);
            EXPECT_NE(a.triangle(index).neighbours[corner], kNoIndex);
        }
    }
}

TEST(Surface, EndsWhereNotTwoTrianglesMeet) {
    // Two triangles with a common edge; a third on it, and one that goes along it the wrong way.
    MeshDefinition mesh{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}},
                        {0, 1, 2, 1, 0, 3}};
    Surface surface = made(make_mesh(mesh));
    EXPECT_EQ(surface.triangle(0).neighbours[0], 1U);
    EXPECT_EQ(surface.triangle(1).neighbours[0], 0U);
    EXPECT_EQ(surface.triangle(0).neighbours[1], kNoIndex);
    mesh.indices.insert(mesh.indices.end(), {0, 1, 4});
    surface = made(make_mesh(mesh));
    EXPECT_EQ(surface.triangle(0).neighbours[0], kNoIndex);
    mesh.indices = {0, 1, 2, 0, 1, 3};
    surface = made(make_mesh(mesh));
    EXPECT_EQ(surface.triangle(0).neighbours[0], kNoIndex);
}

TEST(Surface, RefusesWhatIsNoMesh) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 0, -1}, {2, 0, 0}};
    EXPECT_EQ(refusal(MeshDefinition{points, {}}),
              "has 0 indices; give three for each triangle, and at least one");
    EXPECT_EQ(refusal(MeshDefinition{points, {0, 1}}),
              "has 2 indices; give three for each triangle, and at least one");
    EXPECT_EQ(refusal(MeshDefinition{points, {0, 1, 2, 0, 4, 1}}),
              "has index 4 in triangle 1; there are 4 vertices");
    EXPECT_EQ(refusal(MeshDefinition{points, {0, 1, 2, 0, 1, 3}}), "triangle 1 has no area");
    EXPECT_EQ(refusal(MeshDefinition{points, {0, 0, 2}}), "triangle 0 has no area");
    EXPECT_EQ(refusal(MeshDefinition{{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0.0009}}, {0, 1, 2}}),
              "triangle 0 is less than 1 mm across");
    EXPECT_EQ(refusal(MeshDefinition{{{0, 0, 0}, {501, 0, 0}, {0, 0, 1}}, {0, 1, 2}}),
              "has a coordinate beyond 500 m in vertex 1");
    EXPECT_EQ(refusal(MeshDefinition{{{-300, 0, 0}, {300, 0, 0}, {0, 0, 1}}, {0, 1, 2}}),
              "triangle 0 has an edge of 600 m; it may be 500 m long");
    EXPECT_EQ(refusal(MeshDefinition{{{-400, 0, -400}, {-400, 0, 400}, {400, 0, 400}}, {0, 1, 2}}),
              "reaches 565 m from the middle of its bounds; that may be at most 434 m");
    EXPECT_EQ(refusal(MeshDefinition{std::vector<Vec3>(kSurfaceVerticesMax + 1), {0, 1, 2}}),
              "has 524289 vertices; it may have at most 524288");
    EXPECT_EQ(refusal(MeshDefinition{points, std::vector<std::uint32_t>(3 * 524289, 0)}),
              "has 524289 triangles; it may have at most 524288");
}

TEST(Surface, RefusesWhatIsNoHeightField) {
    HeightFieldDefinition field;
    field.columns = 1;
    EXPECT_EQ(refusal(field), "has 1 columns and 2 rows; it needs at least 2 of each");
    field.columns = 3;
    field.heights = {0, 0, 0, 0};
    EXPECT_EQ(refusal(field), "has 4 heights; its columns and rows are 6 samples");
    field.heights = {0, 0, 0, 0, 600, 0};
    EXPECT_EQ(refusal(field), "has a height beyond 500 m in sample 4");
    field.heights = {0, 0, 0, 0, 1, 0};
    field.holes = {2};
    EXPECT_EQ(refusal(field), "has a hole in cell 2; there are 2 cells");
    field.holes = {0, 1, 0};
    EXPECT_EQ(refusal(field), "is all holes");
    field.holes.clear();
    field.spacing_x = 0;
    EXPECT_EQ(refusal(field), "has a spacing out of range; give 0.01 .. 250 m");
    field.spacing_x = 250;
    field.columns = 4;
    field.heights.resize(8);
    EXPECT_EQ(refusal(field), "is longer than 500 m");
    field.columns = 4096;
    field.rows = 4096;
    EXPECT_EQ(refusal(field), "has 16777216 samples; it may have at most 524288");
}

TEST(Surface, LaysAHeightFieldOut) {
    HeightFieldDefinition field;
    field.columns = 4;
    field.rows = 3;
    field.spacing_x = 2;
    field.spacing_z = 0.5;
    for (int sample = 0; sample < 12; ++sample) {
        field.heights.push_back(Real::from_raw(std::int64_t{sample} << 30)); // quarters of a metre
    }
    field.holes = {4};
    const Surface surface = made(make_height_field(field));
    EXPECT_EQ(surface.triangle_count(), 10U);
    const Vec centre = metres(surface.centre());
    std::set<std::vector<double>> seen;
    for (std::uint32_t index = 0; index < 10; ++index) {
        EXPECT_GT(surface.triangle(index).normal[1], 0);
        for (std::uint32_t corner = 0; corner < 3; ++corner) {
            const Vec place = corner_of(surface, index, corner) + centre;
            seen.insert({place[0], place[1], place[2]});
        }
    }
    ASSERT_EQ(seen.size(), 12U);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            EXPECT_EQ(seen.count({(column - 1.5) * 2, 0.25 * (4 * row + column), (row - 1) * 0.5}),
                      1U);
        }
    }
    // The hole is the middle cell of the second row: no triangle has its middle there.
    for (std::uint32_t index = 0; index < 10; ++index) {
        const Vec middle = (corner_of(surface, index, 0) + corner_of(surface, index, 1) +
                            corner_of(surface, index, 2)) *
                               (1.0 / 3) +
                           centre;
        EXPECT_FALSE(std::abs(middle[0]) < 1 && middle[2] > 0);
    }
}

TEST(Surface, FindsTheTrianglesInABoxAsAllOfThemCompared) {
    Random random(7);
    const Surface surface = made(
        make_height_field(field_of(24, 10, [&](double, double) { return random.uniform(-1, 1); })));
    int found_in_all = 0;
    for (int round = 0; round < 300; ++round) {
        Bounds box{};
        for (int axis = 0; axis < 3; ++axis) {
            const double middle = random.uniform(-11, 11) * (axis == 1 ? 0.1 : 1);
            const double half = random.uniform(0, 2);
            box.low[axis] = static_cast<std::int32_t>((middle - half) * (1 << kBoundsFraction));
            box.high[axis] = static_cast<std::int32_t>((middle + half) * (1 << kBoundsFraction));
        }
        std::vector<std::uint32_t> found;
        surface.tree().visit(OverlapProbe(box),
                             [&](std::uint32_t index) { found.push_back(index); });
        std::sort(found.begin(), found.end());
        for (std::uint32_t index = 0; index < surface.triangle_count(); ++index) {
            double beyond = -1e9; // how far apart they are at least along an axis
            for (int axis = 0; axis < 3; ++axis) {
                double low = 1e9;
                double high = -1e9;
                for (std::uint32_t corner = 0; corner < 3; ++corner) {
                    low = std::min(low, corner_of(surface, index, corner)[axis]);
                    high = std::max(high, corner_of(surface, index, corner)[axis]);
                }
                beyond = std::max(
                    {beyond, low - box.high[axis] * 0x1p-16, box.low[axis] * 0x1p-16 - high});
            }
            const bool has = std::binary_search(found.begin(), found.end(), index);
            if (std::abs(beyond) > 4e-5) {
                EXPECT_EQ(has, beyond < 0);
            }
        }
        found_in_all += static_cast<int>(found.size());
    }
    EXPECT_GT(found_in_all, 1000);
}

} // namespace
} // namespace lockwind
