#include "geometry/surface.h"

#include "geometry/fixed_geometry.h"
#include "geometry/surface_maker.h"

#include "lockwind/wide.h"

#include <algorithm>
#include <string>

namespace lockwind {

namespace {

std::string too_many(std::uint64_t count, const char* what, std::uint32_t limit) {
    return "has " + std::to_string(count) + " " + what + "; it may have at most " +
           std::to_string(limit);
}

bool is_near(Real coordinate) {
    return coordinate >= -kSurfaceCoordinateMax && coordinate <= kSurfaceCoordinateMax;
}

std::int32_t stored(Real coordinate) {
    return convert<Length>(coordinate).raw();
}

} // namespace

Bounds Surface::triangle_bounds(std::uint32_t index) const {
    constexpr int kCoarser = kLengthFraction - kBoundsFraction;
    Bounds bounds{};
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t places[3] = {
            corner(index, 0)[axis], corner(index, 1)[axis], corner(index, 2)[axis]};
        const auto [low, high] = std::minmax({places[0], places[1], places[2]});
        bounds.low[axis] = (low >> kCoarser) - 1;
        bounds.high[axis] = (high >> kCoarser) + 1;
    }
    return bounds;
}

Result<Surface> make_mesh(const MeshDefinition& definition) {
    const std::size_t vertex_count = definition.vertices.size();
    const std::size_t index_count = definition.indices.size();
    if (vertex_count > kSurfaceVerticesMax) {
        return Error{too_many(vertex_count, "vertices", kSurfaceVerticesMax)};
    }
    if (index_count == 0 || index_count % 3 != 0) {
        return Error{"has " + std::to_string(index_count) +
                     " indices; give three for each triangle, and at least one"};
    }
    if (index_count / 3 > kSurfaceTrianglesMax) {
        return Error{too_many(index_count / 3, "triangles", kSurfaceTrianglesMax)};
    }
    for (std::size_t index = 0; index < index_count; ++index) {
        if (definition.indices[index] >= vertex_count) {
            return Error{"has index " + std::to_string(definition.indices[index]) +
                         " in triangle " + std::to_string(index / 3) + "; there are " +
                         std::to_string(vertex_count) + " vertices"};
        }
    }
    std::vector<Surface::Point> points;
    points.reserve(vertex_count);
    for (std::size_t index = 0; index < vertex_count; ++index) {
        const auto& [x, y, z] = definition.vertices[index];
        if (!is_near(x) || !is_near(y) || !is_near(z)) {
            return Error{"has a coordinate beyond 500 m in vertex " + std::to_string(index)};
        }
        points.push_back({stored(x), stored(y), stored(z)});
    }
    return SurfaceMaker(std::move(points), definition.indices).run();
}

namespace {

/// (index - (count - 1) / 2) spacing, Q9.22, to the nearest.
std::int32_t grid_place(std::uint32_t index, std::uint32_t count, Real spacing) {
    const std::int64_t halves = 2 * std::int64_t{index} - (std::int64_t{count} - 1);
    return static_cast<std::int32_t>(
        round_shift(halves * spacing.raw(), Real::kFraction - kLengthFraction + 1));
}

std::string wrong_grid(const HeightFieldDefinition& field) {
    const std::uint64_t samples = std::uint64_t{field.columns} * field.rows;
    if (field.columns < 2 || field.rows < 2) {
        return "has " + std::to_string(field.columns) + " columns and " +
               std::to_string(field.rows) + " rows; it needs at least 2 of each";
    }
    if (samples > kSurfaceVerticesMax) {
        return too_many(samples, "samples", kSurfaceVerticesMax);
    }
    const std::uint64_t cells = std::uint64_t{field.columns - 1} * (field.rows - 1);
    if (2 * cells > kSurfaceTrianglesMax) {
        return too_many(2 * cells, "triangles", kSurfaceTrianglesMax);
    }
    if (field.heights.size() != samples) {
        return "has " + std::to_string(field.heights.size()) +
               " heights; its columns and rows are " + std::to_string(samples) + " samples";
    }
    for (const Real spacing : {field.spacing_x, field.spacing_z}) {
        if (spacing < kShapeSizeMin || spacing > kShapeSizeMax) {
            return "has a spacing out of range; give 0.01 .. 250 m";
        }
    }
    if (!is_near(field.spacing_x * Real(field.columns - 1)) ||
        !is_near(field.spacing_z * Real(field.rows - 1))) {
        return "is longer than 500 m";
    }
    for (std::size_t index = 0; index < samples; ++index) {
        if (!is_near(field.heights[index])) {
            return "has a height beyond 500 m in sample " + std::to_string(index);
        }
    }
    for (const std::uint32_t hole : field.holes) {
        if (hole >= cells) {
            return "has a hole in cell " + std::to_string(hole) + "; there are " +
                   std::to_string(cells) + " cells";
        }
    }
    return "";
}

} // namespace

Result<Surface> make_height_field(const HeightFieldDefinition& definition) {
    if (std::string wrong = wrong_grid(definition); !wrong.empty()) {
        return Error{wrong};
    }
    const std::uint32_t columns = definition.columns;
    const std::uint32_t rows = definition.rows;
    std::vector<Surface::Point> points;
    points.reserve(std::size_t{columns} * rows);
    for (std::uint32_t row = 0; row < rows; ++row) {
        for (std::uint32_t column = 0; column < columns; ++column) {
            points.push_back({grid_place(column, columns, definition.spacing_x),
                              stored(definition.heights[points.size()]),
                              grid_place(row, rows, definition.spacing_z)});
        }
    }
    std::vector<bool> is_hole(std::size_t{columns - 1} * (rows - 1));
    for (const std::uint32_t hole : definition.holes) {
        is_hole[hole] = true;
    }
    std::vector<std::uint32_t> indices;
    indices.reserve(6 * is_hole.size());
    for (std::uint32_t row = 0; row + 1 < rows; ++row) {
        for (std::uint32_t column = 0; column + 1 < columns; ++column) {
            if (is_hole[std::size_t{row} * (columns - 1) + column]) {
                continue;
            }
            const std::uint32_t low = row * columns + column;
            const std::uint32_t high = low + columns + 1;
            for (const std::uint32_t vertex : {low, high - 1, high, low, high, low + 1}) {
                indices.push_back(vertex);
            }
        }
    }
    if (indices.empty()) {
        return Error{"is all holes"};
    }
    return SurfaceMaker(std::move(points), std::move(indices)).run();
}

} // namespace lockwind
