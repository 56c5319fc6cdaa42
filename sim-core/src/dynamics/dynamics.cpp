#include "dynamics/dynamics.h"

#include "dynamics/activity.h"
#include "dynamics/body_frame.h"
#include "dynamics/broad_phase.h"
#include "dynamics/contact_kernel_choice.h"
#include "dynamics/levels.h"
#include "dynamics/manifold_slots.h"
#include "dynamics/narrow_phase.h"
#include "dynamics/pair_parts.h"
#include "dynamics/sleep.h"
#include "dynamics/solver.h"
#include "dynamics/sweep.h"

#include "lockwind/world_definition.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

namespace lockwind {

namespace {

/// Tells each pair its manifold. False where one has no pair, or not for itself.
bool link_manifolds(const Table<Manifold>& manifolds, const Table<Pair>& pairs) {
    const auto is_before = [](const Pair& pair, const Manifold& manifold) {
        return std::tie(pair.row_a, pair.row_b, pair.child) <
               std::tie(manifold.row_a, manifold.row_b, manifold.child);
    };
    const std::span<Pair> rows = pairs.rows();
    for (std::uint32_t index = 0; index < manifolds.count(); ++index) {
        const Manifold& manifold = manifolds[index];
        if (manifold.point_count == 0) {
            continue;
        }
        const auto pair = std::lower_bound(rows.begin(), rows.end(), manifold, is_before);
        if (pair == rows.end() || pair->row_a != manifold.row_a || pair->row_b != manifold.row_b ||
            pair->child != manifold.child || pair->point_count != 0) {
            return false;
        }
        pair->manifold = index;
        pair->point_count = manifold.point_count;
        pair->axis = manifold.axis;
    }
    return true;
}

/// How many rows of a pair of bodies touch.
std::uint32_t touching_rows(const Table<Pair>& pairs, BodyRow row_a, BodyRow row_b) {
    const std::span<Pair> rows = pairs.rows();
    const auto first = std::lower_bound(
        rows.begin(), rows.end(), std::pair{row_a, row_b}, [](const Pair& pair, const auto& key) {
            return std::pair{pair.row_a, pair.row_b} < key;
        });
    std::uint32_t count = 0;
    for (auto pair = first; pair != rows.end() && pair->row_a == row_a && pair->row_b == row_b;
         ++pair) {
        count += pair->point_count != 0 ? 1U : 0U;
    }
    return count;
}

/// One change for two bodies: their first row that touches begins, their last one that ceases to
/// ends it. `changes` are in pair order.
void unite_changes(const DynamicsTables& tables, std::vector<ContactChange>& changes) {
    const std::uint32_t count = tables.properties.count();
    const auto have_parts = [&](const ContactChange& change) {
        // Damaged rows must not lead outside.
        return change.row_a < count && change.row_b < count &&
               (has_parts(tables.properties[change.row_a]) ||
                has_parts(tables.properties[change.row_b]));
    };
    std::size_t kept = 0;
    for (std::size_t first = 0, end = 0; first < changes.size(); first = end) {
        ContactChange change = changes[first];
        std::int64_t begun = 0; // rows, less those that ended
        while (end < changes.size() && changes[end].row_a == change.row_a &&
               changes[end].row_b == change.row_b) {
            begun += changes[end].begin ? 1 : -1;
            ++end;
        }
        if (have_parts(change)) {
            const std::int64_t after = touching_rows(tables.pairs, change.row_a, change.row_b);
            change.begin = after != 0;
            if ((after != 0) == (after - begun != 0)) {
                continue;
            }
        }
        changes[kept++] = change;
    }
    changes.resize(kept);
}

} // namespace

struct Dynamics::Impl {
    Impl(const DynamicsSettings& settings, const ShapeLibrary* shapes, Simd simd)
        : activity(settings), frames(settings.body_capacity, shapes),
          slots(settings.manifold_capacity), broad(settings, shapes), narrow(settings),
          solver(settings, contact_kernels(simd)), sweep(settings), sleep(settings),
          levels(settings) {
        // A pair that goes and one that comes both change in a tick.
        changes.reserve(2 * std::size_t{settings.pair_capacity});
    }

