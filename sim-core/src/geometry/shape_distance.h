#pragma once

#include "geometry/convex_core.h"

#include <cstdint>

namespace lockwind {

/// How far a shape A is from a shape or half space B.
struct ShapeDistance {
    bool overlapping;        // the surfaces touch or overlap; then nothing else is set
    std::int32_t normal[3];  // Q2.30, world, from B to A
    std::int64_t distance;   // Q31.32 m, > 0, between the surfaces
    std::int64_t separation; // Q31.32 m, along the normal; see CoreDistance
    std::int64_t point[3];   // Q31.32 m: B's nearest surface point (one of them), from B's centre
};

/// `delta` (Q31.32 m, within 2^18 m) goes from B's centre to A's; A is no half space. Errors are
/// CoreDistance's: below 2 um where the shapes and the way between them span less than 128 m, and
/// 2^-26 of that span beyond. The distance to a half space is exact for its rounded normal, but for
/// A's points.
void shape_distance(const ConvexCore& a,
                    const ConvexCore& b,
                    const std::int64_t delta[3],
                    ShapeDistance& out);

} // namespace lockwind
