#pragma once

#include "dynamics/body.h"
#include "dynamics/step_constants.h"

#include <cstdint>

namespace lockwind {

/// A body's velocities summed over the substeps of a tick, Q.20 m/s; angular ones times the
/// gyration radius.
struct BodyTravel {
    std::int64_t linear[3];
    std::int64_t angular[3];
};

/// Moves and turns a body that is not fixed by what it travelled in a tick, and counts how far. A
/// dynamic body whose principal inertias differ and whose `orientation` at the tick's end (Q2.30)
/// is null turns as a free rigid body and angular_velocity changes with it (gyroscopic torque). A
/// turn is at most 4 rad a tick about each axis.
void move_body(const StepConstants& constants,
               const BodyTravel& travel,
               const std::int32_t* orientation,
               const BodyProperties& body,
               BodyMotion& motion,
               BodySleep& sleep);

/// Shortens the velocities to the largest speeds that the settings allow.
void clamp_velocities(const StepConstants& constants,
                      const BodyProperties& body,
                      BodyMotion& motion);

} // namespace lockwind