    /// Who is awake, and what concerns them.
    void look(const DynamicsTables& tables) {
        activity.read_rows(tables.sleep);
        activity.read_pairs(tables.pairs);
        activity.read_joints(tables.joints);
    }
    void refresh_frames(const DynamicsTables& tables) {
        frames.refresh(tables, activity.rows());
        frames.refresh(tables, activity.partners());
    }

    Activity activity;
    BodyFrames frames;
    ManifoldSlots slots;
    BroadPhase broad;
    NarrowPhase narrow;
    Solver solver;
    Sweep sweep;
    Sleep sleep;
    Levels levels;
    std::vector<ContactChange> changes;
    bool pairs_moved = false;
};

Dynamics::Dynamics(const DynamicsSettings& settings, const ShapeLibrary* shapes, Simd simd)
    : impl_(std::make_unique<Impl>(settings, shapes, simd)) {}

Dynamics::~Dynamics() = default;

StepFault Dynamics::broad_phase(const DynamicsTables& tables) {
    impl_->changes.clear();
    impl_->sleep.clear_changes();
    impl_->slots.forget_changes();
    impl_->pairs_moved = false;
    impl_->activity.read_rows(tables.sleep);
    const std::span<const BodyRow> awake = impl_->activity.rows();
    if (awake.empty()) {
        return StepFault::none;
    }
    impl_->frames.refresh(tables, awake);
    impl_->slots.read(tables.manifolds);
    const StepFault fault =
        impl_->broad.run(tables, impl_->frames, awake, impl_->slots, impl_->changes);
    impl_->pairs_moved = impl_->broad.has_changed_pairs();
    return fault;
}

StepFault Dynamics::narrow_phase(const DynamicsTables& tables) {
    impl_->look(tables);
    if (impl_->activity.rows().empty()) {
        return StepFault::none;
    }
    impl_->refresh_frames(tables);
    impl_->slots.read(tables.manifolds);
    const StepFault fault =
        impl_->narrow.run(tables, impl_->frames, impl_->activity, impl_->slots, impl_->changes);
    std::sort(impl_->changes.begin(),
              impl_->changes.end(),
              [](const ContactChange& x, const ContactChange& y) {
                  return x.row_a != y.row_a ? x.row_a < y.row_a : x.row_b < y.row_b;
              });
    unite_changes(tables, impl_->changes);
    return fault;
}

std::span<const ContactChange> Dynamics::contact_changes() const {
    return impl_->changes;
}

void Dynamics::wake(const DynamicsTables& tables) {
    if (impl_->sleep.wake(tables, impl_->activity)) {
        impl_->look(tables);
    }
}

void Dynamics::solve(const DynamicsTables& tables) {
    impl_->look(tables);
    impl_->refresh_frames(tables);
    impl_->sweep.remember(tables, impl_->activity);
    impl_->solver.solve(tables, impl_->frames, impl_->activity);
    impl_->sweep.run(tables, impl_->frames, impl_->activity);
}

void Dynamics::restitution(const DynamicsTables& tables) {
    impl_->solver.restitution(tables);
    impl_->narrow.forget_foreseen(tables, impl_->slots);
}

std::span<const ContactHit> Dynamics::contact_hits() const {
    return impl_->solver.hits();
}

void Dynamics::sleep(const DynamicsTables& tables) {
    impl_->sleep.fall_asleep(tables, impl_->activity);
}

void Dynamics::choose_levels(const DynamicsTables& tables, std::span<const BodyRow> viewers) {
    impl_->levels.choose(tables, impl_->activity, viewers);
}

std::span<const SleepChange> Dynamics::sleep_changes() const {
    return impl_->sleep.changes();
}

std::span<const BodyRow> Dynamics::awake_rows() const {
    return impl_->activity.rows();
}

std::span<const std::uint32_t> Dynamics::active_pairs() const {
    return impl_->activity.pairs();
}

std::span<const std::uint32_t> Dynamics::active_joints() const {
    return impl_->activity.joints();
}

std::span<const std::uint32_t> Dynamics::changed_manifolds() const {
    return impl_->slots.changes();
}

bool Dynamics::pairs_moved() const {
    return impl_->pairs_moved;
}

std::span<const std::uint32_t> Dynamics::changed_pairs() const {
    return impl_->narrow.changed_pairs();
}

std::span<const std::uint32_t> Dynamics::broken_joints() const {
    return impl_->solver.broken_joints();
}

bool Dynamics::derive_pairs(const DynamicsTables& tables) {
    return impl_->broad.derive_pairs(tables) && link_manifolds(tables.manifolds, tables.pairs);
}

void Dynamics::drop_caches() {
    impl_->frames.drop();
}

namespace {

/// Its pairs are looked at: what a joint kept from touching may touch when that goes.
void wake_dynamic(const DynamicsTables& tables, BodyRow row) {
    if (tables.properties[row].mode == static_cast<std::uint8_t>(BodyMode::dynamic)) {
        wake_body(tables, row);
        tables.sleep[row].moved |= bit_of(MotionBound::other);
    }
}

/// kNoIndex, a grab's other body, stays.
void remap_joints(const DynamicsTables& tables, std::span<const BodyRow> new_row_of) {
    const Table<Joint>& joints = tables.joints;
    const auto moved_to = [&](BodyRow row) {
        return row < new_row_of.size() ? new_row_of[row] : kNoIndex;
    };
    std::uint32_t kept = 0;
    for (std::uint32_t index = 0; index < joints.count(); ++index) {
        Joint joint = joints[index];
        const bool is_grab = joint.row_a == kNoIndex;
        joint.row_a = moved_to(joint.row_a);
        joint.row_b = moved_to(joint.row_b);
        if ((is_grab || joint.row_a != kNoIndex) && joint.row_b != kNoIndex) {
            joints[kept++] = joint;
        } else {
            wake_joined(tables, joints[index]);
        }
    }
    joints.set_count(kept);
}

/// Free slots at the end are not rows.
void trim_manifolds(const DynamicsTables& tables) {
    std::uint32_t live = tables.manifolds.count();
    while (live > 0 && tables.manifolds[live - 1].point_count == 0) {
        --live;
    }
    set_manifold_count(tables, live);
}

} // namespace

void wake_joined(const DynamicsTables& tables, const Joint& joint) {
    for (const BodyRow row : {joint.row_a, joint.row_b}) {
        if (row < tables.properties.count()) {
            wake_dynamic(tables, row);
        }
    }
}

void remap_rows(const DynamicsTables& tables, std::span<const BodyRow> new_row_of) {
    remap_joints(tables, new_row_of);
    const auto moved_to = [&](BodyRow row) {
        return row < new_row_of.size() ? new_row_of[row] : kNoIndex;
    };
    std::uint32_t kept = 0;
    const std::uint32_t count = tables.pairs.count();
    for (std::uint32_t index = 0; index < count; ++index) {
        Pair pair = tables.pairs[index];
        const BodyRow row_a = moved_to(pair.row_a);
        const BodyRow row_b = moved_to(pair.row_b);
        const bool stays = row_a != kNoIndex && row_b != kNoIndex;
        if (pair.point_count != 0 && pair.manifold < tables.manifolds.count()) {
            Manifold& manifold = tables.manifolds[pair.manifold];
            if (stays) {
                manifold.row_a = row_a;
                manifold.row_b = row_b;
            } else {
                clear_manifold(tables, pair.manifold);
                wake_dynamic(tables, pair.row_a);
                wake_dynamic(tables, pair.row_b);
            }
        }
        if (stays) {
            pair.row_a = row_a;
            pair.row_b = row_b;
            tables.pairs[kept++] = pair;
        }
    }
    tables.pairs.set_count(kept);
    trim_manifolds(tables);
}

void drop_contacts(const DynamicsTables& tables, BodyRow row) {
    std::uint32_t kept = 0;
    for (std::uint32_t index = 0; index < tables.pairs.count(); ++index) {
        const Pair pair = tables.pairs[index];
        if (pair.row_a != row && pair.row_b != row) {
            tables.pairs[kept++] = pair;
        } else if (pair.point_count != 0) {
            clear_manifold(tables, pair.manifold);
            wake_dynamic(tables, pair.row_a);
            wake_dynamic(tables, pair.row_b);
        }
    }
    tables.pairs.set_count(kept);
    trim_manifolds(tables);
}

} // namespace lockwind
