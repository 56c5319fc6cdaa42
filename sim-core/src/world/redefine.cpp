#include "dynamics/make_body.h"
#include "dynamics/make_joint.h"
#include "world/impl.h"

#include <algorithm>
#include <string>

namespace lockwind {

namespace {

bool has_shape(const BodyProperties& a, const BodyProperties& b) {
    return a.shape == b.shape && a.shape_index == b.shape_index &&
           std::equal(a.size, a.size + 3, b.size);
}

/// Null, or a joint that the body could not have with these properties.
const Joint*
bad_joint(const DynamicsTables& tables, BodyRow row, const BodyProperties& properties) {
    const auto side = [&](BodyRow other) -> const BodyProperties* {
        return other == kNoIndex ? nullptr : other == row ? &properties : &tables.properties[other];
    };
    for (const Joint& joint : tables.joints.rows()) {
        if ((joint.row_a == row || joint.row_b == row) &&
            bad_joint_side(joint, side(joint.row_a), *side(joint.row_b)) != nullptr) {
            return &joint;
        }
    }
    return nullptr;
}

} // namespace

Status World::redefine_body(const BodyDefinition& definition) {
    const DynamicsTables tables = impl_->tables();
    const std::string subject = "body " + std::to_string(definition.id) + ": ";
    const BodyRow row = row_of(tables.motion, definition.id);
    if (row == kNoIndex) {
        return Error{subject + "is no body of the world"};
    }
    if (slot_of(impl_->players(), definition.id) != kNoIndex) {
        return Error{subject + "is a player's pod"};
    }
    BodyRecord made{};
    if (Status status =
            make_body(definition, impl_->settings, impl_->shapes, made.motion, made.properties);
        !status) {
        return status;
    }
    if (!has_shape(tables.properties[row], made.properties)) {
        return Error{subject + "shape is another; it stays as the body was created with"};
    }
    if (definition.mode != BodyMode::fixed && is_outside(made.motion, impl_->settings.bounds)) {
        return Error{subject + "position lies outside of settings.bounds"};
    }
    if (const Joint* joint = bad_joint(tables, row, made.properties); joint != nullptr) {
        return Error{subject + "joint " + std::to_string(joint->id) +
                     " cannot hold it then: " + "one of its bodies must be dynamic"};
    }
    impl_->versions.touch_all();
    tables.motion[row] = made.motion;
    impl_->spawner.redefine(tables, row, made.properties);
    impl_->query_index.drop();
    drop_contacts(tables, row);
    tables.sleep[row] = BodySleep{};
    for (const Joint& joint : tables.joints.rows()) {
        if (joint.row_a == row || joint.row_b == row) {
            wake_joined(tables, joint);
        }
    }
    return Success{};
}

} // namespace lockwind
