#pragma once

#include "dynamics/activity.h"
#include "dynamics/dynamics.h"
#include "dynamics/islands.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Puts islands to sleep that were slow for long enough, and wakes them. An island is what touching
/// pairs and joints hold together; it sleeps and wakes as a whole. Between ticks it is not stored:
/// it follows from the pairs. Frozen islands wake as sleeping ones do, but for the telling.
class Sleep {
public:
    explicit Sleep(const DynamicsSettings& settings);

    /// Wakes the islands of resting bodies that touch one that is awake. True where any woke:
    /// `activity` is then out of date.
    bool wake(const DynamicsTables& tables, const Activity& activity);
    /// Counts for how long the bodies that are awake were slow, and puts islands to sleep. What has
    /// no need to move, fixed bodies and kinematic ones at rest, sleeps at once.
    void fall_asleep(const DynamicsTables& tables, const Activity& activity);

    /// Dynamic bodies that woke, or fell asleep, in this tick; in row order.
    std::span<const SleepChange> changes() const { return changes_; }
    void clear_changes() { changes_.clear(); }

private:
    void find_woken(BodyRow a, BodyRow b, const DynamicsTables& tables, const Activity& activity);
    void join_sleepers(const DynamicsTables& tables, const Activity& activity);
    bool count_still_ticks(const DynamicsTables& tables, std::span<const BodyRow> rows);
    void keep_carried_awake(const DynamicsTables& tables, const Activity& activity);
    void join_awake(const DynamicsTables& tables, const Activity& activity);
    bool is_slow(const BodyMotion& motion, const BodyProperties& properties) const;

    std::int64_t speed_max_;    // Q11.20 m/s
    std::uint16_t sleep_ticks_; // 0: nobody sleeps
    Islands islands_;
    std::vector<BodyRow> rows_;           // to be woken, or all dynamic ones that are awake
    std::vector<std::uint8_t> is_marked_; // by the island's row
    std::vector<SleepChange> changes_;
};

} // namespace lockwind
