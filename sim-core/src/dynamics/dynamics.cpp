#include "dynamics/dynamics.h"

#include "dynamics/body_frame.h"
#include "dynamics/broad_phase.h"
#include "dynamics/contact_kernel_choice.h"
#include "dynamics/manifold_slots.h"
#include "dynamics/narrow_phase.h"
#include "dynamics/solver.h"

#include <algorithm>
#include <vector>

namespace lockwind {

struct Dynamics::Impl {
    Impl(const DynamicsSettings& settings, Simd simd)
        : frames(settings.body_capacity), slots(settings.manifold_capacity), broad(settings),
          narrow(settings.body_capacity), solver(settings, contact_kernels(simd)) {
        // A pair that goes and one that comes both change in a tick.
        changes.reserve(2 * std::size_t{settings.pair_capacity});
    }

    BodyFrames frames;
    ManifoldSlots slots;
    BroadPhase broad;
    NarrowPhase narrow;
    Solver solver;
    std::vector<ContactChange> changes;
};

Dynamics::Dynamics(const DynamicsSettings& settings, Simd simd)
    : impl_(std::make_unique<Impl>(settings, simd)) {}

Dynamics::~Dynamics() = default;

StepFault Dynamics::broad_phase(const DynamicsTables& tables) {
    impl_->changes.clear();
    impl_->frames.refresh(tables);
    impl_->slots.read(tables.manifolds);
    return impl_->broad.run(tables, impl_->frames, impl_->slots, impl_->changes);
}

StepFault Dynamics::narrow_phase(const DynamicsTables& tables, std::uint32_t tick) {
    impl_->frames.refresh(tables);
    impl_->slots.read(tables.manifolds);
    const StepFault fault =
        impl_->narrow.run(tables, tick, impl_->frames, impl_->slots, impl_->changes);
    std::sort(impl_->changes.begin(),
              impl_->changes.end(),
              [](const ContactChange& x, const ContactChange& y) {
                  return x.row_a != y.row_a ? x.row_a < y.row_a : x.row_b < y.row_b;
              });
    return fault;
}

std::span<const ContactChange> Dynamics::contact_changes() const {
    return impl_->changes;
}

void Dynamics::solve(const DynamicsTables& tables, std::uint32_t tick) {
    impl_->frames.refresh(tables);
    impl_->solver.solve(tables, tick, impl_->frames);
}

void Dynamics::restitution(const DynamicsTables& tables) {
    impl_->solver.restitution(tables);
}

std::span<const ContactHit> Dynamics::contact_hits() const {
    return impl_->solver.hits();
}

void Dynamics::drop_derived() {
    impl_->frames.drop();
}

void remap_rows(const DynamicsTables& tables, std::span<const BodyRow> new_row_of) {
    const auto moved_to = [&](BodyRow row) {
        return row < new_row_of.size() ? new_row_of[row] : kNoIndex;
    };
    std::uint32_t kept = 0;
    const std::uint32_t count = tables.pairs.count();
    for (std::uint32_t index = 0; index < count; ++index) {
        Pair pair = tables.pairs[index];
        pair.row_a = moved_to(pair.row_a);
        pair.row_b = moved_to(pair.row_b);
        const bool stays = pair.row_a != kNoIndex && pair.row_b != kNoIndex;
        if (pair.point_count != 0 && pair.manifold < tables.manifolds.count()) {
            Manifold& manifold = tables.manifolds[pair.manifold];
            if (stays) {
                manifold.row_a = pair.row_a;
                manifold.row_b = pair.row_b;
            } else {
                manifold = Manifold{};
            }
        }
        if (stays) {
            tables.pairs[kept++] = pair;
        }
    }
    tables.pairs.set_count(kept);
    std::uint32_t live = tables.manifolds.count();
    while (live > 0 && tables.manifolds[live - 1].point_count == 0) {
        --live;
    }
    tables.manifolds.set_count(live);
}

} // namespace lockwind
