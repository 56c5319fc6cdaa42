#include "dynamics/sleep.h"

#include "dynamics/pairing.h"
#include "dynamics/solver_format.h"

#include "lockwind/integer.h"
#include "lockwind/wide.h"
#include "lockwind/world_definition.h"

#include <algorithm>
#include <limits>
#include <span>

namespace lockwind {

namespace {

constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);
constexpr auto kFixed = static_cast<std::uint8_t>(BodyMode::fixed);
constexpr std::uint16_t kStillTicksMax = std::numeric_limits<std::uint16_t>::max();

bool is_zero(const std::int32_t vector[3]) {
    return (vector[0] | vector[1] | vector[2]) == 0;
}

/// Whether a vector is at most as long as `longest`.
bool is_within(const std::int64_t vector[3], std::int64_t longest) {
    std::int64_t square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (magnitude(vector[axis]) > longest) {
            return false;
        }
        square += vector[axis] * vector[axis];
    }
    return square <= longest * longest;
}

bool is_dynamic(const DynamicsTables& tables, BodyRow row) {
    return tables.properties[row].mode == kDynamic;
}

/// Whether the body wakes with its island: dynamic, or a kinematic one that has frozen with it.
bool is_member(const DynamicsTables& tables, BodyRow row) {
    return is_dynamic(tables, row) || level_of(tables.sleep[row]) == BodyLevel::frozen;
}

/// Whether the pair holds two of an island together.
bool is_bond(const Pair& pair, const DynamicsTables& tables) {
    return is_pressing(pair, tables) && is_member(tables, pair.row_a) &&
           is_member(tables, pair.row_b);
}

/// Where one of the two is a kinematic body that moves.
void keep_awake_if_carried(const DynamicsTables& tables, BodyRow a, BodyRow b) {
    const auto carries = [&](BodyRow row) {
        return !is_dynamic(tables, row) && is_awake(tables.sleep[row]);
    };
    if (carries(a)) {
        tables.sleep[b].still_ticks = 0;
    }
    if (carries(b)) {
        tables.sleep[a].still_ticks = 0;
    }
}

/// Whether the joint holds two of an island together. Damaged rows must not lead outside.
bool is_bond(const Joint& joint, const DynamicsTables& tables) {
    const std::uint32_t count = tables.properties.count();
    return joint.row_a < count && joint.row_b < count && is_member(tables, joint.row_a) &&
           is_member(tables, joint.row_b);
}

bool is_woken_by(BodyRow row,
                 BodyRow other,
                 const DynamicsTables& tables,
                 const Activity& activity) {
    return is_member(tables, row) && !activity.is_awake(row) && activity.is_awake(other);
}

} // namespace

Sleep::Sleep(const DynamicsSettings& settings)
    : speed_max_(convert<Velocity>(settings.sleep_speed).raw()),
      sleep_ticks_(static_cast<std::uint16_t>(
          std::min<std::uint32_t>(settings.sleep_ticks, kStillTicksMax))),
      islands_(settings.body_capacity), is_marked_(settings.body_capacity) {
    rows_.reserve(settings.body_capacity);
    changes_.reserve(2 * std::size_t{settings.body_capacity});
}

bool Sleep::wake(const DynamicsTables& tables, const Activity& activity) {
    rows_.clear();
    const std::span<const BodyRow> touched = activity.partners();
    const bool may_wake = std::any_of(
        touched.begin(), touched.end(), [&](BodyRow row) { return is_member(tables, row); });
    if (!may_wake) {
        return false;
    }
    for (const std::uint32_t index : activity.pairs()) {
        const Pair& pair = tables.pairs[index];
        if (!is_pressing(pair, tables)) {
            continue;
        }
        find_woken(pair.row_a, pair.row_b, tables, activity);
    }
    for (const std::uint32_t index : activity.joints()) {
        const Joint& joint = tables.joints[index];
        if (joint.row_a != kNoIndex) {
            find_woken(joint.row_a, joint.row_b, tables, activity);
        }
    }
    if (rows_.empty()) {
        return false;
    }
    join_sleepers(tables, activity);
    for (BodyRow row = 0; row < tables.motion.count(); ++row) {
        const bool rests = !activity.is_awake(row) && is_member(tables, row);
        if (rests && is_marked_[islands_.find(row)] != 0) {
            if (level_of(tables.sleep[row]) == BodyLevel::asleep) {
                changes_.push_back({row, false});
            }
            wake_body(tables, row);
        }
    }
    return true;
}

/// Adds the one of the two that the other wakes to rows_.
void Sleep::find_woken(BodyRow a,
                       BodyRow b,
                       const DynamicsTables& tables,
                       const Activity& activity) {
    if (is_woken_by(a, b, tables, activity)) {
        rows_.push_back(a);
    } else if (is_woken_by(b, a, tables, activity)) {
        rows_.push_back(b);
    }
}

