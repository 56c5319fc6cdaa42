#pragma once

#include "session/violation.h"

#include "lockwind/simulation.h"
#include "lockwind/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lockwind {

/// How far ahead of the confirmed tick an input may be, and how far behind one may repeat it.
inline constexpr Tick kInputWindowTicks = 128;

/// One slot's inputs as they arrive, doubled and in any order. The first input of a tick stays.
class InputBuffer {
public:
    explicit InputBuffer(std::uint32_t input_size_bytes) : input_size_bytes_(input_size_bytes) {}

    /// Forgets everything (another holder has the slot).
    void reset();
    /// Inputs of ticks after `tick` that come when their tick is confirmed count as late.
    void count_late_after(Tick tick) { late_after_tick_ = tick; }

    /// Takes the inputs of first_tick, first_tick + 1 ...; gives how many were late. What is
    /// outside the window, changed or malformed is left out and counted, each rule once a call.
    std::uint32_t receive(Tick first_tick,
                          std::span<const SlotInput> inputs,
                          Tick confirmed_tick,
                          ViolationCounts& violations);

    /// nullptr where it has not arrived (or is older than the window).
    const SlotInput* find(Tick tick) const;
    /// All inputs after confirmed_tick up to this one have arrived.
    Tick contiguous_tick(Tick confirmed_tick) const;

private:
    struct Entry {
        Tick tick = 0; // 0: none; tick 0 has no inputs
        SlotInput input;
    };

    bool well_formed(const SlotInput& input) const;
    static std::size_t index_of(Tick tick) {
        return static_cast<std::size_t>(tick % (2 * kInputWindowTicks));
    }

    std::uint32_t input_size_bytes_;
    Tick late_after_tick_ = ~Tick{0};
    // Tick T is at T modulo the size; the window ahead and the one behind share no place.
    std::array<Entry, 2 * kInputWindowTicks> entries_{};
};

} // namespace lockwind
