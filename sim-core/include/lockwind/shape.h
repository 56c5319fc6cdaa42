#pragma once

#include "lockwind/vector.h"

#include <cstdint>
#include <vector>

namespace lockwind {

enum class ShapeType : std::uint8_t {
    sphere = 0,
    capsule = 1,
    box = 2,
    plane = 3,
    hull = 4,
    compound = 5,
    height_field = 6,
    mesh = 7,
};

/// A shape in its body's frame, m.
///   sphere: radius. capsule: radius and half_height of the segment along local y.
///   box: half_extents. plane: the half space y <= 0 of the body's frame (static bodies only).
///   hull, compound, height_field, mesh: index into the WorldDefinition's vector of that name.
///   height_field and mesh: static bodies only.
/// All but the last four stand about the body's origin; the origin of those is that of their
/// points, wherever their centre of mass lies.
struct ShapeDefinition {
    ShapeType type = ShapeType::sphere;
    Real radius = 0.5;
    Real half_height = 0.5;
    Vec3 half_extents{0.5, 0.5, 0.5};
    std::uint32_t hull = 0;
    std::uint32_t compound = 0;
    std::uint32_t height_field = 0;
    std::uint32_t mesh = 0;
};

/// The convex hull of some points, m, in any order; any number of bodies may have it for a shape.
struct HullDefinition {
    std::vector<Vec3> points;
};

/// A convex part of a compound: sphere, capsule, box or hull.
struct CompoundChild {
    ShapeDefinition shape;
    Vec3 position;        // m, in the compound's frame
    RealQuat orientation; // normalised; must not be 0
    Real density = 1.0;   // as a multiple of the body's
};

/// Several convex shapes that move as one. Where children overlap, what they share weighs twice.
struct CompoundDefinition {
    std::vector<CompoundChild> children; // 1 .. kCompoundChildrenMax
};

/// Ground over a grid: sample (column, row) lies at x = (column - (columns - 1) / 2) spacing_x,
/// z = (row - (rows - 1) / 2) spacing_z, y = heights[row * columns + column]. Each cell is two
/// triangles that meet along the diagonal from its lower corner (column, row) to the upper one
/// (column + 1, row + 1); they are seen, and touched, from above only. Triangles 2 i and 2 i + 1
/// are those of the i-th cell that is no hole: the one on the side of its greatest z, then of its
/// greatest x.
struct HeightFieldDefinition {
    std::uint32_t columns = 2; // along x
    std::uint32_t rows = 2;    // along z
    Real spacing_x = 1.0;      // m
    Real spacing_z = 1.0;
    std::vector<Real> heights;        // m
    std::vector<std::uint32_t> holes; // cells without ground: row * (columns - 1) + column
};

/// Triangles, each of three vertices that go counter-clockwise seen from its front, where alone it
/// is touched. Triangle i has indices[3 i] and the next two. Vertices at the same place are one.
/// Triangles are neighbours where they share an edge and go along it in opposite directions; at an
/// edge of only one triangle, or of three and more, a surface ends.
struct MeshDefinition {
    std::vector<Vec3> vertices;         // m
    std::vector<std::uint32_t> indices; // three a triangle
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

/// Limits of a compound. Its children lie within kShapeSizeMax of its origin on each axis.
inline constexpr std::uint32_t kCompoundChildrenMax = 32;
inline constexpr Real kCompoundDensityMin = 0.001;
inline constexpr Real kCompoundDensityMax = 1000.0;
inline constexpr std::uint32_t kCompoundsMax = 4096; // of a world

/// Limits of height fields and meshes. No coordinate, and no edge, is longer than
/// kSurfaceCoordinateMax; no triangle is thinner than kSurfaceThicknessMin; no vertex lies farther
/// than kFixedRadiusMax from the middle of all.
inline constexpr Real kSurfaceCoordinateMax = 500.0;
inline constexpr Real kSurfaceThicknessMin = 0.001;
inline constexpr std::uint32_t kSurfaceVerticesMax = 1U << 19U;
inline constexpr std::uint32_t kSurfaceTrianglesMax = 1U << 19U;
inline constexpr std::uint32_t kSurfacesMax = 1024; // height fields of a world, and meshes

} // namespace lockwind
