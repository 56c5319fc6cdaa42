#include "dynamics/step_constants.h"

#include "dynamics/solver_format.h"

#include "lockwind/world_definition.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr std::uint32_t kContactHertzMax = 30;
constexpr std::int64_t kTwoPi = 26986075409; // Q31.32

std::int32_t round_to_velocity(std::int64_t value, std::int64_t divisor) {
    // Q31.32 / divisor -> Q11.20, to the nearest.
    const std::int64_t unit = divisor << (32 - kVelocityFraction);
    const std::int64_t sum = value + (unit >> 1);
    const std::int64_t quotient = sum / unit;
    return static_cast<std::int32_t>(quotient - (quotient * unit > sum ? 1 : 0));
}

} // namespace

Softness make_softness(std::uint32_t substep_rate, int hertz_factor, int damping_ratio) {
    constexpr std::int64_t kOne = std::int64_t{1} << 28;
    // Eight times the hertz: hertz x h = hertz_8 / (8 substep_rate) <= 1/4, so x < 2 in Q3.28.
    const std::int64_t hertz_8 =
        static_cast<std::int64_t>(std::min(8 * kContactHertzMax, substep_rate)) * hertz_factor;
    const std::int64_t x =
        ((kTwoPi >> 4) * hertz_8 / (8 * static_cast<std::int64_t>(substep_rate)));
    const std::int64_t a1 = 2 * damping_ratio * kOne + x;
    const std::int64_t a2 = (x * (a1 >> 4)) >> 24;
    const std::int64_t impulse_scale = (kOne << 28) / (kOne + a2);
    const std::int64_t mass_scale = kOne - impulse_scale;
    const std::int64_t bias = (x << 28) / a1;
    return {static_cast<std::int32_t>(mass_scale),
            static_cast<std::int32_t>(impulse_scale),
            static_cast<std::int32_t>((mass_scale * bias) >> 28)};
}

Reciprocal make_reciprocal(std::uint32_t divisor) {
    int shift = 28;
    while ((std::uint64_t{1} << (shift - 28)) < divisor) {
        ++shift;
    }
    const std::int64_t numerator = std::int64_t{1} << shift;
    return {(numerator + divisor / 2) / divisor, shift};
}

StepConstants make_step_constants(const DynamicsSettings& settings) {
    StepConstants constants{};
    constants.tick_rate =
        std::clamp(settings.tick_rate_hz, kWorldTickRateHzMin, kWorldTickRateHzMax);
    constants.substeps = std::clamp(settings.substeps, std::uint32_t{1}, kSubstepsMax);
    const std::uint32_t rate = constants.tick_rate * constants.substeps;
    constants.substep_rate = static_cast<std::int32_t>(rate);
    constants.per_substep_rate = make_reciprocal(rate);
    constants.dynamic_softness = make_softness(rate, 1, 10);
    constants.static_softness = make_softness(rate, 2, 5);
    constexpr std::int64_t kGravityMax = std::int64_t{1000} << 32;
    const std::int64_t gravity[3] = {
        settings.gravity.x.raw(), settings.gravity.y.raw(), settings.gravity.z.raw()};
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t value = std::clamp(gravity[axis], -kGravityMax, kGravityMax);
        const std::int64_t of_tick = round_to_velocity(value, constants.tick_rate);
        std::int64_t given = 0;
        for (std::uint32_t substep = 0; substep < constants.substeps; ++substep) {
            const std::int64_t due = of_tick * (substep + 1) / constants.substeps;
            constants.gravity[substep][axis] = static_cast<std::int32_t>(due - given);
            given = due;
        }
    }
    const std::int64_t bound = (std::int64_t{960} << kLengthFraction) / rate;
    constants.separation_max =
        static_cast<std::int32_t>(std::min(bound, std::int64_t{4} << kLengthFraction));
    constexpr Real kZero = 0;
    const auto linear = [&](Real most) {
        return convert<Velocity>(std::clamp(settings.linear_speed_max, kZero, most)).raw();
    };
    constants.linear_speed_max = linear(kFreeLinearSpeedMax);
    constants.bound_speed_max = linear(kSolverLinearSpeedMax);
    constexpr Real kAngularMax = 10000;
    constants.angular_speed_max = std::clamp(settings.angular_speed_max, kZero, kAngularMax);
    return constants;
}

std::int32_t angular_speed_max(const StepConstants& constants, std::int32_t gyration_radius) {
    // rad/s in Q14.16 x m in Q9.22.
    const std::int64_t product = (constants.angular_speed_max.raw() >> 16) * gyration_radius;
    const std::int64_t cap = kSolverAngularSpeedMax.raw() >> (32 - kVelocityFraction);
    return static_cast<std::int32_t>(std::min(product >> (16 + 22 - kVelocityFraction), cap));
}

} // namespace lockwind
