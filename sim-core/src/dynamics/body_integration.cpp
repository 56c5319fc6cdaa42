#include "dynamics/body_integration.h"

#include "dynamics/solver_format.h"
#include "dynamics/turn.h"
#include "geometry/rotation.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/world_definition.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);
constexpr auto kSphere = static_cast<std::uint8_t>(ShapeType::sphere);

/// An upper bound of a vector's length: its largest component and half of the others.
std::int64_t length_bound(const std::int64_t v[3]) {
    const std::int64_t size[3] = {magnitude(v[0]), magnitude(v[1]), magnitude(v[2])};
    const std::int64_t largest = std::max({size[0], size[1], size[2]});
    return largest + ((size[0] + size[1] + size[2] - largest) >> 1);
}

/// The turn of a tick, Q.30 rad, each within +-4, from the angular travel.
void turn_of(const StepConstants& constants,
             const std::int64_t travel[3],
             const BodyProperties& body,
             std::int64_t turn[3]) {
    constexpr std::int64_t kTurnMax = std::int64_t{4} << 30;
    const std::int64_t farthest = std::int64_t{body.gyration_radius} << 12; // 4 rad in Q.32 m
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t arc =
            std::clamp(divide(travel[axis], constants.per_substep_rate, 12), -farthest, farthest);
        const std::int64_t angle =
            raw_multiply(arc, std::int64_t{body.inverse_gyration_radius}) >> 26;
        // Again, because the radius and its inverse of damaged rows may disagree.
        turn[axis] = std::clamp(angle, -kTurnMax, kTurnMax);
    }
}

void count_motion(std::int64_t moved, BodyMotion& motion, BodySleep& sleep) {
    constexpr std::int64_t kMoveMax = 1 << 24; // 4 m: sums stay far inside Q9.22
    for (const MotionBound bound : {MotionBound::touching, MotionBound::other}) {
        const auto index = static_cast<std::size_t>(bound);
        motion.motion_sum[index] += static_cast<std::int32_t>(std::min(moved, kMoveMax));
        if (motion.motion_sum[index] > kMotionBound[index]) {
            motion.motion_sum[index] = 0;
            sleep.moved |= bit_of(bound);
        }
    }
}

/// Gyroscopic torque below half a unit of velocity a tick is none.
bool turns_freely(const BodyProperties& body,
                  const std::int64_t travel[3],
                  const std::int64_t turn[3],
                  std::uint32_t substeps) {
    const std::int32_t* inertia = body.inverse_inertia;
    if (body.mode != kDynamic || (inertia[0] == inertia[1] && inertia[1] == inertia[2]) ||
        std::min({inertia[0], inertia[1], inertia[2]}) <= 0) {
        return false;
    }
    constexpr std::int64_t kTurnMax = std::int64_t{1} << 30;
    const std::int64_t speed = length_bound(travel) / substeps;
    return speed * std::min(length_bound(turn), kTurnMax) >= kTurnMax / 2;
}

/// Rounded, ties away from zero: what is cut off towards zero a tick slows a spin down.
std::int64_t round_quotient(std::int64_t numerator, std::int64_t divisor) {
    const std::int64_t half = numerator < 0 ? -(divisor / 2) : divisor / 2;
    return (numerator + half) / divisor;
}

/// Rounds a change of velocity from Q.24 to Q.20 so that it neither adds nor takes along
/// `gradient`, as far as one unit more or less of each component allows: a minute's roundings to
/// the nearest would add up.
void round_change(const std::int64_t gradient[3], std::int64_t change[3]) {
    constexpr std::int64_t kUnit = 16;
    std::int64_t excess = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t exact = change[axis];
        change[axis] = round_quotient(exact, kUnit);
        excess += (change[axis] * kUnit - exact) * gradient[axis];
    }
    // The component that matters most first: those after it correct finer.
    int order[3] = {0, 1, 2};
    std::sort(order, order + 3, [&](int a, int b) {
        const std::int64_t of_a = magnitude(gradient[a]);
        const std::int64_t of_b = magnitude(gradient[b]);
        return of_a > of_b || (of_a == of_b && a < b);
    });
    for (const int axis : order) {
        const std::int64_t step = (excess < 0) == (gradient[axis] < 0) ? -1 : 1;
        const std::int64_t corrected = excess + step * kUnit * gradient[axis];
        if (magnitude(corrected) < magnitude(excess)) {
            change[axis] += step;
            excess = corrected;
        }
    }
}

