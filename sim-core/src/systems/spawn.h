#pragma once

#include "dynamics/body_kinds.h"
#include "dynamics/dynamics.h"

#include "lockwind/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// The rows of a body; its kind is found when it comes into the tables.
struct BodyRecord {
    BodyMotion motion;
    BodyProperties properties;
    BodyLife life;
};

/// Row of the body of that id, by binary search; kNoIndex where there is none.
BodyRow row_of(const Table<BodyMotion>& motion, BodyId id);

/// A body that `spawner` made has its id in the high half of its own.
constexpr BodyId spawner_of(BodyId id) {
    return id >> 32U;
}
constexpr BodyId spawned_id(BodyId spawner, std::uint32_t spawn_count) {
    return (spawner << 32U) | spawn_count;
}

/// Collects bodies to make and to destroy, then merges them into the id-sorted tables at once.
/// Empty between ticks: no state, but notes of when the next one is due and of who is of a kind.
/// Allocates on construction only.
class Spawner {
public:
    /// At most `create_capacity` creations a merge.
    Spawner(std::uint32_t body_capacity, std::uint32_t create_capacity);

    void create(const BodyRecord& body);
    /// False where the row is already to be destroyed.
    bool destroy(BodyRow row);
    bool is_destroyed(BodyRow row) const { return destroyed_[row] != 0; }

    /// Queued bodies; after sort_created() in id order.
    std::span<const BodyRecord> created() const { return created_; }
    void sort_created();

    /// Whether bodies of the tables are due to go in this tick, see BodyLife::despawn_tick. Looks
    /// at all of them only where some came or went, or are due.
    bool is_despawn_due(const Table<BodyLife>& lives, std::uint32_t tick);
    /// The tables are not those of before, nor is what was queued for them: a step that failed did
    /// not come to apply it.
    void forget();

    /// Of a world without kinds.
    void begin_kinds() { kinds_.begin(); }
    /// To a body that has none.
    void give_kind(const DynamicsTables& tables, BodyRow row, const BodyProperties& properties);
    /// Gives a body other properties.
    void redefine(const DynamicsTables& tables, BodyRow row, const BodyProperties& properties);
    /// Whether the kinds are such as this class leaves them; see BodyKinds::read.
    bool check_kinds(const DynamicsTables& tables) {
        return kinds_.read(tables.kinds, tables.lives);
    }

    /// Whether apply() will change the tables.
    bool is_due() const { return !created_.empty() || destroyed_count_ != 0; }
    /// Makes tables of the bodies that stay and the new ones, in id order, and renumbers pairs and
    /// manifolds. Empties the queues. bodies_full leaves the tables as they were.
    StepFault apply(const DynamicsTables& tables);

private:
    void drop_queues();
    void number_rows(const Table<BodyMotion>& motion);
    void release_kinds(const DynamicsTables& tables);
    void take_kinds(const DynamicsTables& tables);

    std::vector<BodyRecord> created_;
    std::vector<std::uint8_t> destroyed_; // by row
    std::uint32_t destroyed_count_ = 0;
    std::vector<BodyRow> new_row_of_; // by row before the merge
    BodyKinds kinds_;
    bool despawn_known_ = false;
    std::uint32_t despawn_tick_ = 0; // the next one where it is known; 0: none
};

} // namespace lockwind
