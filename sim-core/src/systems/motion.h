#pragma once

#include "dynamics/body.h"
#include "dynamics/make_body.h"

#include "lockwind/vector.h"

#include <algorithm>
#include <cstdint>

namespace lockwind {

// Rows of the arena at the API's scale. Reading is exact; writing rounds half up, and holds each
// component of a velocity to kBodySpeedMax.

inline Vec3 read_velocity(const std::int32_t velocity[3]) {
    return {convert<Real>(Velocity::from_raw(velocity[0])),
            convert<Real>(Velocity::from_raw(velocity[1])),
            convert<Real>(Velocity::from_raw(velocity[2]))};
}

inline void write_velocity(const Vec3& value, std::int32_t velocity[3]) {
    const Real components[3] = {value.x, value.y, value.z};
    for (int axis = 0; axis < 3; ++axis) {
        const Real held = std::clamp(components[axis], -kBodySpeedMax, kBodySpeedMax);
        velocity[axis] = convert<Velocity>(held).raw();
    }
}

inline Vec3 read_position(const BodyMotion& motion) {
    return {Real::from_raw(motion.position[0]),
            Real::from_raw(motion.position[1]),
            Real::from_raw(motion.position[2])};
}

inline void write_position(const Vec3& value, BodyMotion& motion) {
    motion.position[0] = value.x.raw();
    motion.position[1] = value.y.raw();
    motion.position[2] = value.z.raw();
}

inline RealQuat read_orientation(const BodyMotion& motion) {
    return {convert<Real>(Unit::from_raw(motion.orientation[0])),
            convert<Real>(Unit::from_raw(motion.orientation[1])),
            convert<Real>(Unit::from_raw(motion.orientation[2])),
            convert<Real>(Unit::from_raw(motion.orientation[3]))};
}

} // namespace lockwind
