#pragma once

#include "dynamics/dynamics.h"

#include <cstdint>

namespace lockwind {

inline constexpr std::uint32_t kSubstepsMax = 16;

/// Highest speed that the solver's Q11.20 holds with room for the relative velocity of two bodies
/// and for what impulses add before the next clamp, m/s. Larger settings mean this.
inline constexpr Real kSolverLinearSpeedMax = 500.0;
/// Of a body that nothing touches or holds.
inline constexpr Real kFreeLinearSpeedMax = 1000.0;
/// The same of angular velocity x gyration radius, which rows multiply by up to 7.
inline constexpr Real kSolverAngularSpeedMax = 200.0;
/// What contacts and joints leave a body with, as the solver holds it: many that press one body the
/// same way stay in the format.
inline constexpr std::int32_t kLinearHeld = convert<Velocity>(kSolverLinearSpeedMax).raw();
inline constexpr std::int32_t kAngularHeld = convert<Velocity>(kSolverAngularSpeedMax).raw();

/// A soft constraint (mass-spring-damper) as three factors, Q3.28. Catto, "Soft Constraints", GDC
/// 2011, and "Solver2D", 2024:
///   x = 2 pi hertz h, a1 = 2 zeta + x, a2 = x a1, a3 = 1 / (1 + a2)
struct Softness {
    std::int32_t mass_scale;    // a2 a3
    std::int32_t impulse_scale; // a3
    std::int32_t bias_rate;     // mass_scale x / a1: bias x h, so that it multiplies s / h
};

/// `substep_rate` = ticks/s x substeps. Hertz is min(30, substep_rate / 8), doubled by
/// `hertz_factor` 2; the damping ratio is an integer.
Softness make_softness(std::uint32_t substep_rate, int hertz_factor, int damping_ratio);

/// value x multiplier / 2^shift, rounded to nearest, is value / divisor to two parts in 10^9.
struct Reciprocal {
    std::int64_t multiplier; // 2^28 .. 2^29
    int shift;
};
Reciprocal make_reciprocal(std::uint32_t divisor);

/// value / divisor x 2^fraction_bits; |value| < 2^33 + 2^32, fraction_bits <= 12.
inline std::int64_t divide(std::int64_t value, Reciprocal reciprocal, int fraction_bits) {
    const int shift = reciprocal.shift - fraction_bits;
    return (value * reciprocal.multiplier + (std::int64_t{1} << (shift - 1))) >> shift;
}

/// What follows from the settings alone.
struct StepConstants {
    std::uint32_t tick_rate;
    std::uint32_t substeps;
    std::int32_t substep_rate; // Hz
    Reciprocal per_substep_rate;
    Softness dynamic_softness; // both partners dynamic: damping ratio 10
    Softness static_softness;  // twice as stiff: damping ratio 5
    /// Q11.20 m/s added in each substep. A tick's sum is rounded once, not each substep's part.
    std::int32_t gravity[kSubstepsMax][3];
    std::int32_t separation_max;   // Q9.22 m: 960 m/s in a substep, or 4 m
    std::int32_t linear_speed_max; // Q11.20 m/s
    std::int32_t bound_speed_max;  // the same of bodies with contacts or joints
    Real angular_speed_max;        // rad/s
};

/// Settings outside the ranges above are taken as the nearest in range.
StepConstants make_step_constants(const DynamicsSettings& settings);

/// Largest angular velocity x gyration radius, Q11.20.
std::int32_t angular_speed_max(const StepConstants& constants, std::int32_t gyration_radius);

} // namespace lockwind
