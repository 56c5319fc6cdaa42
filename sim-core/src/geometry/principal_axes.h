#pragma once

#include "geometry/mass.h"

#include "lockwind/vector.h"

#include <cstdint>

namespace lockwind {

/// Integrals of x_i x_j / mass about the centre of mass, m^2, Q19.44; symmetrical.
struct Covariance {
    std::int64_t entry[3][3];
};

/// Turns the principal axes' frame into the given one; w >= 0. Each axis is turned by at most 45
/// degrees about another one at a time; products of inertia below 2^-20 of the trace count as 0,
/// so that symmetrical solids keep the axes that they were given in.
RealQuat principal_turn(const Covariance& covariance);

/// Moments of inertia / mass about the turned axes, the columns of `rotation` (Q2.30).
UnitInertia moments_about(const Covariance& covariance, const std::int32_t rotation[9]);

} // namespace lockwind
