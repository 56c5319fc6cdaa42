#pragma once

#include "geometry/shape_cast.h"
#include "geometry/shape_distance.h"
#include "geometry/shape_instance.h"

#include <cstdint>

namespace lockwind {

// Distances and casts of a convex core and any shape: of compounds and surfaces, the least over
// their parts. A surface has no inside and no thickness; a shape cast meets it from its front
// alone, as contacts do, distances and overlaps look at both sides.

/// As of shape_distance, with B a shape of any type: its nearest child or triangle, the lowest of
/// several at one distance. False where nothing is within `limit` (Q31.32 m).
bool distance_to_shape(const ConvexCore& a,
                       const std::int64_t delta[3],
                       const ShapeInstance& b,
                       std::int64_t limit,
                       ShapeDistance& out);

/// As of shape_cast, with a body of any type.
bool cast_at_shape(const ConvexCore& shape,
                   const std::int64_t start[3],
                   const std::int64_t way[3],
                   const ShapeInstance& body,
                   const std::int64_t centre[3],
                   ConvexCastHit& hit);

} // namespace lockwind
