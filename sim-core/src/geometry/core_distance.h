#pragma once

#include "geometry/convex_core.h"

#include <cstdint>

namespace lockwind {

/// How far apart two cores are; of their points, without their radii.
struct CoreDistance {
    bool overlapping;        // then nothing else is set
    std::int32_t normal[3];  // Q2.30, world, from B to A
    std::int64_t distance;   // Q31.32 m, of the nearest points
    std::int64_t separation; // Q31.32 m, along the normal: what keeps them apart for certain
    std::int64_t point_b[3]; // Q31.32 m: B's nearest point (one of them), from B's centre
};

/// Distance of two cores that have points; `delta` (Q31.32 m, within 2^18 m) goes from B's centre
/// to A's.
///
/// GJK (Gilbert, Johnson, Keerthi 1988) on integers. The vertices of A - B are rounded to a grid of
/// 2^-22 m (0.24 um), or 2^-29 of |delta| + reach where that is coarser; on the grid all that
/// decides which feature is nearest is exact (Ericson, Real-Time Collision Detection, 5.1.5, in 128
/// bits), so that flat, long and touching simplices need no tolerances. Only the direction is
/// rounded, to Q2.30: `distance` and `separation` are within 2 grid units (plus make_core's
/// rounding) of the truth and of each other. Ends because each round brings a new vertex and a
/// smaller distance, and after 128 rounds in any case; `separation` holds wherever it ends.
void core_distance(const ConvexCore& a,
                   const ConvexCore& b,
                   const std::int64_t delta[3],
                   CoreDistance& out);

} // namespace lockwind
