#pragma once

#include "lockwind/types.h"
#include "lockwind/vector.h"
#include "lockwind/world_definition.h"

#include <cstdint>

namespace lockwind {

/// A dynamic body that moves, by its velocity and its spin, more than half its smallest size in a
/// tick: with CollisionMode::discrete it may pass through what is thin.
struct FastBody {
    BodyId body;
    CollisionMode mode;
    Real way;  // m in a tick, of its fastest point
    Real size; // m, the smallest way across it
};

/// How thick a wall must be, m, that a body of this size (the smallest way across, m) and speed
/// (m/s, of its fastest point) does not pass, however it comes: 0 means that it passes none.
/// The wall is fixed or kinematic; for CollisionMode::continuous it may be dynamic, too.
///
/// A discrete body is pushed back where it came from while its centre is not past the wall's
/// middle: twice its way in a tick less its size will do, and 4 cm less will not. At 60 Hz that is
/// 33 m for a bullet at 1,000 m/s, and nothing for a ball of 0.5 m at 15 m/s.
Real wall_thickness_min(CollisionMode mode, Real size, Real speed, std::uint32_t tick_rate_hz);

} // namespace lockwind
