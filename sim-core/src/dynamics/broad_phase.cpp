#include "dynamics/broad_phase.h"

#include "dynamics/pair_parts.h"
#include "dynamics/pairing.h"
#include "dynamics/solver_format.h"
#include "geometry/bounds.h"

#include "lockwind/overflow.h"
#include "lockwind/world_definition.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr std::int64_t kFatMargin = 3277;        // 50 mm, Q15.16
constexpr std::int64_t kPredictionMax = 1 << 15; // 0.5 m, Q15.16
constexpr std::int64_t kPredictionTicks = 3;

constexpr auto kFixed = static_cast<std::uint8_t>(BodyMode::fixed);
constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);

Bounds stored_bounds(const BodyMotion& motion) {
    Bounds bounds{};
    std::copy(motion.fat_bounds, motion.fat_bounds + 3, bounds.low);
    std::copy(motion.fat_bounds + 3, motion.fat_bounds + 6, bounds.high);
    return bounds;
}

void store_bounds(const Bounds& bounds, BodyMotion& motion) {
    std::copy(bounds.low, bounds.low + 3, motion.fat_bounds);
    std::copy(bounds.high, bounds.high + 3, motion.fat_bounds + 3);
}

bool is_empty(const Bounds& bounds) {
    return bounds.low[0] > bounds.high[0];
}

Bounds tight_bounds(const BodyFrame& frame, const BodyMotion& motion) {
    if (!is_bounded(frame.shape.type)) {
        return kUnbounded;
    }
    Bounds bounds{};
    for (int axis = 0; axis < 3; ++axis) {
        // Both shifts round down: one unit each makes up for it.
        const std::int64_t centre = motion.position[axis] >> (32 - kBoundsFraction);
        const std::int64_t extent =
            (frame.half_extents[axis] >> (kLengthFraction - kBoundsFraction)) + 2;
        bounds.low[axis] = raw_saturate<std::int32_t>(centre - extent);
        bounds.high[axis] = raw_saturate<std::int32_t>(centre + extent);
    }
    return bounds;
}

} // namespace

BroadPhase::BroadPhase(const DynamicsSettings& settings, const ShapeLibrary* shapes)
    : foresight_(settings), tick_rate_(settings.tick_rate_hz),
      pair_capacity_(settings.pair_capacity), shapes_(shapes), bounds_(settings.body_capacity),
      is_moved_(settings.body_capacity), grid_(settings.body_capacity) {
    moved_.reserve(settings.body_capacity);
    added_.reserve(settings.pair_capacity);
}

Bounds BroadPhase::fat_bounds(const Bounds& tight, const BodyMotion& motion, bool moves) const {
    Bounds fat{};
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t speed =
            moves ? motion.linear_velocity[axis] >> (kVelocityFraction - kBoundsFraction) : 0;
        const std::int64_t ahead =
            std::clamp(speed * kPredictionTicks / tick_rate_, -kPredictionMax, kPredictionMax);
        fat.low[axis] = raw_saturate<std::int32_t>(tight.low[axis] - kFatMargin +
                                                   std::min(ahead, std::int64_t{0}));
        fat.high[axis] = raw_saturate<std::int32_t>(tight.high[axis] + kFatMargin +
                                                    std::max(ahead, std::int64_t{0}));
    }
    return fat;
}

void BroadPhase::update_bounds(const DynamicsTables& tables,
                               const BodyFrames& frames,
                               std::span<const BodyRow> awake) {
    for (const BodyRow row : moved_) {
        is_moved_[row] = 0;
    }
    moved_.clear();
    for (const BodyRow row : awake) {
        const BodyMotion& motion = tables.motion[row];
        Bounds tight = tight_bounds(frames[row], motion);
        if (foresight_.reach(tables, row) != 0) {
            tight = foresight_.extended(tight, motion);
        }
        if (contains(stored_bounds(motion), tight)) {
            continue;
        }
        is_moved_[row] = 1;
        moved_.push_back(row);
        const bool moves = tables.properties[row].mode != kFixed;
        bounds_[row] = tight == kUnbounded ? kUnbounded : fat_bounds(tight, motion, moves);
    }
}

