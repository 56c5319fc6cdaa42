#pragma once

#include "lockwind/fixed.h"

namespace lockwind {

using Real = Fixed<std::int64_t, 32>;        // Q31.32: positions, speeds, masses, the API's scalar
using Unit = Fixed<std::int32_t, 30>;        // Q2.30: unit vectors, rotations, quaternions
using Length = Fixed<std::int32_t, 22>;      // Q9.22 m: local lengths, anchors, separations
using Velocity = Fixed<std::int32_t, 20>;    // Q11.20 m/s: solver velocities, impulses / mass
using Coefficient = Fixed<std::int32_t, 28>; // Q3.28: solver rows, friction, restitution
using InverseMass = Fixed<std::int64_t, 40>; // Q24.40 1/kg

struct Vec3 {
    Real x, y, z;
    bool operator==(const Vec3&) const = default;
};

struct RealQuat {
    Real x, y, z, w = 1;
    bool operator==(const RealQuat&) const = default;
};

} // namespace lockwind
