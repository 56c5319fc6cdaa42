#include "dynamics/make_joint.h"

#include "dynamics/definition_checker.h"
#include "dynamics/joint_block.h"
#include "dynamics/make_body.h"

#include "lockwind/trig.h"
#include "lockwind/wide.h"

#include <algorithm>
#include <cstdlib>
#include <span>

namespace lockwind {

namespace {

using SpringHertz = Fixed<std::int32_t, 16>;

constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);

bool is_dynamic(const DynamicsTables& tables, BodyRow row) {
    return row < tables.properties.count() && tables.properties[row].mode == kDynamic;
}

/// Which of a definition's parts a kind has.
struct KindParts {
    bool limit;
    bool motor;
    bool spring;
};

KindParts parts_of(JointKind kind) {
    switch (kind) {
    case JointKind::ball:
        return {false, false, false};
    case JointKind::distance:
        return {true, false, true};
    case JointKind::hinge:
    case JointKind::slider:
    case JointKind::wheel:
        return {true, true, true};
    case JointKind::fixed:
        return {false, false, true};
    case JointKind::cone_twist:
        return {true, false, false};
    case JointKind::grab:
        return {false, false, true};
    }
    return {false, false, false};
}

bool limits_length(JointKind kind) {
    return kind == JointKind::distance || kind == JointKind::slider || kind == JointKind::wheel;
}

/// In gyration radii; of a body that is not dynamic nothing is multiplied by it.
bool is_long(const BodyProperties& body, const std::int32_t anchor[3]) {
    if (body.mode != kDynamic) {
        return false;
    }
    const std::int64_t longest = kJointLeverMax * std::max(body.gyration_radius, 1);
    std::uint64_t square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        square += static_cast<std::uint64_t>(std::int64_t{anchor[axis]} * anchor[axis]);
    }
    return UInt128{0, square} >
           multiply_wide(static_cast<std::uint64_t>(longest), static_cast<std::uint64_t>(longest));
}

void check_bodies(const JointDefinition& definition,
                  const DynamicsTables& tables,
                  BodyRow row_a,
                  BodyRow row_b,
                  DefinitionChecker& checker) {
    const bool is_grab = definition.kind == JointKind::grab;
    checker.require(is_grab || row_a != kNoIndex, "body_a", "is no body of the world");
    checker.require(!is_grab || definition.body_a == 0,
                    "body_a",
                    "is given; a grab holds body_b alone, from a place");
    checker.require(row_b != kNoIndex, "body_b", "is no body of the world");
    checker.require(row_a != row_b, "body_b", "is body_a; a joint joins two bodies");
    checker.require(is_dynamic(tables, row_a) || is_dynamic(tables, row_b),
                    "body_b",
                    is_grab ? "is not dynamic" : "and body_a are not dynamic; one must be");
}

void check_limits(const JointDefinition& definition, DefinitionChecker& checker) {
    if (definition.kind == JointKind::distance) {
        checker.require(definition.has_limit || definition.has_spring,
                        "has_limit",
                        "and has_spring are false; the distance is then held by nothing");
    }
    if (!definition.has_limit) {
        return;
    }
    if (limits_length(definition.kind)) {
        const Real least = definition.kind == JointKind::distance ? Real(0) : -kJointLengthMax;
        checker.range("length_min", definition.length_min, least, kJointLengthMax, " m");
        checker.range(
            "length_max", definition.length_max, definition.length_min, kJointLengthMax, " m");
        return;
    }
    checker.range("angle_min", definition.angle_min, -kPi, kPi, " rad");
    checker.range("angle_max", definition.angle_max, definition.angle_min, kPi, " rad");
    if (definition.kind == JointKind::cone_twist) {
        checker.range("swing_max", definition.swing_max, 0, kPi, " rad");
    }
}

