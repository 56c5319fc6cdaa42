#pragma once

#include "geometry/fixed_geometry.h"
#include "geometry/surface.h"

#include <cstdint>

namespace lockwind {

/// Sine (Q2.30) of the angle between two triangles below which their common edge counts as flat:
/// 2^-10, 0.06 degrees.
inline constexpr std::int32_t kFlatSine = 1 << (kUnitFraction - 10);
/// cos 2^-9 (0.11 degrees), Q2.30: a contact normal this close to a triangle's gives way to it.
/// Twice the flat angle, so that no gap is left between flat neighbours.
inline constexpr std::int32_t kAlongFaceCosine = kUnitOne - (1 << (kUnitFraction - 19));

/// From a corner of a triangle to the next.
struct TriangleEdge {
    std::int32_t direction[3]; // Q2.30
    std::int32_t outwards[3];  // Q2.30, in the triangle's plane
    std::int32_t limit[3];     // Q2.30; set where it is open
    std::int32_t length;       // Q9.22 m
    bool is_open; // contact normals over it lie between the triangle's own and `limit`; else there
                  // are none
};

/// A triangle of a surface as the kernels see it, in the surface's frame.
///
/// **Ghost collisions.** What slides over a surface must not be stopped by the edges within it. So
/// a contact normal counts only if it is one of the whole surface's at the place that is touched
/// (G. van den Bergen, *Collision Detection in Interactive 3D Environments*; E. Catto's one-sided
/// chains): over the inside the triangle's own; over an edge those between the two triangles'
/// normals where it is convex, none where it is flat or concave; over a corner those that no edge
/// from it rises above. Past the end of a surface they go on to the direction out of it.
struct Triangle {
    std::int32_t corners[3][3]; // Q9.22 m
    std::int32_t normal[3];     // Q2.30
    TriangleEdge edges[3];
    const Surface* surface;
    std::uint32_t index;

    /// Q9.22 m; |point| < 512 m.
    std::int64_t height(const std::int32_t point[3]) const {
        return height_above(*surface, index, point);
    }
    /// How far a point lies beyond an edge, along the triangle's plane; Q9.22 m.
    std::int64_t beyond(int edge, const std::int32_t point[3]) const;

    static std::int64_t
    height_above(const Surface& surface, std::uint32_t index, const std::int32_t point[3]);
};

Triangle triangle_of(const Surface& surface, std::uint32_t index);

/// Where a direction may be a contact normal: unit, Q2.30, out of the surface.
bool is_along_face(const Triangle& triangle, const std::int32_t direction[3]);
bool is_over_edge(const Triangle& triangle, int edge, const std::int32_t direction[3]);
bool is_over_corner(const Triangle& triangle, int corner, const std::int32_t direction[3]);

/// A place on a triangle, and what of it that lies in.
struct TrianglePlace {
    enum class Feature : std::uint8_t { face, edge, corner };

    std::int32_t place[3]; // Q9.22 m
    Feature feature;
    int index; // of the edge or corner
};

/// The place nearest to a point within 512 m.
TrianglePlace nearest_place(const Triangle& triangle, const std::int32_t point[3]);

/// Whether a normal may be one where the place lies.
bool is_normal_at(const Triangle& triangle,
                  const TrianglePlace& place,
                  const std::int32_t direction[3]);

} // namespace lockwind