/// Islands of all that sleep; marks those of rows_.
void Sleep::join_sleepers(const DynamicsTables& tables, const Activity& activity) {
    const std::uint32_t count = tables.motion.count();
    for (BodyRow row = 0; row < count; ++row) {
        islands_.begin(row);
        is_marked_[row] = 0;
    }
    for (const Pair& pair : tables.pairs.rows()) {
        if (pair.row_a < pair.row_b && pair.row_b < count && is_bond(pair, tables) &&
            !activity.is_awake(pair.row_a) && !activity.is_awake(pair.row_b)) {
            islands_.join(pair.row_a, pair.row_b);
        }
    }
    for (const Joint& joint : tables.joints.rows()) {
        if (is_bond(joint, tables) && !activity.is_awake(joint.row_a) &&
            !activity.is_awake(joint.row_b)) {
            islands_.join(joint.row_a, joint.row_b);
        }
    }
    for (const BodyRow row : rows_) {
        is_marked_[islands_.find(row)] = 1;
    }
}

void Sleep::fall_asleep(const DynamicsTables& tables, const Activity& activity) {
    rows_.clear();
    bool is_due = count_still_ticks(tables, activity.rows());
    if (!is_due || sleep_ticks_ == 0) {
        return;
    }
    keep_carried_awake(tables, activity);
    join_awake(tables, activity);
    for (const BodyRow row : rows_) {
        BodySleep& sleep = tables.sleep[row];
        if (is_marked_[islands_.find(row)] == 0) {
            BodyMotion& motion = tables.motion[row];
            std::fill_n(motion.linear_velocity, 3, 0);
            std::fill_n(motion.angular_velocity, 3, 0);
            set_level(sleep, BodyLevel::asleep);
            changes_.push_back({row, true});
        }
    }
}

/// Lists the dynamic rows; true where one of them has been slow for long enough.
bool Sleep::count_still_ticks(const DynamicsTables& tables, std::span<const BodyRow> rows) {
    bool is_due = false;
    for (const BodyRow row : rows) {
        const BodyMotion& motion = tables.motion[row];
        const BodyProperties& body = tables.properties[row];
        BodySleep& sleep = tables.sleep[row];
        if (body.mode == kDynamic) {
            rows_.push_back(row);
            const bool still = is_slow(motion, body);
            sleep.still_ticks = static_cast<std::uint16_t>(
                still ? std::min(sleep.still_ticks + 1, int{kStillTicksMax}) : 0);
            is_due = is_due || sleep.still_ticks >= sleep_ticks_;
        } else if (body.mode == kFixed ||
                   (is_zero(motion.linear_velocity) && is_zero(motion.angular_velocity))) {
            set_level(sleep, BodyLevel::asleep);
        }
    }
    return is_due;
}

/// What lies on a kinematic body that moves, or hangs on it, is carried along.
void Sleep::keep_carried_awake(const DynamicsTables& tables, const Activity& activity) {
    for (const std::uint32_t index : activity.pairs()) {
        const Pair& pair = tables.pairs[index];
        if (!is_pressing(pair, tables)) {
            continue;
        }
        keep_awake_if_carried(tables, pair.row_a, pair.row_b);
    }
    for (const std::uint32_t index : activity.joints()) {
        const Joint& joint = tables.joints[index];
        if (joint.row_a != kNoIndex) {
            keep_awake_if_carried(tables, joint.row_a, joint.row_b);
        }
    }
}

/// Islands of all dynamic bodies that are awake; marks those that stay so.
void Sleep::join_awake(const DynamicsTables& tables, const Activity& activity) {
    for (const BodyRow row : rows_) {
        islands_.begin(row);
        is_marked_[row] = 0;
    }
    for (const std::uint32_t index : activity.pairs()) {
        const Pair& pair = tables.pairs[index];
        if (is_bond(pair, tables)) {
            islands_.join(pair.row_a, pair.row_b);
        }
    }
    for (const std::uint32_t index : activity.joints()) {
        const Joint& joint = tables.joints[index];
        if (is_bond(joint, tables)) {
            islands_.join(joint.row_a, joint.row_b);
        }
    }
    for (const BodyRow row : rows_) {
        if (tables.sleep[row].still_ticks < sleep_ticks_ || tables.properties[row].can_sleep == 0) {
            is_marked_[islands_.find(row)] = 1;
        }
    }
}

/// No point of the body moves faster than the sleep speed by its velocity, nor by its turning.
bool Sleep::is_slow(const BodyMotion& motion, const BodyProperties& body) const {
    std::int64_t linear[3];
    std::int64_t surface[3];
    for (int axis = 0; axis < 3; ++axis) {
        linear[axis] = motion.linear_velocity[axis];
        // angular velocity x gyration radius / gyration radius x bounding radius
        const std::int64_t turning =
            std::int64_t{motion.angular_velocity[axis]} * body.bounding_radius >> kLengthFraction;
        surface[axis] = raw_multiply(turning, std::int64_t{body.inverse_gyration_radius}) >>
                        kEffectiveMassFraction;
    }
    return is_within(linear, speed_max_) && is_within(surface, speed_max_);
}

void wake_body(const DynamicsTables& tables, BodyRow row) {
    BodySleep& sleep = tables.sleep[row];
    sleep.still_ticks = 0;
    switch (level_of(sleep)) {
    case BodyLevel::asleep:
        set_level(sleep, BodyLevel::full);
        break;
    case BodyLevel::frozen:
        set_level(sleep, BodyLevel::simplified);
        break;
    case BodyLevel::full:
    case BodyLevel::simplified:
        break;
    }
}

} // namespace lockwind
