#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lockwind {

inline constexpr std::size_t kInputSizeBytesMax = 32;

/// Where a slot's input of a tick came from.
enum class InputStatus : std::uint8_t {
    confirmed = 0,    // the player sent it
    substituted = 1,  // the server repeated the last one
    disconnected = 2, // nobody holds the slot: all bytes are zero
    predicted = 3,    // a client's guess; never in a log
};

/// One slot's input of one tick, opaque to sessions; bytes behind the simulation's size are zero.
struct SlotInput {
    InputStatus status = InputStatus::disconnected;
    std::array<std::uint8_t, kInputSizeBytesMax> bytes{};

    bool operator==(const SlotInput&) const = default;
};

} // namespace lockwind
