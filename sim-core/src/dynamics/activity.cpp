#include "dynamics/activity.h"

#include "lockwind/world_definition.h"

#include <algorithm>

namespace lockwind {

Activity::Activity(const DynamicsSettings& capacities) : part_(capacities.body_capacity) {
    rows_.reserve(capacities.body_capacity);
    partners_.reserve(capacities.body_capacity);
    pairs_.reserve(capacities.pair_capacity);
    joints_.reserve(capacities.joint_capacity);
}

void Activity::begin(std::uint32_t row_count) {
    rows_.clear();
    partners_.clear();
    pairs_.clear();
    joints_.clear();
    row_count_ = row_count;
    std::fill_n(part_.begin(), row_count, Part::none);
}

bool Activity::is_dynamic(const DynamicsTables& tables, BodyRow row) {
    return tables.properties[row].mode == static_cast<std::uint8_t>(BodyMode::dynamic);
}

void Activity::read_rows(const Table<BodySleep>& sleep) {
    begin(sleep.count());
    for (BodyRow row = 0; row < row_count_; ++row) {
        if (lockwind::is_awake(sleep[row])) {
            part_[row] = Part::awake;
            rows_.push_back(row);
        }
    }
}

void Activity::add_partner(BodyRow row) {
    if (part_[row] == Part::none) {
        part_[row] = Part::partner;
        partners_.push_back(row);
    }
}

void Activity::read_pairs(const Table<Pair>& pairs) {
    if (rows_.empty()) {
        return;
    }
    const std::uint32_t count = pairs.count();
    for (std::uint32_t index = 0; index < count; ++index) {
        const Pair& pair = pairs[index];
        // Damaged rows must not lead outside.
        if (pair.row_a >= pair.row_b || pair.row_b >= row_count_) {
            continue;
        }
        const bool a_is_awake = is_awake(pair.row_a);
        const bool b_is_awake = is_awake(pair.row_b);
        if (!a_is_awake && !b_is_awake) {
            continue;
        }
        pairs_.push_back(index);
        if (!a_is_awake) {
            add_partner(pair.row_a);
        }
        if (!b_is_awake) {
            add_partner(pair.row_b);
        }
    }
}

void Activity::read_joints(const Table<Joint>& joints) {
    joints_.clear();
    const std::uint32_t count = joints.count();
    for (std::uint32_t index = 0; index < count; ++index) {
        const Joint& joint = joints[index];
        const bool has_a = joint.row_a != kNoIndex;
        // Damaged rows must not lead outside.
        if (joint.row_b >= row_count_ || (has_a && joint.row_a >= row_count_)) {
            continue;
        }
        if (is_awake(joint.row_b) || (has_a && is_awake(joint.row_a))) {
            joints_.push_back(index);
            add_partner(joint.row_b);
            if (has_a) {
                add_partner(joint.row_a);
            }
        }
    }
}

} // namespace lockwind
