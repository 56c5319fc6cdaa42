#include "base/canonical.h"
#include "world/impl.h"
#include "world/validate.h"

#include "lockwind/assert.h"
#include "lockwind/hash_tree.h"
#include "lockwind/overflow.h"

#include <utility>

namespace lockwind {

Status World::Impl::validate(StateArena& state, const DynamicsTables* known) {
    const DynamicsTables rows = tables_of(state);
    if (Status status = check_globals(state.table<Globals>(section::kGlobals)); !status) {
        return status;
    }
    const Table<Player> state_players = state.table<Player>(section::kPlayer);
    if (Status status = check_players(state_players, pod_ids); !status) {
        return status;
    }
    Status kinds = check_kinds(rows, known, spawner, settings, shapes);
    spawner.forget(); // the state that was checked may not be the world's
    if (!kinds) {
        return kinds;
    }
    if (Status status = check_bodies(rows, settings.level_of_detail); !status) {
        return status;
    }
    if (Status status = check_joints(rows); !status) {
        return status;
    }
    return check_contacts(rows, dynamics);
}

std::uint64_t World::state_hash() const {
    const std::uint64_t hash = impl_->hasher.root(impl_->arena, impl_->looked_at());
    if constexpr (kChecked) {
        LOCKWIND_ASSERT(hash == impl_->hasher.root(impl_->arena)); // every write was told
    }
    return hash;
}

HashTree World::hash_tree() const {
    return impl_->hasher.tree(impl_->arena);
}

void World::save(std::vector<std::byte>& out) const {
    save_canonical(impl_->arena, out);
}

Status World::load(std::span<const std::byte> bytes) {
    if (Status loaded = load_canonical(impl_->staging, bytes); !loaded) {
        return loaded;
    }
    const DynamicsTables known = impl_->tables();
    if (Status valid = impl_->validate(impl_->staging, &known); !valid) {
        return valid;
    }
    std::swap(impl_->arena, impl_->staging);
    impl_->versions.touch_all();
    impl_->begin_anew();
    return Success{};
}

void World::keep(KeptState& kept) const {
    impl_->keeper.keep(impl_->arena, impl_->looked_at(), kept);
}

void World::restore(const KeptState& kept) {
    impl_->keeper.restore(impl_->arena, impl_->looked_at(), kept);
    impl_->begin_anew();
}

/// After another state has come: nothing of the steps before counts.
void World::Impl::begin_anew() {
    events.clear();
    query_index.drop();
    spawner.forget();
    fault = StepFault::none;
}

StateSchema World::schema() {
    return kWorldSections;
}

std::uint32_t World::row_count(std::uint32_t section) const {
    LOCKWIND_ASSERT(section < section::kCount);
    return impl_->arena.row_count(section);
}

std::span<std::byte> World::section_bytes(std::uint32_t section) {
    LOCKWIND_ASSERT(section < section::kCount);
    impl_->query_index.drop(); // they may be written, now or later
    impl_->is_tracked = false;
    return impl_->arena.live_bytes(section);
}

Status World::check() const {
    return impl_->validate(impl_->arena, nullptr);
}

PageVersions& World::Impl::looked_at() {
    if (!is_tracked) {
        versions.touch_all();
    }
    return versions;
}

void World::Impl::derive(const DynamicsTables& rows) {
    dynamics.derive_pairs(rows);
}

void World::drop_derived() {
    impl_->dynamics.drop_caches();
    impl_->derive(impl_->tables());
    impl_->spawner.forget();
    impl_->query_index.drop();
}

} // namespace lockwind
