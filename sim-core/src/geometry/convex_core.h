#pragma once

#include "geometry/shape_instance.h"

#include <cstdint>

namespace lockwind {

/// A convex shape as queries see it: the hull of some points (its core), rounded by a radius. A
/// sphere is one point, a capsule two, boxes and hulls their vertices with radius 0. A plane has no
/// points, only its normal.
struct ConvexCore {
    std::int32_t points[kHullVerticesMax][3]; // Q9.22 m, world axes, from the shape's centre
    std::uint32_t count;                      // 0: a half space
    std::int32_t radius;                      // Q9.22 m
    std::int32_t reach;                       // Q9.22 m: no point lies farther from the centre
    std::int32_t half_extents[3];             // Q9.22 m, of the rounded shape, about its centre
    std::int32_t normal[3];                   // Q2.30, of a half space
};

/// Each point is rounded once to Q9.22; the rotation's own error moves it by 2 ulp at most. Not for
/// compounds and surfaces, which have a core for each part.
void make_core(const ShapeInstance& shape, ConvexCore& core);

/// The core of a surface's triangle, from the surface's centre: both its sides.
void make_triangle_core(const ShapeInstance& surface, std::uint32_t index, ConvexCore& core);

/// The core of a point: radius 0.
void make_point_core(ConvexCore& core);

} // namespace lockwind