void BroadPhase::read_unmoved_bounds(const DynamicsTables& tables) {
    for (BodyRow row = 0; row < tables.motion.count(); ++row) {
        if (is_moved_[row] == 0) {
            bounds_[row] = stored_bounds(tables.motion[row]);
        }
    }
}

/// False where there are more than the pair table can hold.
bool BroadPhase::find_new_pairs(const DynamicsTables& tables) {
    added_.clear();
    grid_.build({bounds_.data(), tables.motion.count()});
    bool fits = true;
    for (const BodyRow row : moved_) {
        const BodyProperties& properties = tables.properties[row];
        const Bounds before = stored_bounds(tables.motion[row]);
        grid_.query(bounds_[row], [&](BodyRow other) {
            // Two moved bodies find each other twice: the lower row's find counts.
            if (other == row || (is_moved_[other] != 0 && other < row)) {
                return;
            }
            if (!may_meet(properties, tables.properties[other])) {
                return;
            }
            const Bounds other_before = stored_bounds(tables.motion[other]);
            const bool is_known =
                !is_empty(before) && !is_empty(other_before) && overlaps(before, other_before);
            fits = add_pair(tables, row, other, is_known) && fits;
        });
    }
    std::sort(added_.begin(), added_.end());
    return fits;
}

bool BroadPhase::add_key(const Key& key) {
    if (added_.size() == pair_capacity_) {
        return false;
    }
    added_.push_back(key);
    return true;
}

/// Adds the rows of two bodies whose bounds overlap; of a pair that is known, those whose parts
/// have come near.
bool BroadPhase::add_pair(const DynamicsTables& tables, BodyRow row, BodyRow other, bool is_known) {
    const BodyRow a = std::min(row, other);
    const BodyRow b = std::max(row, other);
    if (!has_parts(tables.properties[a]) && !has_parts(tables.properties[b])) {
        return is_known || add_key({a, b, 0});
    }
    const ShapeInstance shape_a = shape_of_row(tables.properties[a], shapes_, nullptr);
    const ShapeInstance shape_b = shape_of_row(tables.properties[b], shapes_, nullptr);
    const PartedPair pair(tables.motion[a], shape_a, tables.motion[b], shape_b);
    const BodyRow surface = is_surface(shape_b.type) ? b : a;
    const BodyRow moving = surface == b ? a : b;
    // All rows of a surface that moved went.
    is_known = is_known && !(pair.has_surface() && is_moved_[surface] != 0);
    if (is_known && !pair.has_surface()) {
        return true;
    }
    const Bounds before = stored_bounds(tables.motion[moving]);
    bool fits = true;
    pair.visit(bounds_[moving], [&](std::uint32_t child) {
        if (!is_known || !pair.is_near(child, before)) {
            fits = fits && add_key({a, b, child});
        }
    });
    return fits;
}

/// Of two bodies one of which has new bounds that overlap the other's.
bool BroadPhase::has_part_gone(const DynamicsTables& tables, const Pair& pair) const {
    const ShapeInstance a = shape_of_row(tables.properties[pair.row_a], shapes_, nullptr);
    const ShapeInstance b = shape_of_row(tables.properties[pair.row_b], shapes_, nullptr);
    const PartedPair parts(tables.motion[pair.row_a], a, tables.motion[pair.row_b], b);
    const BodyRow surface = is_surface(b.type) ? pair.row_b : pair.row_a;
    const BodyRow moving = surface == pair.row_b ? pair.row_a : pair.row_b;
    return parts.has_surface() &&
           (is_moved_[surface] != 0 || !parts.is_near(pair.child, bounds_[moving]));
}

