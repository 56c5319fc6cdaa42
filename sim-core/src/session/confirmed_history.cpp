#include "session/confirmed_history.h"

#include "lockwind/assert.h"

#include <utility>

namespace lockwind {

void ConfirmedHistory::push(std::vector<SlotInput> inputs) {
    ticks_.push_back(std::move(inputs));
    ++newest_tick_;
}

void ConfirmedHistory::discard_before(Tick tick) {
    while (!ticks_.empty() && oldest_tick() < tick) {
        ticks_.pop_front();
    }
}

void ConfirmedHistory::retract() {
    LOCKWIND_ASSERT(!ticks_.empty());
    ticks_.pop_back();
    --newest_tick_;
}

std::span<const SlotInput> ConfirmedHistory::find(Tick tick) const {
    if (tick < oldest_tick() || tick > newest_tick_) {
        return {};
    }
    return ticks_[static_cast<std::size_t>(tick - oldest_tick())];
}

void ConfirmedHistory::fill(Confirmation& confirmation,
                            Tick first_tick,
                            std::size_t ticks_max) const {
    confirmation.first_tick = first_tick;
    confirmation.confirmed_tick = newest_tick_;
    for (Tick tick = first_tick; confirmation.ticks.size() < ticks_max; ++tick) {
        const std::span<const SlotInput> inputs = find(tick);
        if (inputs.empty()) {
            return;
        }
        confirmation.ticks.push_back(ConfirmedTick{{inputs.begin(), inputs.end()}});
    }
}

} // namespace lockwind