void check_drives(const JointDefinition& definition, DefinitionChecker& checker) {
    const KindParts parts = parts_of(definition.kind);
    checker.require(!definition.has_limit || parts.limit, "has_limit", "is not for this kind");
    checker.require(!definition.has_motor || parts.motor, "has_motor", "is not for this kind");
    checker.require(!definition.has_spring || parts.spring, "has_spring", "is not for this kind");
    checker.range("motor_speed",
                  definition.motor_speed,
                  -kJointMotorSpeedMax,
                  kJointMotorSpeedMax,
                  " m/s or rad/s");
    checker.range("motor_max", definition.motor_max, 0, kJointForceMax, " N or N m");
    checker.range("spring_hertz", definition.spring_hertz, kJointHertzMin, kJointHertzMax, " Hz");
    checker.range("spring_damping", definition.spring_damping, 0, kJointDampingMax, "");
    checker.range("rest_length", definition.rest_length, -kJointLengthMax, kJointLengthMax, " m");
    checker.range("rest_angle", definition.rest_angle, -kPi, kPi, " rad");
    checker.range("break_force", definition.break_force, 0, kJointForceMax, " N");
    checker.range("break_torque", definition.break_torque, 0, kJointForceMax, " N m");
}

void check_definition(const JointDefinition& definition, DefinitionChecker& checker) {
    constexpr JointId kIdMax = 0xffffffffU;
    const auto is_zero = [](const RealQuat& q) {
        return q.x == 0 && q.y == 0 && q.z == 0 && q.w == 0;
    };
    checker.require(definition.id >= 1 && definition.id <= kIdMax,
                    "id",
                    "is out of range; it must be within 1 .. 4294967295");
    checker.require(definition.kind <= JointKind::grab, "kind", "is unknown");
    checker.vector_range("anchor_a", definition.anchor_a, kJointAnchorMax, " m");
    checker.vector_range("anchor_b", definition.anchor_b, kJointAnchorMax, " m");
    checker.vector_range("target", definition.target, kBodyPositionMax, " m");
    checker.require(!is_zero(definition.frame_a), "frame_a", "is 0; it must be a rotation");
    checker.require(!is_zero(definition.frame_b), "frame_b", "is 0; it must be a rotation");
    check_limits(definition, checker);
    check_drives(definition, checker);
}

void fill_frame(const RealQuat& rotation, std::int32_t frame[4]) {
    const RealQuat unit = normalized(rotation);
    const Real components[4] = {unit.x, unit.y, unit.z, unit.w};
    for (int index = 0; index < 4; ++index) {
        frame[index] = convert<Unit>(components[index]).raw();
    }
}

void fill_anchor(const Vec3& anchor, std::int32_t out[3]) {
    out[0] = convert<Length>(anchor.x).raw();
    out[1] = convert<Length>(anchor.y).raw();
    out[2] = convert<Length>(anchor.z).raw();
}

/// Those that the kind has, as check_limits has checked them.
void fill_limits(const JointDefinition& definition, Joint& joint) {
    if (!definition.has_limit) {
        return;
    }
    if (limits_length(definition.kind)) {
        joint.length_limit[0] = convert<Length>(definition.length_min).raw();
        joint.length_limit[1] = convert<Length>(definition.length_max).raw();
        return;
    }
    joint.angle_limit[0] = convert<Coefficient>(definition.angle_min).raw();
    joint.angle_limit[1] = convert<Coefficient>(definition.angle_max).raw();
    if (definition.kind == JointKind::cone_twist) {
        joint.swing_limit = convert<Coefficient>(definition.swing_max).raw();
    }
}

void fill_drives(const JointDefinition& definition, Joint& joint) {
    joint.has_limit = definition.has_limit ? 1 : 0;
    joint.has_motor = definition.has_motor ? 1 : 0;
    joint.has_spring = definition.has_spring || definition.kind == JointKind::grab ? 1 : 0;
    joint.collide_connected = definition.collide_connected ? 1 : 0;
    fill_limits(definition, joint);
    joint.motor_speed = convert<Velocity>(definition.motor_speed).raw();
    joint.motor_limit = definition.motor_max.raw();
    joint.spring_hertz = convert<SpringHertz>(definition.spring_hertz).raw();
    joint.spring_damping = convert<Velocity>(definition.spring_damping).raw();
    joint.rest_length = convert<Length>(definition.rest_length).raw();
    joint.rest_angle = convert<Coefficient>(definition.rest_angle).raw();
    joint.break_force = definition.break_force.raw();
    joint.break_torque = definition.break_torque.raw();
}

