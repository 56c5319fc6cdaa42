#pragma once

#include "lockwind/types.h"

#include <cstdint>

namespace lockwind {

/// When ticks are due: start + tick * period, exact in the long run (no rounded period adds up).
class TickClock {
public:
    explicit TickClock(std::uint32_t tick_rate_hz) : tick_rate_hz_(tick_rate_hz) {}

    void start(std::uint64_t start_us) { start_us_ = start_us; }
    /// Moves every tick by the length of a pause.
    void rebase(std::uint64_t pause_us) { start_us_ += pause_us; }

    /// Rounded down to whole us. \pre tick < 2^40
    std::uint64_t due_us(Tick tick) const { return start_us_ + tick * 1'000'000 / tick_rate_hz_; }

private:
    std::uint32_t tick_rate_hz_;
    std::uint64_t start_us_ = 0;
};

} // namespace lockwind
