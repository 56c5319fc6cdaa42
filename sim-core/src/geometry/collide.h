#pragma once

#include "geometry/fixed_geometry.h"
#include "geometry/manifold.h"
#include "geometry/shape_instance.h"

#include "lockwind/overflow.h"

#include <cstdint>

namespace lockwind {

/// Vector from centre A to centre B (Q9.22) of a pair without a plane. Their fat bounds must
/// overlap and at most one may exceed kMovingRadiusMax, so that it fits.
inline void centre_delta(const std::int64_t position_a[3],
                         const std::int64_t position_b[3],
                         std::int32_t delta[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        delta[axis] =
            static_cast<std::int32_t>(raw_subtract(position_b[axis], position_a[axis]) >> 10);
    }
}

/// The same for a pair of which one is a plane, whose origin may be 60 km away: a plane looks the
/// same from all its points, so its centre is taken to be the foot of the other's centre on it. The
/// vector is then +-height x normal, and stays so while the other slides along. Heights are clamped
/// to +-400 m.
void centre_delta_plane(const ShapeInstance& a,
                        const std::int64_t position_a[3],
                        const ShapeInstance& b,
                        const std::int64_t position_b[3],
                        std::int32_t delta[3]);

/// Contact of A and B; A is the one with the lower id, the normal points from A to B. `delta` as
/// the functions above give it. Nothing (point_count 0) where the surfaces are more than
/// kSpeculativeMargin apart. A plane's points are relative to the centre that `delta` assumes.
/// Of a surface, the contact of its triangle `part`. Not for two planes or surfaces, nor for a
/// compound, whose children collide one by one.
void collide(const ShapeInstance& a,
             const ShapeInstance& b,
             const std::int32_t delta[3],
             const ManifoldCache& cache,
             ManifoldGeometry& out);

} // namespace lockwind
