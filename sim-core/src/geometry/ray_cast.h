#pragma once

#include "geometry/shape_instance.h"

#include <cstdint>

namespace lockwind {

/// Where a segment enters a shape.
struct ShapeRayHit {
    std::int64_t fraction;  // Q31.32 of the segment, 0 .. 1
    std::int64_t point[3];  // Q31.32 m, world
    std::int32_t normal[3]; // Q2.30, world, out of the shape
    std::uint32_t part;     // triangle of a surface, child of a compound; else 0
};

/// Coordinates of a ray's ends and of the shape may be this large, m; beyond, a ray hits nothing.
inline constexpr std::int64_t kRayCoordinateMax = 65536;

/// First point of the segment from -> to (Q31.32 m, world) on the surface of `shape` at `centre`. A
/// segment that starts inside does not hit; nor does one without length. A compound is hit where
/// the first of its children is, also by a ray that starts within another; a surface from its front
/// alone.
bool ray_cast(const ShapeInstance& shape,
              const std::int64_t centre[3],
              const std::int64_t from[3],
              const std::int64_t to[3],
              ShapeRayHit& hit);

} // namespace lockwind
