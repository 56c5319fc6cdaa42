#pragma once

#include "geometry/fixed_geometry.h"

#include <cstdint>

namespace lockwind {

// Binary places of the solver's int32 formats; kLengthFraction (22) and kUnitFraction (30) are
// geometry's.
inline constexpr int kVelocityFraction = 20;      // Q11.20 m/s
inline constexpr int kCoefficientFraction = 28;   // Q3.28
inline constexpr int kEffectiveMassFraction = 24; // Q7.24: K, 1/gyration radius
inline constexpr int kInertiaFraction = 26;       // Q5.26

inline constexpr std::int32_t kVelocityOne = 1 << kVelocityFraction;
inline constexpr std::int32_t kCoefficientOne = 1 << kCoefficientFraction;

} // namespace lockwind
