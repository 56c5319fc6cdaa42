#include "dynamics/joint_bodies.h"

#include "dynamics/joint_block.h"
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
constexpr auto kFixed = static_cast<std::uint8_t>(BodyMode::fixed);

/// (I_j - I_k) / I_i = i_i (i_k - i_j) / (i_j i_k) of the inverse inertias; at most 1 of a body.
void read_gyroscopic(const std::int32_t inverse[3], std::int32_t out[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t own = inverse[axis];
        const std::int64_t next = inverse[(axis + 1) % 3];
        const std::int64_t last = inverse[(axis + 2) % 3];
        const std::int64_t product = std::max<std::int64_t>(round_shift(next * last, 26), 1);
        const std::int64_t ratio = multiply_divide((last - next) * 16, own << 26, product);
        constexpr std::int64_t kLimit = kUnitOne;
        out[axis] = static_cast<std::int32_t>(std::clamp(ratio >> 26, -kLimit, kLimit));
    }
}

/// R diag(principal) R^T, upper triangle by rows, Q5.26.
void turn_inertia(const JointBody& body, std::int64_t out[6]) {
    int entry = 0;
    for (int row = 0; row < 3; ++row) {
        std::int64_t scaled[3];
        for (int axis = 0; axis < 3; ++axis) {
            scaled[axis] =
                round_unit_wide(std::int64_t{body.rotation[3 * row + axis]} * body.principal[axis]);
        }
        for (int column = row; column < 3; ++column) {
            out[entry++] = dot_unit(body.rotation + 3 * column, scaled);
        }
    }
}

void refresh(JointBody& body) {
    rotation_matrix(body.orientation, body.rotation);
    turn_inertia(body, body.inverse_inertia);
}

} // namespace

void substep_turn(const JointBody& body, const std::int32_t angular[3], std::int64_t turn[3]) {
    constexpr std::int64_t kTurnMax = std::int64_t{4} << 30;
    for (int axis = 0; axis < 3; ++axis) {
        const Int128 wide = wide_product<Int128>(angular[axis], body.turn_per_velocity);
        turn[axis] = std::clamp(round_exact(wide, 22), -kTurnMax, kTurnMax);
    }
}

JointBodies::JointBodies(std::uint32_t body_capacity, std::uint32_t joint_capacity)
    : index_of_row_(body_capacity, 0) {
    // Two bodies a joint at most; a grab has a place of its own.
    bodies_.reserve(
        std::min(std::size_t{2} * joint_capacity, std::size_t{body_capacity} + joint_capacity));
}

void JointBodies::add(const StepConstants& constants, const DynamicsTables& tables, BodyRow row) {
    const std::uint32_t known = index_of_row_[row];
    if (known < bodies_.size() && bodies_[known].row == row) {
        ++bodies_[known].joint_count;
        return;
    }
    const BodyMotion& motion = tables.motion[row];
    const BodyProperties& properties = tables.properties[row];
    JointBody body{};
    body.row = row;
    body.joint_count = 1;
    body.dynamic = properties.mode == kDynamic;
    body.inverse_mass = body.dynamic ? properties.inverse_mass : 0;
    if (properties.mode != kFixed) {
        body.inverse_gyration_radius = properties.inverse_gyration_radius;
        body.turn_per_velocity =
            (std::int64_t{properties.inverse_gyration_radius} << 8) / constants.substep_rate;
    }
    if (body.dynamic) {
        std::copy(properties.inverse_inertia, properties.inverse_inertia + 3, body.principal);
        read_gyroscopic(body.principal, body.gyroscopic);
    }
    std::copy(motion.position, motion.position + 3, body.start);
    std::copy(motion.orientation, motion.orientation + 4, body.orientation);
    refresh(body);
    index_of_row_[row] = static_cast<std::uint32_t>(bodies_.size());
    bodies_.push_back(body);
}

std::uint32_t JointBodies::add_place(const std::int64_t place[3]) {
    JointBody body{};
    body.row = kNoIndex;
    std::copy(place, place + 3, body.start);
    body.orientation[3] = kUnitOne;
    refresh(body);
    bodies_.push_back(body);
    return static_cast<std::uint32_t>(bodies_.size() - 1);
}

void JointBodies::turn_velocities(SolverBodies& bodies) const {
    for (const JointBody& body : bodies_) {
        if ((body.gyroscopic[0] | body.gyroscopic[1] | body.gyroscopic[2]) == 0) {
            continue;
        }
        const std::int32_t* angular = bodies.body(body.row).angular;
        const std::int64_t world[3] = {std::int64_t{angular[0]} << 10,
                                       std::int64_t{angular[1]} << 10,
                                       std::int64_t{angular[2]} << 10}; // Q.30
        std::int64_t before[3];
        inverse_rotate(body.rotation, world, before);
        std::int64_t change[3] = {};
        // Three rounds: the rest is below (half the turn)^4 of the change.
        for (int round = 0; round < 3; ++round) {
            std::int64_t turn[3];
            std::int64_t middle[3];
            for (int axis = 0; axis < 3; ++axis) {
                middle[axis] = before[axis] + (change[axis] >> 1);
                const Int128 wide = wide_product<Int128>(middle[axis], body.turn_per_velocity);
                turn[axis] = std::clamp<std::int64_t>(round_exact(wide, 32), -kUnitOne, kUnitOne);
            }
            for (int axis = 0; axis < 3; ++axis) {
                const int next = (axis + 1) % 3;
                const int last = (axis + 2) % 3;
                const std::int64_t rate =
                    round_unit_wide(std::int64_t{body.gyroscopic[axis]} * turn[next]);
                change[axis] = round_exact(wide_product<Int128>(rate, middle[last]), 30);
            }
        }
        std::int64_t turned[3];
        rotate(body.rotation, change, turned);
        const std::int64_t none[3] = {};
        const std::int64_t added[3] = {
            round_shift(turned[0], 10), round_shift(turned[1], 10), round_shift(turned[2], 10)};
        bodies.give(body.row, none, added);
    }
}

void JointBodies::follow(const StepConstants& constants, const SolverBodies& bodies) {
    for (JointBody& body : bodies_) {
        if (body.turn_per_velocity == 0) {
            continue; // fixed
        }
        const SolverBody& solver = bodies.body(body.row);
        for (int axis = 0; axis < 3; ++axis) {
            body.moved[axis] += divide(solver.linear_moved[axis], constants.per_substep_rate, 12);
        }
        std::int64_t turn[3];
        substep_turn(body, solver.angular_moved, turn);
        if ((turn[0] | turn[1] | turn[2]) == 0) {
            continue;
        }
        const std::int64_t half[3] = {
            round_shift(turn[0], 1), round_shift(turn[1], 1), round_shift(turn[2], 1)};
        std::int64_t orientation[4];
        std::int64_t change[4];
        turn_quaternion(half, change);
        std::copy(body.orientation, body.orientation + 4, orientation);
        multiply_quaternions(change, orientation, orientation);
        normalize_quaternion(orientation, body.orientation);
        refresh(body);
    }
}

void JointBodies::hand_over(SolverBodies& bodies) const {
    for (const JointBody& body : bodies_) {
        if (body.dynamic) {
            bodies.set_orientation(body.row, body.orientation);
        }
    }
}

} // namespace lockwind
