#include "dynamics/joint_constraint.h"

#include "dynamics/solver_format.h"

#include "lockwind/overflow.h"
#include "lockwind/vector.h"

#include <algorithm>
#include <limits>

namespace lockwind {

namespace {

constexpr std::int64_t kOne = std::int64_t{1} << 40;
/// Held rows are springs of a quarter of the substep rate (60 Hz at 240, as in Box2D 3) between the
/// two masses, with damping ratio 2: a substep brings back 28 % of what they are off. Not capped
/// at 60 Hz: more substeps are to mean stiffer joints.
constexpr std::int32_t kJointDamping = 2 << 20;
constexpr std::int32_t kHertzMost = std::numeric_limits<std::int32_t>::max();
/// Speed of that, m/s, at most. (At 5 and 10 m/s joints torn apart stay so, at wrong levers, and
/// feed on it.)
constexpr std::int64_t kPushMax = std::int64_t{20} << kImpulseFraction;

constexpr int kSpringPart = 0;
constexpr int kMotorPart = 1;
constexpr int kLowerPart = 2;
constexpr int kUpperPart = 3;

std::int64_t scaled(std::int64_t value, std::int64_t factor) {
    return round_exact(wide_product<Int128>(value, factor), 40);
}

/// Speeds and sums of them stay far inside 64 bits, whatever a forged state makes of them.
std::int64_t bounded(std::int64_t speed) {
    constexpr std::int64_t kMost = std::int64_t{1} << 60;
    return std::clamp(speed, -kMost, kMost);
}

std::int64_t held_in(std::int64_t impulse) {
    return std::clamp(impulse, -kJointImpulseMax, kJointImpulseMax);
}

std::int64_t size_of(const std::int64_t v[3]) {
    return length({Real::from_raw(v[0]), Real::from_raw(v[1]), Real::from_raw(v[2])}).raw();
}

/// J u, Q.32, of Q11.20 velocities.
std::int64_t speed_of(const JointRow& row, const SolverBody& a, const SolverBody& b) {
    std::int64_t between[3];
    std::int64_t spin_a[3];
    std::int64_t spin_b[3];
    for (int axis = 0; axis < 3; ++axis) {
        between[axis] = std::int64_t{b.linear[axis]} - a.linear[axis];
        spin_a[axis] = a.angular[axis];
        spin_b[axis] = b.angular[axis];
    }
    const Int128 sum =
        raw_add(raw_add(dot_exact(row.linear, between), dot_exact(row.angular_a, spin_a)),
                dot_exact(row.angular_b, spin_b));
    return round_exact(sum, kRowFraction + kVelocityFraction - kImpulseFraction);
}

/// What a lever does in a substep beyond angular velocity x lever, and that, Q.32 m.
struct LeverStep {
    std::int64_t first[3];
    std::int64_t beyond[3];
};

/// Rodrigues: (R - 1) r = sin t / t (w x r) + (1 - cos t) / t^2 w x (w x r), both by their series
/// to t^4; turns above a radian count as one.
LeverStep step_lever(std::int64_t turn_per_velocity,
                     const std::int32_t angular[3],
                     const std::int64_t lever[3]) {
    constexpr std::int64_t kRadian = std::int64_t{1} << 30;
    std::int64_t turn[3];
    std::int64_t square = 0; // Q.30
    for (int axis = 0; axis < 3; ++axis) {
        turn[axis] =
            std::clamp(round_exact(wide_product<Int128>(angular[axis], turn_per_velocity), 22),
                       -kRadian,
                       kRadian);
        square += (turn[axis] * turn[axis]) >> 30;
    }
    square = std::min(square, 2 * kRadian);
    const std::int64_t fourth = (square * square) >> 30;
    const std::int64_t of_first = -square / 6 + fourth / 120;
    const std::int64_t of_second = kRadian / 2 - square / 24 + fourth / 720;
    LeverStep step{};
    const auto cross = [&](const std::int64_t v[3], int axis) {
        const int next = (axis + 1) % 3;
        const int last = (axis + 2) % 3;
        return round_exact(raw_subtract(wide_product<Int128>(turn[next], v[last]),
                                        wide_product<Int128>(turn[last], v[next])),
                           30);
    };
    for (int axis = 0; axis < 3; ++axis) {
        step.first[axis] = cross(lever, axis);
    }
    for (int axis = 0; axis < 3; ++axis) {
        step.beyond[axis] =
            round_exact(raw_add(wide_product<Int128>(of_first, step.first[axis]),
                                wide_product<Int128>(of_second, cross(step.first, axis))),
                        30);
    }
    return step;
}

} // namespace

JointSoftness
make_joint_softness(std::int32_t substep_rate, std::int32_t hertz, std::int32_t damping_ratio) {
    constexpr std::int64_t kTwoPi = 26986075409; // Q31.32
    const std::int64_t most = std::int64_t{substep_rate} << 14;
    const std::int64_t held = std::clamp<std::int64_t>(hertz, 1, most);
    const std::int64_t x = std::max<std::int64_t>(((kTwoPi * held) / substep_rate) >> 8, 1);
    const std::int64_t a1 = (std::int64_t{damping_ratio} << 21) + x;
    const std::int64_t a2 = std::max<std::int64_t>(scaled(x, a1), 1);
    const std::int64_t impulse_scale = multiply_divide(kOne, kOne, kOne + a2);
    const std::int64_t mass_scale = kOne - impulse_scale;
    constexpr std::int64_t kMost = std::int64_t{1} << 61;
    return {
        mass_scale,
        multiply_divide(x, kOne, a1),
        std::min(multiply_divide(impulse_scale, std::int64_t{1} << kResponseFraction, mass_scale),
                 kMost)};
}

JointConstraint::JointConstraint(const StepConstants& constants,
                                 const Joint& joint,
                                 std::uint32_t table_row,
                                 const JointBodies& bodies,
                                 std::uint32_t index_a,
                                 std::uint32_t index_b)
    : table_row_(table_row), index_a_(index_a), index_b_(index_b), row_a_(joint.row_a),
      row_b_(joint.row_b), substep_rate_(constants.substep_rate),
      turn_a_(bodies[index_a].turn_per_velocity), turn_b_(bodies[index_b].turn_per_velocity),
      constants_(make_joint_constants(joint, bodies[index_a], bodies[index_b])),
      rigid_(make_joint_softness(constants.substep_rate, kHertzMost, kJointDamping)),
      is_shared_(bodies.is_shared(index_a) || bodies.is_shared(index_b)),
      can_break_(joint.break_force > 0 || joint.break_torque > 0),
      swing_impulse_(joint.swing_impulse),
      reduced_mass_(constants_.inverse_mass > 0 ? multiply_divide(std::int64_t{1} << 40,
                                                                  std::int64_t{1} << 40,
                                                                  constants_.inverse_mass)
                                                : 0),
      beyond_{}, force_sum_{}, torque_sum_{} {
    std::copy(joint.row_impulse, joint.row_impulse + kJointRowsMax, row_impulse_);
    std::copy(joint.axis_impulse, joint.axis_impulse + 4, axis_impulse_);
    read_axis(constants, joint);
    refresh(joint, bodies);
}

void JointConstraint::read_axis(const StepConstants& constants, const Joint& joint) {
    const JointKind kind = constants_.kind;
    const std::int64_t scale = constants_.scale;
    const bool turns = kind == JointKind::hinge || kind == JointKind::cone_twist;
    const auto angle = [&](std::int32_t radians) {
        return round_exact(wide_product<Int128>(radians, scale), 18);
    };
    const auto place = [&](std::int32_t metres, std::int32_t radians) {
        return turns ? angle(radians) : std::int64_t{metres} << 10;
    };
    const bool soft = joint.has_spring != 0 || kind == JointKind::grab;
    held_is_soft_ = soft && (kind == JointKind::grab || kind == JointKind::fixed);
    spring_.exists = soft && !held_is_soft_;
    spring_.softness =
        make_joint_softness(constants.substep_rate, joint.spring_hertz, joint.spring_damping);
    spring_.rest = place(joint.rest_length, joint.rest_angle);
    limit_.exists = joint.has_limit != 0;
    limit_.low = place(joint.length_limit[0], joint.angle_limit[0]);
    limit_.high = place(joint.length_limit[1], joint.angle_limit[1]);
    limit_.swing = angle(joint.swing_limit);
    const bool motor_turns = turns || kind == JointKind::wheel;
    motor_.exists = joint.has_motor != 0;
    motor_.speed = motor_turns ? round_exact(wide_product<Int128>(joint.motor_speed, scale), 10)
                               : std::int64_t{joint.motor_speed} << 12;
    motor_.impulse_max = impulse_of(joint.motor_limit, motor_turns);
}

/// Force x substep x (1/m_a + 1/m_b); of a torque / scale.
std::int64_t JointConstraint::impulse_of(std::int64_t force, bool is_torque) const {
    const std::int64_t acceleration =
        round_exact(wide_product<Int128>(force, constants_.inverse_mass), 40);
    const std::int64_t impulse = acceleration / substep_rate_;
    constexpr std::int64_t kMetre = std::int64_t{1} << 22;
    return held_in(is_torque ? multiply_divide(impulse, kMetre, constants_.scale) : impulse);
}

void JointConstraint::refresh(const Joint& joint, const JointBodies& bodies) {
    const JointBody& a = bodies[index_a_];
    const JointBody& b = bodies[index_b_];
    make_joint_rows(joint, constants_, a, b, rows_);
    fill_joint_block(constants_, a, b, rows_, block_);
}

void JointConstraint::look_ahead(const SolverBodies& bodies) {
    if (held_is_soft_) {
        return;
    }
    const SolverBody& a = bodies.body(row_a_);
    const SolverBody& b = bodies.body(row_b_);
    const LeverStep of_a = step_lever(turn_a_, a.angular, rows_.lever_a);
    const LeverStep of_b = step_lever(turn_b_, b.angular, rows_.lever_b);
    std::int64_t beyond[3]; // Q.32 m/s
    for (int axis = 0; axis < 3; ++axis) {
        beyond[axis] = (of_b.beyond[axis] - of_a.beyond[axis]) * substep_rate_;
    }
    for (int row = 0; row < block_.count(); ++row) {
        beyond_[row] = round_exact(dot_exact(rows_.row[row].linear, beyond), kRowFraction);
    }
    if (constants_.kind != JointKind::distance) {
        return;
    }
    // The direction turns too: the distance after the substep, exactly.
    Real gap[3];
    std::int64_t moved[3]; // Q.32 m
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t speed = std::int64_t{b.linear[axis]} - a.linear[axis];
        moved[axis] = (speed << 12) / substep_rate_ + of_b.first[axis] + of_b.beyond[axis] -
                      of_a.first[axis] - of_a.beyond[axis];
        gap[axis] = Real::from_raw(rows_.gap[axis] + moved[axis]);
    }
    const std::int64_t now = length({Real::from_raw(rows_.gap[0]),
                                     Real::from_raw(rows_.gap[1]),
                                     Real::from_raw(rows_.gap[2])})
                                 .raw();
    const std::int64_t then = length({gap[0], gap[1], gap[2]}).raw();
    const std::int64_t along = round_exact(dot_exact(rows_.row[0].linear, moved), kRowFraction);
    beyond_[0] += (then - now - along) * substep_rate_;
}

