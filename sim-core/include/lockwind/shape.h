#pragma once

#include "lockwind/vector.h"

#include <cstdint>

namespace lockwind {

enum class ShapeType : std::uint8_t { sphere = 0, capsule = 1, box = 2, plane = 3 };

/// A convex shape about its body's origin, m.
///   sphere: radius. capsule: radius and half_height of the segment along local y.
///   box: half_extents. plane: the half space y <= 0 of the body's frame (static bodies only).
struct ShapeDefinition {
    ShapeType type = ShapeType::sphere;
    Real radius = 0.5;
    Real half_height = 0.5;
    Vec3 half_extents{0.5, 0.5, 0.5};
};

/// Range of radius, half_height and half_extents, m: sizes outside are refused.
inline constexpr Real kShapeSizeMin = 0.01;
inline constexpr Real kShapeSizeMax = 250.0;

/// Largest distance of a kinematic or dynamic body's surface from its origin, m. Together with the
/// largest fixed box (half diagonal 433.02 m) it keeps every vector between the centres of a pair
/// within Q9.22's +-512 m.
inline constexpr Real kMovingRadiusMax = 75.0;

} // namespace lockwind
