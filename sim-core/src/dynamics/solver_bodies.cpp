#include "dynamics/solver_bodies.h"

#include "dynamics/solver_format.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/world_definition.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);
constexpr auto kFixed = static_cast<std::uint8_t>(BodyMode::fixed);

/// The world-frame inverse inertia R diag(principal) R^T, Q5.26, upper triangle by rows.
void turn_inertia(const std::int32_t rotation[9],
                  const std::int32_t principal[3],
                  std::int32_t out[6]) {
    if (principal[0] == principal[1] && principal[1] == principal[2]) {
        const std::int32_t isotropic[6] = {principal[0], 0, 0, principal[0], 0, principal[0]};
        std::copy(isotropic, isotropic + 6, out);
        return;
    }
    int entry = 0;
    for (int row = 0; row < 3; ++row) {
        std::int32_t scaled[3];
        for (int axis = 0; axis < 3; ++axis) {
            scaled[axis] =
                round_unit(static_cast<std::int64_t>(rotation[3 * row + axis]) * principal[axis]);
        }
        for (int column = row; column < 3; ++column) {
            out[entry++] = round_unit(dot_wide(scaled, rotation + 3 * column));
        }
    }
}

void read_terms(const BodyFrame& frame, const BodyProperties& body, BodyTerms& terms) {
    std::copy(frame.rotation, frame.rotation + 9, terms.rotation());
    const bool moves = body.mode != kFixed;
    terms.inverse_gyration_radius() = moves ? body.inverse_gyration_radius : 0;
    if (body.mode == kDynamic) {
        turn_inertia(frame.rotation, body.inverse_inertia, terms.inverse_inertia());
    } else {
        std::fill_n(terms.inverse_inertia(), 6, 0);
    }
}

/// Whether no component leaves +-most. A component + most is, as unsigned, above 2 most where the
/// component is not within; so one comparison answers for all. \pre most < 2^30
bool is_within(const std::int32_t velocity[3], std::int32_t most) {
    const auto bound = static_cast<std::uint32_t>(most);
    std::uint32_t largest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        largest = std::max(largest, static_cast<std::uint32_t>(velocity[axis]) + bound);
    }
    return largest <= 2 * bound;
}

void hold_within(std::int32_t velocity[3], std::int32_t most) {
    for (int axis = 0; axis < 3; ++axis) {
        velocity[axis] = std::clamp(velocity[axis], -most, most);
    }
}

/// Whether a body moves so fast that its contacts are to be held within the formats.
bool is_wild(const SolverBody& body) {
    return !is_within(body.linear, kCalmMax - 1) || !is_within(body.angular, kCalmMax - 1);
}

/// From what a row of an arm of 1.5 bounding radii has at most: a response of leverage x ratio, and
/// 1 + leverage^2 x ratio between two rows. Both are to stay below 8, the former below 7.75. What a
/// box, capsule or sphere has on its surface stays below 7: of those, only deep contacts count.
Overreach overreach_of(const BodyProperties& body) {
    if (body.mode != kDynamic) {
        return Overreach::never;
    }
    const std::int64_t ratio = *std::max_element(body.inverse_inertia, body.inverse_inertia + 3);
    const std::int64_t leverage = raw_saturate<std::int32_t>(round_shift(
        std::int64_t{body.bounding_radius} * body.inverse_gyration_radius, kLengthFraction));
    constexpr std::int64_t kMost = // 7.75 / 1.5
        (std::int64_t{31} << (kEffectiveMassFraction + kInertiaFraction)) / 6;
    constexpr std::int64_t kOne = std::int64_t{1} << (16 + kInertiaFraction);
    const std::int64_t square = (leverage * leverage) >> (2 * kEffectiveMassFraction - 16);
    const bool is_free_form = body.shape >= static_cast<std::uint8_t>(ShapeType::hull);
    if (leverage * ratio > kMost || (is_free_form && square * ratio > 5 * kOne)) {
        return Overreach::always;
    }
    return square * ratio > 26 * kOne / 9 ? Overreach::deep : Overreach::never;
}

} // namespace

SolverBodies::SolverBodies(std::uint32_t capacity)
    : padding_row_(capacity), bodies_(std::size_t{capacity} + 1), terms_(capacity), free_(capacity),
      courses_(capacity), orientations_(capacity), speed_bound_(capacity), overreach_(capacity) {
    dynamic_rows_.reserve(capacity);
    kinematic_rows_.reserve(capacity);
}