/// Of a held row; none where rigid ones relax. Angles are softened in the measure of the inertia
/// about the anchors: of that about a centre a long arm would hang as from a hinge.
std::int64_t JointConstraint::compliance(bool of_angle, bool biased) const {
    const std::int64_t rigid = biased && is_shared_ ? rigid_.compliance : 0;
    const std::int64_t of_place = held_is_soft_ ? spring_.softness.compliance : rigid;
    return of_angle ? round_exact(wide_product<Int128>(of_place, constants_.angle_part),
                                  kResponseFraction)
                    : of_place;
}

void JointConstraint::find_lacking(const SolverBodies& bodies,
                                   bool biased,
                                   std::int64_t lacking[kJointRowsMax]) const {
    const SolverBody& a = bodies.body(row_a_);
    const SolverBody& b = bodies.body(row_b_);
    for (int row = 0; row < block_.count(); ++row) {
        lacking[row] = -speed_of(rows_.row[row], a, b) - (biased ? beyond_[row] : 0);
        if (row >= rows_.held) {
            continue;
        }
        if (held_is_soft_) {
            lacking[row] -= scaled(held_stretch_[row] * substep_rate_, spring_.softness.bias_rate);
        } else if (biased) {
            lacking[row] -= std::clamp(
                scaled(rows_.offset[row] * substep_rate_, rigid_.bias_rate), -kPushMax, kPushMax);
        }
        lacking[row] -= bounded(round_exact(
            wide_product<Int128>(compliance(row < rows_.held_angles, biased), row_impulse_[row]),
            kResponseFraction));
    }
}

