#pragma once

#include "lockwind/vector.h"

#include <cstdint>
#include <vector>

namespace lockwind {

enum class ShapeType : std::uint8_t { sphere = 0, capsule = 1, box = 2, plane = 3, hull = 4 };

/// A convex shape in its body's frame, m.
///   sphere: radius. capsule: radius and half_height of the segment along local y.
///   box: half_extents. plane: the half space y <= 0 of the body's frame (static bodies only).
///   hull: index into WorldDefinition::hulls.
/// All but a hull stand about the body's origin; a hull's origin is that of its points, wherever
/// its centre of mass lies.
struct ShapeDefinition {
    ShapeType type = ShapeType::sphere;
    Real radius = 0.5;
    Real half_height = 0.5;
    Vec3 half_extents{0.5, 0.5, 0.5};
    std::uint32_t hull = 0;
};

/// The convex hull of some points, m, in any order; any number of bodies may have it for a shape.
struct HullDefinition {
    std::vector<Vec3> points;
};

/// Range of radius, half_height and half_extents, m: sizes outside are refused.
inline constexpr Real kShapeSizeMin = 0.01;
inline constexpr Real kShapeSizeMax = 250.0;

/// Largest distance of a kinematic or dynamic body's surface from its origin, m. Together with the
/// largest fixed box (half diagonal 433.02 m) it keeps every vector between the centres of a pair
/// within Q9.22's +-512 m.
inline constexpr Real kMovingRadiusMax = 75.0;
/// The same of a fixed body and its centre.
inline constexpr Real kFixedRadiusMax = 434.0;

/// Limits of a hull: points given, and what is left of them. A coordinate is at most
/// kShapeSizeMax; across, along the normal of each of its faces, a hull measures at least twice
/// kShapeSizeMin.
inline constexpr std::uint32_t kHullPointsMax = 1024;
inline constexpr std::uint32_t kHullVerticesMax = 64;
inline constexpr std::uint32_t kHullFacesMax = 64;
inline constexpr std::uint32_t kHullsMax = 4096; // of a world

} // namespace lockwind
