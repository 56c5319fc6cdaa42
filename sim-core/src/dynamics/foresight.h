#pragma once

#include "dynamics/body.h"
#include "dynamics/bounds_grid.h"
#include "dynamics/dynamics.h"
#include "geometry/manifold.h"
#include "geometry/shape_instance.h"

#include <cstdint>

namespace lockwind {

/// How far bodies of CollisionMode::speculative look ahead.
class Foresight {
public:
    explicit Foresight(const DynamicsSettings& settings);

    /// Q9.22 m: the body's way in a tick at its velocity. 0 where it does not look ahead: it has
    /// another mode, or is not at full detail, or so slow that the usual margin does, or so fast or
    /// large that the formats do not hold its way; then it is swept.
    std::int32_t reach(const DynamicsTables& tables, BodyRow row) const;
    /// Bounds that hold a body now and at the end of the way that reach() told of.
    Bounds extended(const Bounds& tight, const BodyMotion& motion) const;
    /// Q9.22 m that A and B near each other along a normal from A to B in a tick.
    std::int64_t
    closing(const BodyMotion& a, const BodyMotion& b, const std::int32_t normal[3]) const;
    /// No pair looks further ahead, Q9.22 m.
    std::int32_t reach_max() const { return reach_max_; }

private:
    std::int64_t tick_rate_;
    std::int32_t reach_max_;
};

/// The contact of two shapes that are apart: what collide() finds once B is moved to A by the
/// shortest way. `delta` (Q9.22 m, from centre A to centre B) becomes that of the moved B, so that
/// a manifold made so is one whose bodies have drifted apart since, as far as the solver can tell.
struct Foreseen {
    ManifoldGeometry geometry; // point_count 0 where there is nothing
    std::int32_t normal[3];    // Q2.30, from A to B, of the shortest way
    std::int64_t way;          // Q9.22 m
};
void foresee(const ShapeInstance& a,
             const ShapeInstance& b,
             std::int32_t delta[3],
             std::int64_t way_max,
             Foreseen& out);

} // namespace lockwind