/// One side of a limit: `opening` is the speed at which `room` grows; impulses only push.
std::int64_t JointConstraint::press(std::int64_t room,
                                    std::int64_t opening,
                                    std::int64_t response,
                                    bool biased,
                                    std::int64_t& impulse) const {
    std::int64_t bias = room * substep_rate_; // met within the substep, if at all
    if (room < 0) {
        bias = biased ? std::max(scaled(bias, rigid_.bias_rate), -kPushMax) : 0;
    }
    const std::int64_t old = impulse;
    impulse = std::clamp(
        old + impulse_for(-(opening + bias), response), std::int64_t{0}, kJointImpulseMax);
    return impulse - old;
}

/// All that acts on a free axis, one after the other: they share its response. The impulse.
std::int64_t JointConstraint::solve_axis(int axis, std::int64_t speed, bool biased) {
    const JointKind kind = constants_.kind;
    const std::int64_t response = block_.response(axis, axis);
    const std::int64_t place = rows_.offset[rows_.held + axis];
    std::int64_t sum = 0;
    const auto now = [&] {
        return bounded(speed) +
               bounded(round_exact(wide_product<Int128>(response, sum), kResponseFraction));
    };
    if (axis == 0 && spring_.exists) {
        const JointSoftness& soft = spring_.softness;
        const std::int64_t wanted = now() + scaled(spring_.stretch * substep_rate_, soft.bias_rate);
        std::int64_t& impulse = axis_impulse_[kSpringPart];
        const std::int64_t old = impulse;
        impulse = held_in(scaled(old + impulse_for(-wanted, response), soft.mass_scale));
        sum += impulse - old;
    }
    const int motor_axis = kind == JointKind::wheel ? 1 : 0;
    if (axis == motor_axis && motor_.exists) {
        std::int64_t& impulse = axis_impulse_[kMotorPart];
        const std::int64_t old = impulse;
        impulse = std::clamp(old + impulse_for(motor_.speed - now(), response),
                             -motor_.impulse_max,
                             motor_.impulse_max);
        sum += impulse - old;
    }
    if (!limit_.exists) {
        return sum;
    }
    if (axis == 1) {
        if (kind == JointKind::cone_twist) {
            sum -= press(limit_.swing - place, -now(), response, biased, swing_impulse_);
        }
        return sum;
    }
    sum += press(place - limit_.low, now(), response, biased, axis_impulse_[kLowerPart]);
    sum -= press(limit_.high - place, -now(), response, biased, axis_impulse_[kUpperPart]);
    return sum;
}

