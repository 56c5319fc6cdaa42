#include "session/state_history.h"

#include "lockwind/assert.h"

#include <utility>

namespace lockwind {

StateHistory::StateHistory(std::size_t capacity) : states_(capacity) {
    LOCKWIND_ASSERT(capacity > 0);
}

const SavedState& StateHistory::at(std::size_t age_rank) const {
    return states_[(first_ + age_rank) % states_.size()];
}

SavedState& StateHistory::next() {
    if (size_ == states_.size()) {
        first_ = (first_ + 1) % states_.size();
        --size_;
    }
    ++size_;
    return states_[(first_ + size_ - 1) % states_.size()];
}

void StateHistory::save(const Simulation& simulation, std::uint64_t hash) {
    LOCKWIND_ASSERT(empty() || simulation.tick() > newest_tick());
    SavedState& state = next();
    state.tick = simulation.tick();
    state.hash = hash;
    simulation.save(state.bytes);
}

void StateHistory::put(Tick tick, std::uint64_t hash, std::vector<std::byte> bytes) {
    LOCKWIND_ASSERT(empty() || tick > newest_tick());
    next() = SavedState{tick, hash, std::move(bytes)};
}

const SavedState* StateHistory::find(Tick tick) const {
    const SavedState* state = find_at_or_before(tick);
    return state != nullptr && state->tick == tick ? state : nullptr;
}

const SavedState* StateHistory::find_at_or_before(Tick tick) const {
    std::size_t low = 0; // states below are at or before `tick`, from `high` on they are after it
    std::size_t high = size_;
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (at(middle).tick <= tick) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low == 0 ? nullptr : &at(low - 1);
}

void StateHistory::discard_before(Tick tick) {
    while (size_ > 0 && at(0).tick < tick) {
        first_ = (first_ + 1) % states_.size();
        --size_;
    }
}

void StateHistory::discard_after(Tick tick) {
    while (size_ > 0 && at(size_ - 1).tick > tick) {
        --size_;
    }
}

Tick StateHistory::oldest_tick() const {
    LOCKWIND_ASSERT(!empty());
    return at(0).tick;
}

Tick StateHistory::newest_tick() const {
    LOCKWIND_ASSERT(!empty());
    return at(size_ - 1).tick;
}

} // namespace lockwind
