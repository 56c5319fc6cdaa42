#pragma once

#include "lockwind/int128.h"
#include "lockwind/result.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// A point as it was given, Q9.22 m, |.| <= 250 m: cross products of differences fit int64.
using HullPoint = std::array<std::int32_t, 3>;

/// A closed convex surface. A face lists its vertices counter-clockwise, seen from outside.
struct HullSurface {
    std::vector<HullPoint> vertices;
    std::vector<std::vector<std::uint32_t>> faces;
};

/// (b - a) x (c - a), exact.
std::array<std::int64_t, 3> hull_normal(const HullPoint& a, const HullPoint& b, const HullPoint& c);

/// normal . (point - origin), exact.
Int128 hull_height(const std::array<std::int64_t, 3>& normal,
                   const HullPoint& origin,
                   const HullPoint& point);

/// Triangles of the convex hull of `points`, which are sorted and different: quickhull (Barber,
/// Dobkin, Huhdanpaa 1996) with exact predicates, farthest point first. Points within
/// kHullTolerance of the hull of the others are left out. Every vertex is one of `points`, in
/// their order.
Result<HullSurface> triangulated_hull(std::span<const HullPoint> points);

/// Unites faces whose vertices lie within kHullTolerance of one plane, flattest first, and drops
/// the vertices that are then inside a face or an edge. Faces begin with their lowest vertex and
/// are sorted.
void merge_flat_faces(HullSurface& surface);

/// Unit vector (Q2.30, to the nearest) along a vector that is not 0. Odd: mirror images are exact.
void unit_of(const std::array<Int128, 3>& vector, std::int32_t unit[3]);

/// Sum of the cross products around a face: twice its area, along its normal. Exact.
std::array<Int128, 3> face_area(const HullSurface& surface, std::span<const std::uint32_t> face);

} // namespace lockwind