bool BroadPhase::is_gone(const DynamicsTables& tables, const Pair& pair) const {
    const std::uint32_t body_count = tables.motion.count();
    if (pair.row_a >= body_count || pair.row_b >= body_count) {
        return true;
    }
    if ((is_moved_[pair.row_a] | is_moved_[pair.row_b]) == 0) {
        return false;
    }
    return !overlaps(bounds_[pair.row_a], bounds_[pair.row_b]) ||
           (pair.child != 0 && has_part_gone(tables, pair));
}

void BroadPhase::merge_new_pairs(const Table<Pair>& pairs, const std::vector<Key>& added) {
    const std::uint32_t kept = pairs.count();
    pairs.set_count(kept + static_cast<std::uint32_t>(added.size()));
    const auto key_of = [](const Pair& pair) { return Key{pair.row_a, pair.row_b, pair.child}; };
    std::uint32_t from = kept;
    std::uint32_t to = pairs.count();
    for (std::size_t index = added.size(); index-- > 0;) {
        const Key& key = added[index];
        while (from > 0 && key_of(pairs[from - 1]) > key) {
            pairs[--to] = pairs[--from];
        }
        pairs[--to] = Pair{key.row_a, key.row_b, key.child, kNoIndex, 0, 0, {0, 0}};
    }
}

bool BroadPhase::derive_pairs(const DynamicsTables& tables) {
    added_.clear();
    tables.pairs.set_count(0);
    for (BodyRow row = 0; row < tables.motion.count(); ++row) {
        bounds_[row] = stored_bounds(tables.motion[row]);
    }
    grid_.build({bounds_.data(), tables.motion.count()});
    bool fits = true;
    for (BodyRow row = 0; row < tables.motion.count(); ++row) {
        if (is_empty(bounds_[row]) || tables.properties[row].mode != kDynamic) {
            continue;
        }
        grid_.query(bounds_[row], [&](BodyRow other) {
            // Two dynamic bodies find each other twice: the lower row's find counts.
            const bool twice = other < row && tables.properties[other].mode == kDynamic;
            if (other == row || twice || is_empty(bounds_[other]) ||
                !may_meet(tables.properties[row], tables.properties[other])) {
                return;
            }
            fits = add_pair(tables, row, other, false) && fits;
        });
    }
    if (!fits) {
        return false;
    }
    std::sort(added_.begin(), added_.end());
    merge_new_pairs(tables.pairs, added_);
    return true;
}

StepFault BroadPhase::run(const DynamicsTables& tables,
                          const BodyFrames& frames,
                          std::span<const BodyRow> awake,
                          ManifoldSlots& slots,
                          std::vector<ContactChange>& changes) {
    update_bounds(tables, frames, awake);
    has_changed_pairs_ = false;
    if (moved_.empty()) {
        return StepFault::none;
    }
    read_unmoved_bounds(tables);
    const std::uint32_t pair_count = tables.pairs.count();
    std::uint32_t gone = 0;
    for (std::uint32_t index = 0; index < pair_count; ++index) {
        gone += is_gone(tables, tables.pairs[index]) ? 1U : 0U;
    }
    if (!find_new_pairs(tables) || pair_count - gone + added_.size() > pair_capacity_) {
        return StepFault::pairs_full;
    }
    has_changed_pairs_ = gone != 0 || !added_.empty();
    for (const BodyRow row : moved_) {
        store_bounds(bounds_[row], tables.motion[row]);
        tables.sleep[row].moved |= bit_of(MotionBound::other); // new pairs are to be looked at
    }
    std::uint32_t kept = 0;
    for (std::uint32_t index = 0; index < pair_count; ++index) {
        const Pair pair = tables.pairs[index];
        if (!is_gone(tables, pair)) {
            tables.pairs[kept++] = pair;
        } else if (pair.point_count != 0 && pair.manifold < tables.manifolds.count()) {
            slots.free(tables, pair.manifold);
            changes.push_back({pair.row_a, pair.row_b, false});
        }
    }
    tables.pairs.set_count(kept);
    merge_new_pairs(tables.pairs, added_);
    return StepFault::none;
}

} // namespace lockwind
