#pragma once

#include "lockwind/simulation.h"
#include "lockwind/types.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lockwind {

/// A saved state of one tick.
struct SavedState {
    Tick tick = 0;
    std::uint64_t hash = 0;
    std::vector<std::byte> bytes; // Simulation::save
};

/// The last saved states in tick order, at most `capacity`: a new one takes the place of the
/// oldest. Buffers are reused, so nothing is allocated once the ring is full and the states have
/// stopped growing. What a driver keeps until hashes are agreed on: cut it with the session's
/// oldest_needed_tick().
class StateHistory {
public:
    explicit StateHistory(std::size_t capacity);

    /// Saves the simulation's present state. Its tick must be above newest_tick().
    void save(const Simulation& simulation, std::uint64_t hash);
    /// The same for bytes at hand.
    void put(Tick tick, std::uint64_t hash, std::vector<std::byte> bytes);

    /// nullptr where the tick is not kept.
    const SavedState* find(Tick tick) const;
    /// Newest one at or before `tick`; nullptr where none is kept.
    const SavedState* find_at_or_before(Tick tick) const;

    void discard_before(Tick tick);
    void discard_after(Tick tick);
    void clear() { size_ = 0; }

    bool empty() const { return size_ == 0; }
    std::size_t size() const { return size_; }
    std::size_t capacity() const { return states_.size(); }
    Tick oldest_tick() const; // asserts that it is not empty
    Tick newest_tick() const;

private:
    const SavedState& at(std::size_t age_rank) const; // 0: oldest
    SavedState& next();

    std::vector<SavedState> states_;
    std::size_t first_ = 0;
    std::size_t size_ = 0;
};

} // namespace lockwind