void JointConstraint::pass(SolverBodies& bodies, bool biased) {
    std::int64_t rows[kJointRowsMax];
    find_lacking(bodies, biased, rows);
    block_.factor(rows_.held_angles, compliance(true, biased), compliance(false, biased));
    block_.eliminate(rows);
    std::int64_t first = 0;
    for (int axis = 0; axis < rows_.free; ++axis) {
        std::int64_t speed = -bounded(rows[rows_.held + axis]);
        if (axis == 1) {
            speed += bounded(
                round_exact(wide_product<Int128>(block_.response(1, 0), first), kResponseFraction));
        }
        rows[rows_.held + axis] = solve_axis(axis, speed, biased);
        first = rows[rows_.held];
    }
    block_.substitute(rows);
    std::int64_t old[kJointRowsMax];
    std::copy(row_impulse_, row_impulse_ + kJointRowsMax, old);
    for (int row = 0; row < rows_.held; ++row) {
        row_impulse_[row] = held_in(row_impulse_[row] + held_in(rows[row]));
    }
    if (constants_.kind == JointKind::grab) {
        limit_pull();
    }
    for (int row = 0; row < rows_.held; ++row) {
        rows[row] = row_impulse_[row] - old[row];
    }
    apply(bodies, rows);
}

/// A grab pulls no more than its motor may.
void JointConstraint::limit_pull() {
    const std::int64_t pull = size_of(row_impulse_);
    if (motor_.impulse_max == 0 || pull <= motor_.impulse_max) {
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        row_impulse_[axis] = multiply_divide(row_impulse_[axis], motor_.impulse_max, pull);
    }
}

