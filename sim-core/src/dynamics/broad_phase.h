#pragma once

#include "dynamics/body_frame.h"
#include "dynamics/bounds_grid.h"
#include "dynamics/dynamics.h"
#include "dynamics/foresight.h"
#include "dynamics/manifold_slots.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Keeps BodyMotion::fat_bounds about the bodies and the pair table equal to the set of overlapping
/// fat bounds with at least one dynamic body.
class BroadPhase {
public:
    /// `shapes` as of BodyFrames.
    explicit BroadPhase(const DynamicsSettings& settings, const ShapeLibrary* shapes = nullptr);

    /// Appends touching pairs that drift apart to `changes`, in pair order. On a fault no table has
    /// changed.
    StepFault run(const DynamicsTables& tables,
                  const BodyFrames& frames,
                  std::span<const BodyRow> awake,
                  ManifoldSlots& slots,
                  std::vector<ContactChange>& changes);

    /// Whether the last run renewed any bounds, and so may have changed pairs.
    bool has_changed_pairs() const { return has_changed_pairs_; }

    /// Makes the pair table anew from the stored bounds; nothing touches in it. False where it
    /// cannot hold them: it is then empty.
    bool derive_pairs(const DynamicsTables& tables);

private:
    struct Key {
        BodyRow row_a;
        BodyRow row_b;
        std::uint32_t child;
        auto operator<=>(const Key&) const = default;
    };

    void update_bounds(const DynamicsTables& tables,
                       const BodyFrames& frames,
                       std::span<const BodyRow> awake);
    void read_unmoved_bounds(const DynamicsTables& tables);
    Bounds fat_bounds(const Bounds& tight, const BodyMotion& motion, bool moves) const;
    bool find_new_pairs(const DynamicsTables& tables);
    bool add_pair(const DynamicsTables& tables, BodyRow row, BodyRow other, bool is_known);
    bool add_key(const Key& key);
    bool is_gone(const DynamicsTables& tables, const Pair& pair) const;
    bool has_part_gone(const DynamicsTables& tables, const Pair& pair) const;
    static void merge_new_pairs(const Table<Pair>& pairs, const std::vector<Key>& added);

    Foresight foresight_;
    std::uint32_t tick_rate_;
    std::uint32_t pair_capacity_;
    const ShapeLibrary* shapes_;
    std::vector<Bounds> bounds_; // fat, of this tick
    std::vector<BodyRow> moved_;
    std::vector<std::uint8_t> is_moved_;
    bool has_changed_pairs_ = false;
    std::vector<Key> added_;
    BoundsGrid grid_;
};

} // namespace lockwind