bool is_unit(const std::int32_t (&quaternion)[4]) {
    constexpr std::int64_t kSquare = std::int64_t{1} << 60;
    constexpr std::int64_t kTolerance = std::int64_t{1} << 42;
    std::int64_t square = 0;
    for (const std::int32_t component : quaternion) {
        if (std::abs(std::int64_t{component}) > (std::int64_t{1} << 30) + (1 << 14)) {
            return false;
        }
        square += std::int64_t{component} * component;
    }
    return std::abs(square - kSquare) <= kTolerance;
}

template <class T>
bool all_within(std::span<const T> values, std::int64_t low, std::int64_t high) {
    return std::all_of(
        values.begin(), values.end(), [&](T value) { return value >= low && value <= high; });
}

const char* bad_joint_bodies(const DynamicsTables& tables, const Joint& joint) {
    const std::uint32_t count = tables.motion.count();
    const bool is_grab = joint.kind == static_cast<std::uint8_t>(JointKind::grab);
    if (is_grab ? joint.row_a != kNoIndex : joint.row_a >= count) {
        return "row_a";
    }
    if (joint.row_b >= count || joint.row_b == joint.row_a) {
        return "row_b";
    }
    constexpr std::int64_t kAnchorMax = convert<Length>(kJointAnchorMax).raw();
    if (!all_within<std::int32_t>(joint.anchor_a, -kAnchorMax, kAnchorMax)) {
        return "anchor_a";
    }
    if (!all_within<std::int32_t>(joint.anchor_b, -kAnchorMax, kAnchorMax)) {
        return "anchor_b";
    }
    const BodyProperties* a = is_grab ? nullptr : &tables.properties[joint.row_a];
    if (const char* field = bad_joint_side(joint, a, tables.properties[joint.row_b]);
        field != nullptr) {
        return field;
    }
    if (!is_unit(joint.frame_a)) {
        return "frame_a";
    }
    return is_unit(joint.frame_b) ? nullptr : "frame_b";
}

const char* bad_joint_numbers(const Joint& joint) {
    constexpr std::int64_t kLength = convert<Length>(kJointLengthMax).raw();
    constexpr std::int64_t kAngle = convert<Coefficient>(kPi).raw();
    constexpr std::int64_t kForce = kJointForceMax.raw();
    constexpr std::int64_t kPlace = kBodyPositionMax.raw();
    constexpr std::int64_t kSpeed = convert<Velocity>(kJointMotorSpeedMax).raw();
    const std::int64_t shortest =
        joint.kind == static_cast<std::uint8_t>(JointKind::distance) ? 0 : -kLength;
    const struct {
        const char* field;
        bool is_good;
    } checks[] = {
        {"target", all_within<std::int64_t>(joint.target, -kPlace, kPlace)},
        {"motor_limit", joint.motor_limit >= 0 && joint.motor_limit <= kForce},
        {"break_force", joint.break_force >= 0 && joint.break_force <= kForce},
        {"break_torque", joint.break_torque >= 0 && joint.break_torque <= kForce},
        {"row_impulse",
         all_within<std::int64_t>(joint.row_impulse, -kJointImpulseMax, kJointImpulseMax)},
        {"axis_impulse",
         all_within<std::int64_t>(joint.axis_impulse, -kJointImpulseMax, kJointImpulseMax) &&
             joint.axis_impulse[2] >= 0 && joint.axis_impulse[3] >= 0},
        {"swing_impulse", joint.swing_impulse >= 0 && joint.swing_impulse <= kJointImpulseMax},
        {"length_limit",
         all_within<std::int32_t>(joint.length_limit, shortest, kLength) &&
             joint.length_limit[0] <= joint.length_limit[1]},
        {"angle_limit",
         all_within<std::int32_t>(joint.angle_limit, -kAngle, kAngle) &&
             joint.angle_limit[0] <= joint.angle_limit[1]},
        {"swing_limit", joint.swing_limit >= 0 && joint.swing_limit <= kAngle},
        {"rest_length", std::abs(std::int64_t{joint.rest_length}) <= kLength},
        {"rest_angle", std::abs(std::int64_t{joint.rest_angle}) <= kAngle},
        {"motor_speed", std::abs(std::int64_t{joint.motor_speed}) <= kSpeed},
        {"spring_hertz",
         joint.spring_hertz >= convert<SpringHertz>(kJointHertzMin).raw() &&
             joint.spring_hertz <= convert<SpringHertz>(kJointHertzMax).raw()},
        {"spring_damping",
         joint.spring_damping >= 0 &&
             joint.spring_damping <= convert<Velocity>(kJointDampingMax).raw()},
    };
    for (const auto& check : checks) {
        if (!check.is_good) {
            return check.field;
        }
    }
    return nullptr;
}

} // namespace