void SolverBodies::read(const StepConstants& constants,
                        const DynamicsTables& tables,
                        const BodyFrames& frames,
                        const Activity& activity) {
    dynamic_rows_.clear();
    kinematic_rows_.clear();
    is_any_wild_ = false;
    for (const BodyRow row : activity.rows()) {
        const BodyProperties& body = tables.properties[row];
        read_terms(frames[row], body, terms_[row]);
        overreach_[row] = overreach_of(body);
        read_body(constants, tables.motion[row], body, row);
    }
    for (const BodyRow row : activity.partners()) {
        read_terms(frames[row], tables.properties[row], terms_[row]);
        overreach_[row] = overreach_of(tables.properties[row]);
        bodies_[row] = SolverBody{}; // at rest, and not to be moved
        speed_bound_[row] = 0;
    }
}

void SolverBodies::read_body(const StepConstants& constants,
                             const BodyMotion& motion,
                             const BodyProperties& body,
                             BodyRow row) {
    SolverBody& solver = bodies_[row];
    Course& course = courses_[row];
    solver = SolverBody{};
    course = Course{};
    free_[row] = FreeVelocity{};
    orientations_[row] = nullptr;
    speed_bound_[row] = 0;
    if (body.mode == kFixed) {
        return;
    }
    const std::int32_t linear_max = constants.linear_speed_max;
    const std::int32_t angular_max = angular_speed_max(constants, body.gyration_radius);
    std::int64_t bound = 0;
    for (int axis = 0; axis < 3; ++axis) {
        solver.linear[axis] = std::clamp(motion.linear_velocity[axis], -linear_max, linear_max);
        solver.angular[axis] = std::clamp(motion.angular_velocity[axis], -angular_max, angular_max);
        bound += magnitude(std::int64_t{solver.linear[axis]});
        // No point of a body is farther out than 8 gyration radii.
        bound += 8 * magnitude(std::int64_t{solver.angular[axis]});
    }
    speed_bound_[row] = raw_saturate<std::int32_t>(bound >> 1);
    mark_if_wild(row);
    if (body.mode == kDynamic) {
        dynamic_rows_.push_back(row);
        course.linear_speed_max = linear_max;
        course.angular_speed_max = angular_max;
        return;
    }
    kinematic_rows_.push_back(row);
    for (int axis = 0; axis < 3; ++axis) {
        solver.linear_moved[axis] = solver.linear[axis];
        solver.angular_moved[axis] = solver.angular[axis];
    }
}

bool SolverBodies::mark_if_wild(BodyRow row) {
    if (!is_wild(bodies_[row])) {
        return false;
    }
    mark_wild(row);
    return true;
}

void SolverBodies::hold_back(const StepConstants& constants, BodyRow row) {
    if (row == kNoIndex) {
        return;
    }
    const std::int32_t most = constants.bound_speed_max;
    courses_[row].linear_speed_max = most;
    for (std::int32_t& speed : bodies_[row].linear) {
        speed = std::clamp(speed, -most, most);
    }
}

void SolverBodies::integrate_velocities(const StepConstants& constants, std::uint32_t substep) {
    const std::int32_t* gravity = constants.gravity[substep];
    const bool is_first = substep == 0;
    for (const BodyRow row : dynamic_rows_) {
        SolverBody& body = bodies_[row];
        FreeVelocity& free = free_[row];
        if (mark_if_wild(row)) {
            integrate_wild(gravity, is_first, row);
            continue;
        }
        for (int axis = 0; axis < 3; ++axis) {
            const std::int32_t linear_change =
                is_first ? 0 : raw_subtract(body.linear[axis], free.linear[axis]);
            const std::int32_t angular_change =
                is_first ? 0 : raw_subtract(body.angular[axis], free.angular[axis]);
            free.linear[axis] = raw_add(body.linear[axis], gravity[axis]);
            free.angular[axis] = body.angular[axis];
            body.linear[axis] = raw_add(free.linear[axis], linear_change);
            body.angular[axis] = raw_add(free.angular[axis], angular_change);
        }
    }
}

/// The same, held to what stays in the format.
void SolverBodies::integrate_wild(const std::int32_t* gravity, bool is_first, BodyRow row) {
    const auto integrate =
        [&](std::int32_t& now, std::int32_t& free, std::int64_t acceleration, std::int64_t most) {
            const std::int64_t change =
                is_first ? 0 : std::clamp(std::int64_t{now} - free, -most, most);
            free = static_cast<std::int32_t>(std::clamp(now + acceleration, -2 * most, 2 * most));
            now = static_cast<std::int32_t>(free + change);
        };
    SolverBody& body = bodies_[row];
    FreeVelocity& velocity = free_[row];
    for (int axis = 0; axis < 3; ++axis) {
        integrate(body.linear[axis], velocity.linear[axis], gravity[axis], kLinearHeld);
        integrate(body.angular[axis], velocity.angular[axis], 0, kAngularHeld);
    }
}