void JointConstraint::apply(SolverBodies& bodies,
                            const std::int64_t impulses[kJointRowsMax]) const {
    std::int64_t push[3]; // Q.32 m/s
    Int128 spin_a[3];     // Q.62
    Int128 spin_b[3];
    for (int axis = 0; axis < 3; ++axis) {
        Int128 sum = 0;
        spin_a[axis] = 0;
        spin_b[axis] = 0;
        for (int row = 0; row < block_.count(); ++row) {
            const JointRow& j = rows_.row[row];
            const std::int64_t impulse = impulses[row];
            sum = raw_add(sum, wide_product<Int128>(j.linear[axis], impulse));
            spin_a[axis] = raw_add(spin_a[axis], wide_product<Int128>(j.response_a[axis], impulse));
            spin_b[axis] = raw_add(spin_b[axis], wide_product<Int128>(j.response_b[axis], impulse));
        }
        push[axis] = round_exact(sum, kRowFraction);
    }
    const auto give = [&](BodyRow row, std::int64_t share, const Int128 spin[3]) {
        if (share == 0) {
            return;
        }
        std::int64_t linear[3];
        std::int64_t angular[3];
        for (int axis = 0; axis < 3; ++axis) {
            linear[axis] = round_exact(wide_product<Int128>(push[axis], share), 52);
            angular[axis] = round_exact(spin[axis], 42);
        }
        bodies.give(row, linear, angular);
    };
    give(row_a_, -constants_.share_a, spin_a);
    give(row_b_, constants_.share_b, spin_b);
}

void JointConstraint::find_forces(std::int64_t forces[kJointRowsMax]) const {
    std::fill(forces, forces + kJointRowsMax, 0);
    if (held_is_soft_) {
        std::copy(row_impulse_, row_impulse_ + rows_.held, forces);
    }
    if (rows_.free > 0) {
        const int motor_axis = constants_.kind == JointKind::wheel ? 1 : 0;
        forces[rows_.held] += axis_impulse_[kSpringPart];
        forces[rows_.held + motor_axis] += axis_impulse_[kMotorPart];
    }
}

void JointConstraint::find_holding(std::int64_t holding[kJointRowsMax]) const {
    std::fill(holding, holding + kJointRowsMax, 0);
    if (!held_is_soft_) {
        std::copy(row_impulse_, row_impulse_ + rows_.held, holding);
    }
    if (rows_.free > 0) {
        holding[rows_.held] += axis_impulse_[kLowerPart] - axis_impulse_[kUpperPart];
    }
    if (constants_.kind == JointKind::cone_twist) {
        holding[rows_.held + 1] = -swing_impulse_;
    }
}

void JointConstraint::find_sum(std::int64_t sum[kJointRowsMax]) const {
    std::int64_t holding[kJointRowsMax];
    find_forces(sum);
    find_holding(holding);
    for (int row = 0; row < kJointRowsMax; ++row) {
        sum[row] += holding[row];
    }
}

