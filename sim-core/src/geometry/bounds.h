#pragma once

#include "geometry/shape_instance.h"

#include <cstdint>

namespace lockwind {

/// A plane has no bounds: it meets everything.
constexpr bool is_bounded(ShapeType type) {
    return type != ShapeType::plane;
}

/// Half extents of the tight axis-aligned box about a bounded shape, Q9.22 m, rounded up; of hulls
/// and compounds, the tightest box that has the shape's centre for its own; of surfaces, about the
/// turned box around all triangles.
void bounds_half_extents(const ShapeInstance& shape, std::int32_t half_extents[3]);

/// Distance of the farthest surface point from the centre, Q9.22 m, rounded up; 0 for a plane.
/// Hulls, compounds and surfaces hold their own.
std::int32_t bounding_radius(ShapeType type, const std::int32_t size[3]);

} // namespace lockwind