void turn_freely(const StepConstants& constants,
                 const std::int64_t travel[3],
                 const BodyProperties& body,
                 BodyMotion& motion) {
    std::int32_t rotation[9];
    rotation_matrix(motion.orientation, rotation);
    const std::int64_t speed_cap = std::int64_t{200} << 24;
    std::int64_t before[3]; // mean velocity of the tick, world, Q.24
    for (int axis = 0; axis < 3; ++axis) {
        before[axis] = std::clamp((travel[axis] << 4) / constants.substeps, -speed_cap, speed_cap);
    }
    FreeTurn turn{};
    for (int axis = 0; axis < 3; ++axis) {
        turn.inertia[axis] = std::max(body.inverse_inertia[axis] >> 4, 1);
    }
    turn.inertia_min = std::min({turn.inertia[0], turn.inertia[1], turn.inertia[2]});
    turn.angle_of_velocity =
        (std::int64_t{body.inverse_gyration_radius} << 8) / constants.tick_rate;
    turn.velocity_max = (std::int64_t{body.gyration_radius} << 4) * constants.tick_rate;
    std::copy(motion.orientation, motion.orientation + 4, turn.orientation);
    std::int64_t local[3];
    inverse_rotate(rotation, before, local);
    for (int axis = 0; axis < 3; ++axis) {
        turn.momentum[axis] = round_quotient(local[axis] * turn.inertia_min, turn.inertia[axis]);
    }
    turn.run();
    normalize_quaternion(turn.orientation, motion.orientation);
    for (int axis = 0; axis < 3; ++axis) {
        local[axis] = round_quotient(turn.momentum[axis] * turn.inertia[axis], turn.inertia_min);
    }
    rotation_matrix(motion.orientation, rotation);
    std::int64_t change[3];
    rotate(rotation, local, change);
    // How the square of the momentum grows with the velocity.
    std::int64_t gradient[3];
    for (int axis = 0; axis < 3; ++axis) {
        change[axis] -= before[axis];
        local[axis] = round_quotient(turn.momentum[axis] * turn.inertia_min, turn.inertia[axis]);
    }
    rotate(rotation, local, gradient);
    round_change(gradient, change);
    for (int axis = 0; axis < 3; ++axis) {
        motion.angular_velocity[axis] =
            raw_saturate<std::int32_t>(motion.angular_velocity[axis] + change[axis]);
    }
}

void turn_by(const std::int64_t turn[3], BodyMotion& motion) {
    const std::int64_t half[3] = {turn[0] >> 1, turn[1] >> 1, turn[2] >> 1};
    std::int64_t change[4];
    turn_quaternion(half, change);
    std::int64_t orientation[4];
    std::copy(motion.orientation, motion.orientation + 4, orientation);
    multiply_quaternions(change, orientation, orientation);
    normalize_quaternion(orientation, motion.orientation);
}

void clamp_length(std::int32_t v[3], std::int64_t longest) {
    std::uint64_t square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        square += static_cast<std::uint64_t>(std::int64_t{v[axis]} * v[axis]);
    }
    if (square <= static_cast<std::uint64_t>(longest * longest)) {
        return;
    }
    // Rounded up, so that the result never is too long.
    const auto length = static_cast<std::int64_t>(floor_sqrt(square)) + 1;
    for (int axis = 0; axis < 3; ++axis) {
        v[axis] = static_cast<std::int32_t>(v[axis] * longest / length);
    }
}

} // namespace

void move_body(const StepConstants& constants,
               const BodyTravel& travel,
               const std::int32_t* orientation,
               const BodyProperties& body,
               BodyMotion& motion,
               BodySleep& sleep) {
    std::int64_t moved[3]; // Q.22 m
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t step = divide(travel.linear[axis], constants.per_substep_rate, 12);
        motion.position[axis] = raw_add(motion.position[axis], step);
        moved[axis] = magnitude(step) >> (32 - kLengthFraction);
    }
    std::int64_t turn[3];
    turn_of(constants, travel.angular, body, turn);
    std::int64_t bound = length_bound(moved);
    if (body.shape != kSphere) {
        constexpr std::int64_t kTurnMax = std::int64_t{1} << 31;
        bound += (std::min(length_bound(turn), kTurnMax) * body.bounding_radius) >> kUnitFraction;
    }
    count_motion(bound, motion, sleep);
    if (orientation != nullptr) {
        std::copy(orientation, orientation + 4, motion.orientation);
    } else if (turns_freely(body, travel.angular, turn, constants.substeps)) {
        turn_freely(constants, travel.angular, body, motion);
    } else if ((turn[0] | turn[1] | turn[2]) != 0) {
        turn_by(turn, motion);
    }
}

void clamp_velocities(const StepConstants& constants,
                      const BodyProperties& body,
                      BodyMotion& motion) {
    clamp_length(motion.linear_velocity, constants.linear_speed_max);
    clamp_length(motion.angular_velocity, angular_speed_max(constants, body.gyration_radius));
}

} // namespace lockwind