Status make_joint(const JointDefinition& definition,
                  const DynamicsTables& tables,
                  const ShapeLibrary& shapes,
                  BodyRow row_a,
                  BodyRow row_b,
                  Joint& joint) {
    DefinitionChecker checker("joint", definition.id);
    check_definition(definition, checker);
    if (!checker.failed()) {
        check_bodies(definition, tables, row_a, row_b, checker);
    }
    if (checker.failed()) {
        return checker.error();
    }
    Joint made{};
    made.id = definition.id;
    made.kind = static_cast<std::uint8_t>(definition.kind);
    made.row_a = row_a;
    made.row_b = row_b;
    made.target[0] = definition.target.x.raw();
    made.target[1] = definition.target.y.raw();
    made.target[2] = definition.target.z.raw();
    fill_drives(definition, made);
    const auto fill_side = [&](BodyRow row,
                               const char* name,
                               const Vec3& anchor,
                               const RealQuat& frame,
                               std::int32_t made_anchor[3],
                               std::int32_t made_frame[4]) {
        const BodyProperties& body = tables.properties[row];
        const Vec3 arm = to_principal_frame(anchor, body, shapes);
        checker.vector_range(name, arm, kJointAnchorMax, " m");
        fill_anchor(arm, made_anchor);
        fill_frame(turn_to_given_frame(body, shapes) * frame, made_frame);
        checker.require(!is_long(body, made_anchor),
                        name,
                        "is more than 1000 gyration radii of its body away from its centre");
    };
    if (definition.kind == JointKind::grab) {
        fill_anchor(definition.anchor_a, made.anchor_a);
        fill_frame(definition.frame_a, made.frame_a);
    } else {
        fill_side(row_a,
                  "anchor_a",
                  definition.anchor_a,
                  definition.frame_a,
                  made.anchor_a,
                  made.frame_a);
    }
    fill_side(
        row_b, "anchor_b", definition.anchor_b, definition.frame_b, made.anchor_b, made.frame_b);
    if (checker.failed()) {
        return checker.error();
    }
    joint = made;
    return Success{};
}

const char* bad_joint_side(const Joint& joint, const BodyProperties* a, const BodyProperties& b) {
    if ((a == nullptr || a->mode != kDynamic) && b.mode != kDynamic) {
        return "row_b";
    }
    if (a != nullptr && is_long(*a, joint.anchor_a)) {
        return "anchor_a";
    }
    return is_long(b, joint.anchor_b) ? "anchor_b" : nullptr;
}

const char* bad_joint_field(const DynamicsTables& tables, const Joint& joint) {
    if (joint.kind > static_cast<std::uint8_t>(JointKind::grab)) {
        return "kind";
    }
    const KindParts parts = parts_of(static_cast<JointKind>(joint.kind));
    if (joint.has_limit > (parts.limit ? 1 : 0)) {
        return "has_limit";
    }
    if (joint.has_motor > (parts.motor ? 1 : 0)) {
        return "has_motor";
    }
    if (joint.has_spring > (parts.spring ? 1 : 0)) {
        return "has_spring";
    }
    if (joint.collide_connected > 1) {
        return "collide_connected";
    }
    if (const char* field = bad_joint_bodies(tables, joint); field != nullptr) {
        return field;
    }
    if (const char* field = bad_joint_numbers(joint); field != nullptr) {
        return field;
    }
    return std::all_of(joint.zero, joint.zero + 3, [](std::uint8_t byte) { return byte == 0; })
               ? nullptr
               : "zero";
}

} // namespace lockwind
