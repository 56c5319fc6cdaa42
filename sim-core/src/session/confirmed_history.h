#pragma once

#include "session/messages.h"

#include "lockwind/simulation.h"
#include "lockwind/types.h"

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

namespace lockwind {

/// Inputs of confirmed ticks without a gap, the oldest ones cut off. A tick's inputs never change.
class ConfirmedHistory {
public:
    /// Empty; the next tick is newest_tick + 1.
    explicit ConfirmedHistory(Tick newest_tick = 0) : newest_tick_(newest_tick) {}

    void push(std::vector<SlotInput> inputs);
    void discard_before(Tick tick);
    /// Takes back the newest one, which nobody has heard of.
    void retract();

    Tick newest_tick() const { return newest_tick_; }
    /// First kept one; newest_tick() + 1 where none is.
    Tick oldest_tick() const { return newest_tick_ + 1 - ticks_.size(); }
    /// In slot order; empty where the tick is not kept.
    std::span<const SlotInput> find(Tick tick) const;

    /// Ticks first_tick, first_tick + 1 ..., at most ticks_max, of those that are kept.
    void fill(Confirmation& confirmation, Tick first_tick, std::size_t ticks_max) const;

private:
    Tick newest_tick_;
    std::deque<std::vector<SlotInput>> ticks_;
};

} // namespace lockwind
