#pragma once

#include "geometry/convex_core.h"

#include <cstdint>

namespace lockwind {

/// 15.3 um, Q31.32: a shape that is cast stops this far from what it meets, so that one that is
/// moved there does not overlap it.
inline constexpr std::int64_t kCastGap = std::int64_t{1} << 16;
/// It is taken to be there when it is this near (19.1 um): at fractions, speeds and angles where
/// rounding hides the rest.
inline constexpr std::int64_t kCastGapMost = kCastGap + kCastGap / 4;

/// Where a moving shape meets another.
struct ConvexCastHit {
    bool overlapping;       // at the start: `point` is the shape's centre, the normal 0
    std::int64_t fraction;  // Q31.32 of the way, 0 .. 1, rounded down
    std::int64_t point[3];  // Q31.32 m, world, on the other's surface
    std::int32_t normal[3]; // Q2.30, world, out of the other
};

/// First fraction at which `shape`, without turning, is within kCastGap of `body` while nearing it,
/// or 0 where they overlap at the start. `start` and `way` (Q31.32 m; start and end within
/// kRayCoordinateMax) are of the shape's centre, `centre` of the body's.
///
/// Conservative advancement (Mirtich 1996; van den Bergen 2004): the distance of two convex shapes
/// that move straight is convex over time, so each step, by the separation over the speed along the
/// normal, is Newton's from the safe side, and never passes the first touch however thin the body.
/// A way that is nearest at more than kCastGapMost (plus shape_distance's error) does not hit; one
/// that comes within kCastGap does.
bool shape_cast(const ConvexCore& shape,
                const std::int64_t start[3],
                const std::int64_t way[3],
                const ConvexCore& body,
                const std::int64_t centre[3],
                ConvexCastHit& hit);

} // namespace lockwind
