#pragma once

#include "lockwind/slot_input.h"

#include <cstdint>

namespace lockwind {

/// What a player asks of a pod in one tick. Encoded little-endian in kPlayerInputSizeBytes; every
/// bit pattern is valid.
struct PlayerInput {
    static constexpr std::uint16_t kJump = 1;
    static constexpr std::uint16_t kShoot = 2;

    std::int16_t thrust = 0; // -32767 .. 32767: full back .. full ahead
    std::int16_t turn =
        0; // -32767 .. 32767: full left .. full right (clockwise from above, about -y)
    std::uint16_t buttons = 0;

    bool operator==(const PlayerInput&) const = default;
};

inline constexpr std::uint32_t kPlayerInputSizeBytes = 6;

/// Writes the bytes; the status stays as it is.
void encode(const PlayerInput& input, SlotInput& out);
PlayerInput decode_player_input(const SlotInput& input);

} // namespace lockwind
