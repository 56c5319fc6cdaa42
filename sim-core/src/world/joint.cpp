#include "dynamics/make_body.h"
#include "dynamics/make_joint.h"
#include "world/impl.h"

#include <algorithm>
#include <string>

namespace lockwind {

namespace {

/// Row of the first joint whose id is not below `id`.
std::uint32_t place_of(const Table<Joint>& joints, JointId id) {
    const std::span<Joint> rows = joints.rows();
    const auto place =
        std::lower_bound(rows.begin(), rows.end(), id, [](const Joint& joint, JointId wanted) {
            return joint.id < wanted;
        });
    return static_cast<std::uint32_t>(place - rows.begin());
}

/// Null where there is none.
Joint* find_joint(const Table<Joint>& joints, JointId id) {
    const std::uint32_t row = place_of(joints, id);
    return row < joints.count() && joints[row].id == id ? &joints[row] : nullptr;
}

} // namespace

void World::Impl::touch_joints() {
    for (const std::uint32_t section : {section::kArena, section::kJoint, section::kBodySleep}) {
        versions.touch(section);
    }
}

Status World::create_joint(const JointDefinition& definition) {
    const DynamicsTables tables = impl_->tables();
    const std::string subject = "joint " + std::to_string(definition.id) + ": ";
    if (find_joint(tables.joints, definition.id) != nullptr) {
        return Error{subject + "id is used already"};
    }
    Joint joint{};
    if (Status made = make_joint(definition,
                                 tables,
                                 impl_->shapes,
                                 row_of(tables.motion, definition.body_a),
                                 row_of(tables.motion, definition.body_b),
                                 joint);
        !made) {
        return made;
    }
    const std::uint32_t count = tables.joints.count();
    if (count == tables.joints.capacity()) {
        return Error{subject + "settings.joint_capacity of " + std::to_string(count) + " is full"};
    }
    tables.joints.set_count(count + 1);
    std::uint32_t row = count;
    for (; row > 0 && tables.joints[row - 1].id > joint.id; --row) {
        tables.joints[row] = tables.joints[row - 1];
    }
    tables.joints[row] = joint;
    impl_->touch_joints();
    wake_joined(tables, joint);
    return Success{};
}

bool World::destroy_joint(JointId id) {
    const DynamicsTables tables = impl_->tables();
    const Table<Joint>& joints = tables.joints;
    const Joint* joint = find_joint(joints, id);
    if (joint == nullptr) {
        return false;
    }
    impl_->touch_joints();
    wake_joined(tables, *joint);
    for (std::uint32_t row = place_of(joints, id); row + 1 < joints.count(); ++row) {
        joints[row] = joints[row + 1];
    }
    joints.set_count(joints.count() - 1);
    return true;
}

std::optional<JointView> World::joint(JointId id) const {
    const DynamicsTables tables = impl_->tables();
    const Joint* joint = find_joint(tables.joints, id);
    if (joint == nullptr) {
        return std::nullopt;
    }
    return JointView{joint->id,
                     static_cast<JointKind>(joint->kind),
                     joint->row_a == kNoIndex ? 0 : tables.motion[joint->row_a].id,
                     tables.motion[joint->row_b].id,
                     convert<Real>(Velocity::from_raw(joint->motor_speed)),
                     {Real::from_raw(joint->target[0]),
                      Real::from_raw(joint->target[1]),
                      Real::from_raw(joint->target[2])}};
}

bool World::set_joint_target(JointId id, const Vec3& target) {
    Joint* joint = find_joint(impl_->tables().joints, id);
    if (joint == nullptr || joint->kind != static_cast<std::uint8_t>(JointKind::grab)) {
        return false;
    }
    const Real components[3] = {target.x, target.y, target.z};
    for (int axis = 0; axis < 3; ++axis) {
        joint->target[axis] =
            std::clamp(components[axis], -kBodyPositionMax, kBodyPositionMax).raw();
    }
    impl_->touch_joints();
    wake_joined(impl_->tables(), *joint);
    return true;
}

bool World::set_joint_motor(JointId id, Real speed) {
    Joint* joint = find_joint(impl_->tables().joints, id);
    if (joint == nullptr || joint->has_motor == 0) {
        return false;
    }
    joint->motor_speed =
        convert<Velocity>(std::clamp(speed, -kJointMotorSpeedMax, kJointMotorSpeedMax)).raw();
    impl_->touch_joints();
    wake_joined(impl_->tables(), *joint);
    return true;
}

} // namespace lockwind