void SolverBodies::give(BodyRow row, const std::int64_t linear[3], const std::int64_t angular[3]) {
    const auto change =
        [](std::int32_t& now, std::int32_t& free, std::int64_t by, std::int64_t most) {
            const std::int64_t held = std::clamp(by, -2 * most, 2 * most);
            const std::int64_t next = std::clamp(now + held, -most, most);
            free = static_cast<std::int32_t>(std::clamp(free + next - now, -2 * most, 2 * most));
            now = static_cast<std::int32_t>(next);
        };
    SolverBody& body = bodies_[row];
    FreeVelocity& velocity = free_[row];
    for (int axis = 0; axis < 3; ++axis) {
        change(body.linear[axis], velocity.linear[axis], linear[axis], kLinearHeld);
        change(body.angular[axis], velocity.angular[axis], angular[axis], kAngularHeld);
    }
    mark_if_wild(row);
}

void SolverBodies::integrate_positions() {
    for (const BodyRow row : dynamic_rows_) {
        SolverBody& body = bodies_[row];
        Course& course = courses_[row];
        const bool is_calm =
            is_within(body.linear, std::min(course.linear_speed_max, kCalmMax - 1)) &&
            is_within(body.angular, std::min(course.angular_speed_max, kCalmMax - 1));
        if (!is_calm) {
            hold_within(body.linear, course.linear_speed_max);
            hold_within(body.angular, course.angular_speed_max);
            mark_if_wild(row);
        }
        for (int axis = 0; axis < 3; ++axis) {
            body.linear_moved[axis] = body.linear[axis];
            body.angular_moved[axis] = body.angular[axis];
            course.travel.linear[axis] += body.linear[axis];
            course.travel.angular[axis] += body.angular[axis];
        }
    }
}

void SolverBodies::write(const StepConstants& constants, const DynamicsTables& tables) {
    for (const BodyRow row : dynamic_rows_) {
        BodyMotion& motion = tables.motion[row];
        const BodyProperties& body = tables.properties[row];
        std::copy(bodies_[row].linear, bodies_[row].linear + 3, motion.linear_velocity);
        std::copy(bodies_[row].angular, bodies_[row].angular + 3, motion.angular_velocity);
        move_body(
            constants, courses_[row].travel, orientations_[row], body, motion, tables.sleep[row]);
        clamp_velocities(constants, body, motion);
    }
}

void SolverBodies::write_kinematic(const StepConstants& constants, const DynamicsTables& tables) {
    for (const BodyRow row : kinematic_rows_) {
        BodyTravel travel{};
        for (int axis = 0; axis < 3; ++axis) {
            travel.linear[axis] =
                std::int64_t{bodies_[row].linear_moved[axis]} * constants.substeps;
            travel.angular[axis] =
                std::int64_t{bodies_[row].angular_moved[axis]} * constants.substeps;
        }
        move_body(constants,
                  travel,
                  nullptr,
                  tables.properties[row],
                  tables.motion[row],
                  tables.sleep[row]);
    }
}

void SolverBodies::add_bounces(const DynamicsTables& tables, std::vector<Bounce>& bounces) const {
    for (const BodyRow row : dynamic_rows_) {
        const BodyMotion& motion = tables.motion[row];
        Bounce bounce{row, {}, {}};
        bool any = false;
        for (int axis = 0; axis < 3; ++axis) {
            bounce.linear[axis] =
                raw_subtract(bodies_[row].linear[axis], motion.linear_velocity[axis]);
            bounce.angular[axis] =
                raw_subtract(bodies_[row].angular[axis], motion.angular_velocity[axis]);
            any = any || (bounce.linear[axis] | bounce.angular[axis]) != 0;
        }
        if (any) {
            bounces.push_back(bounce);
        }
    }
}

void SolverBodies::read_velocities(const DynamicsTables& tables) {
    for (const std::vector<BodyRow>* rows : {&dynamic_rows_, &kinematic_rows_}) {
        for (const BodyRow row : *rows) {
            const BodyMotion& motion = tables.motion[row];
            std::copy(motion.linear_velocity, motion.linear_velocity + 3, bodies_[row].linear);
            std::copy(motion.angular_velocity, motion.angular_velocity + 3, bodies_[row].angular);
        }
    }
}

void SolverBodies::write_velocities(const StepConstants& constants, const DynamicsTables& tables) {
    for (const BodyRow row : dynamic_rows_) {
        BodyMotion& motion = tables.motion[row];
        std::copy(bodies_[row].linear, bodies_[row].linear + 3, motion.linear_velocity);
        std::copy(bodies_[row].angular, bodies_[row].angular + 3, motion.angular_velocity);
        clamp_velocities(constants, tables.properties[row], motion);
    }
}

} // namespace lockwind
