#pragma once

#include "geometry/pair_kernels.h"

#include <cstdint>

namespace lockwind {

// What the kernels of spheres and capsules with flat shapes share.

/// cos 3.6 degrees, Q2.30: a normal this close to a face's gives way to it, so that a lying capsule
/// keeps two points of one face.
inline constexpr std::int32_t kFaceCosine = 1071594000;

/// One point where a sphere or capsule touches a polytope or a triangle.
struct RoundTouch {
    std::int32_t surface[3]; // of the other shape, in its frame
    std::int32_t normal[3];
    std::int32_t separation;
    std::uint32_t feature;
};

/// Adds a point; the first one's normal is the manifold's.
inline void emit_touch(const ShapeInstance& flat,
                       const ShapeInstance& round,
                       const std::int32_t delta[3],
                       const RoundTouch& touch,
                       ManifoldGeometry& out) {
    if (out.point_count == 0) {
        rotate(flat.rotation, touch.normal, out.normal);
    }
    ManifoldPoint& point = out.points[out.point_count];
    const std::int32_t lift = midway(flat, round).from_first(touch.separation);
    for (int axis = 0; axis < 3; ++axis) {
        point.local_a[axis] = touch.surface[axis] + scale(lift, touch.normal[axis]);
    }
    std::int32_t from_round[3];
    rotate(flat.rotation, point.local_a, from_round);
    for (int axis = 0; axis < 3; ++axis) {
        from_round[axis] = raw_saturate<std::int32_t>(std::int64_t{from_round[axis]} - delta[axis]);
    }
    to_local(round, from_round, point.local_b);
    point.separation = touch.separation;
    point.feature = touch.feature;
    ++out.point_count;
}

/// A range of a segment; empty where low > high.
struct Span {
    std::int64_t low;
    std::int64_t high;
};

/// Narrows the range to where a height that runs from `at_low` to `at_high` is at most 0.
inline void keep_below(std::int64_t at_low, std::int64_t at_high, Span& span) {
    if (at_low <= 0 && at_high <= 0) {
        return;
    }
    if (at_low > 0 && at_high > 0) {
        span = {1, 0};
        return;
    }
    // Where it is 0, by heights: at_low and at_high differ in sign, their difference fits 33 bits.
    const std::int64_t fraction = at_low * kUnitOne / (at_low - at_high);
    const std::int64_t crossing = span.low + round_unit_wide((span.high - span.low) * fraction);
    (at_low > 0 ? span.low : span.high) = crossing;
}

} // namespace lockwind
