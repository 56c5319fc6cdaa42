#pragma once

#include "tests/support/code_scenes.h"

#include <cmath>
#include <cstdint>

// Bodies made of parts: compounds, height fields and meshes.
namespace lockwind::test {

inline Real metres(double value) {
    return Real::from_raw(std::llround(std::ldexp(value, 32)));
}

inline Vec3 metres_of(double x, double y, double z) {
    return {metres(x), metres(y), metres(z)};
}

/// Ground over [-half, half]^2 of cells x cells, y = height(x, z).
template <class Height>
HeightFieldDefinition field_over(std::uint32_t cells, double half, const Height& height) {
    HeightFieldDefinition field;
    field.columns = cells + 1;
    field.rows = cells + 1;
    field.spacing_x = metres(2 * half / cells);
    field.spacing_z = field.spacing_x;
    for (std::uint32_t row = 0; row <= cells; ++row) {
        for (std::uint32_t column = 0; column <= cells; ++column) {
            field.heights.push_back(
                metres(height((2.0 * column / cells - 1) * half, (2.0 * row / cells - 1) * half)));
        }
    }
    return field;
}

/// The same ground as a mesh, its diagonals the other way.
inline MeshDefinition mesh_of(const HeightFieldDefinition& field) {
    MeshDefinition mesh;
    for (std::uint32_t row = 0; row < field.rows; ++row) {
        for (std::uint32_t column = 0; column < field.columns; ++column) {
            const Real x = field.spacing_x * Real(column) -
                           field.spacing_x * Real(field.columns - 1) / Real(2);
            const Real z =
                field.spacing_z * Real(row) - field.spacing_z * Real(field.rows - 1) / Real(2);
            mesh.vertices.push_back({x, field.heights[row * field.columns + column], z});
        }
    }
    for (std::uint32_t row = 0; row + 1 < field.rows; ++row) {
        for (std::uint32_t column = 0; column + 1 < field.columns; ++column) {
            const std::uint32_t low = row * field.columns + column;
            const std::uint32_t high = low + field.columns;
            for (const std::uint32_t vertex : {low, high, low + 1, low + 1, high, high + 1}) {
                mesh.indices.push_back(vertex);
            }
        }
    }
    return mesh;
}

inline double hills(double x, double z) {
    return 0.5 * std::sin(0.9 * x) * std::cos(0.7 * z) + 0.1 * std::sin(3.1 * x + 2.3 * z);
}

inline BodyDefinition
body_of(BodyId id, ShapeType type, const Vec3& position, std::uint32_t index = 0) {
    BodyDefinition body;
    body.id = id;
    body.shape.type = type;
    body.shape.hull = index;
    body.shape.compound = index;
    body.shape.height_field = index;
    body.shape.mesh = index;
    body.position = position;
    return body;
}

inline BodyDefinition ground_of(BodyId id, ShapeType type, std::uint32_t index = 0) {
    BodyDefinition body = body_of(id, type, {}, index);
    body.mode = BodyMode::fixed;
    return body;
}

inline CompoundChild box_child(const Vec3& half_extents, const Vec3& position) {
    CompoundChild child;
    child.shape.type = ShapeType::box;
    child.shape.half_extents = half_extents;
    child.position = position;
    return child;
}

inline CompoundChild ball_child(Real radius, const Vec3& position) {
    CompoundChild child;
    child.shape.radius = radius;
    child.position = position;
    return child;
}

/// Of two boxes; its corner is at the origin.
inline CompoundDefinition angle_piece() {
    return {
        {box_child({0.6, 0.15, 0.15}, {0.45, 0, 0}), box_child({0.15, 0.45, 0.15}, {0, 0.6, 0})}};
}

/// A top of 2 x 1.4 m at 1 m on four legs.
inline CompoundDefinition table_piece() {
    CompoundDefinition table{{box_child({1, 0.05, 0.7}, {0, 1, 0})}};
    for (const int x : {-1, 1}) {
        for (const int z : {-1, 1}) {
            table.children.push_back(
                box_child({0.06, 0.475, 0.06}, {Real(0.9) * Real(x), 0.475, Real(0.6) * Real(z)}));
        }
    }
    return table;
}

inline CompoundDefinition dumbbell_piece() {
    return {{ball_child(0.25, {0.5, 0, 0}), ball_child(0.25, {-0.5, 0, 0})}};
}

} // namespace lockwind::test