void JointConstraint::push(SolverBodies& bodies) const {
    std::int64_t forces[kJointRowsMax];
    find_forces(forces);
    apply(bodies, forces);
}

void JointConstraint::hold(SolverBodies& bodies) const {
    std::int64_t holding[kJointRowsMax];
    find_holding(holding);
    apply(bodies, holding);
}

Int128 JointConstraint::work_of_holding(const SolverBodies& bodies) const {
    const SolverBody& a = bodies.body(row_a_);
    const SolverBody& b = bodies.body(row_b_);
    std::int64_t holding[kJointRowsMax];
    find_holding(holding);
    Int128 work = 0; // Q.64 m^2/s^2: lambda_hat x speed
    for (int row = 0; row < block_.count(); ++row) {
        const std::int64_t bend = row < rows_.held ? beyond_[row] : 0;
        work = raw_add(work,
                       wide_product<Int128>(holding[row], speed_of(rows_.row[row], a, b) + bend));
    }
    return wide_product<Int128>(round_exact(work, 48), reduced_mass_);
}

void JointConstraint::keep(SolverBodies& bodies, std::int64_t factor) {
    constexpr std::int64_t kWhole = std::int64_t{1} << 30;
    if (factor == kWhole) {
        return;
    }
    const auto part = [&](std::int64_t& impulse) {
        impulse = round_exact(wide_product<Int128>(impulse, factor), 30);
    };
    std::int64_t before[kJointRowsMax];
    std::int64_t after[kJointRowsMax];
    find_holding(before);
    if (!held_is_soft_) {
        std::for_each(row_impulse_, row_impulse_ + rows_.held, part);
    }
    part(axis_impulse_[kLowerPart]);
    part(axis_impulse_[kUpperPart]);
    part(swing_impulse_);
    find_holding(after);
    for (int row = 0; row < kJointRowsMax; ++row) {
        after[row] -= before[row];
    }
    apply(bodies, after);
}

void JointConstraint::solve(SolverBodies& bodies) {
    // Springs act on what they were stretched when the substep began, in both passes.
    std::copy(rows_.offset, rows_.offset + kJointRowsMax, held_stretch_);
    if (rows_.free > 0) {
        spring_.stretch = rows_.offset[rows_.held] - spring_.rest;
    }
    pass(bodies, true);
}

void JointConstraint::relax(SolverBodies& bodies) {
    pass(bodies, false);
}

void JointConstraint::note_load() {
    if (!can_break_) {
        return;
    }
    std::int64_t sum[kJointRowsMax];
    find_sum(sum);
    for (int axis = 0; axis < 3; ++axis) {
        Int128 force = 0;
        Int128 torque = 0;
        for (int row = 0; row < block_.count(); ++row) {
            force = raw_add(force, wide_product<Int128>(rows_.row[row].linear[axis], sum[row]));
            torque = raw_add(torque, wide_product<Int128>(rows_.row[row].axis[axis], sum[row]));
        }
        force_sum_[axis] += round_exact(force, kRowFraction);
        torque_sum_[axis] += round_exact(torque, kRowFraction);
    }
}

bool JointConstraint::is_broken(const StepConstants& constants, const Joint& joint) const {
    // The impulse of the tick against that of the limit.
    const auto exceeds = [&](std::int64_t load, std::int64_t limit, bool is_torque) {
        return limit > 0 && load > impulse_of(limit, is_torque) * std::int64_t{constants.substeps};
    };
    return exceeds(size_of(force_sum_), joint.break_force, false) ||
           exceeds(size_of(torque_sum_), joint.break_torque, true);
}

void JointConstraint::write(Joint& joint) const {
    std::copy(row_impulse_, row_impulse_ + kJointRowsMax, joint.row_impulse);
    std::copy(axis_impulse_, axis_impulse_ + 4, joint.axis_impulse);
    joint.swing_impulse = swing_impulse_;
}

} // namespace lockwind
