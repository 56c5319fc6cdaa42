#pragma once

#include "lockwind/schema.h"
#include "lockwind/types.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace lockwind {

/// What a slot's player carries from tick to tick: row of section "player", one a slot, in slot
/// order.
struct Player {
    BodyId body;              // the pod
    std::uint64_t draw_count; // random numbers drawn, the counter of stream (seed, body)
    std::uint32_t score;
    std::uint32_t cooldown_ticks; // until the next shot
    std::uint16_t last_buttons;   // of the last tick
    std::uint8_t shooting;        // 1: a ball leaves the muzzle when this tick's bodies are spawned
    std::uint8_t zero[5];
};
static_assert(sizeof(Player) == 32);

inline constexpr std::array kPlayerFields{
    LOCKWIND_FIELD(Player, body, 0, "", ""),
    LOCKWIND_FIELD(Player, draw_count, 0, "", ""),
    LOCKWIND_FIELD(Player, score, 0, "", ""),
    LOCKWIND_FIELD(Player, cooldown_ticks, 0, "tick", ""),
    LOCKWIND_FIELD(Player, last_buttons, 0, "", ""),
    LOCKWIND_FIELD(Player, shooting, 0, "", ""),
    LOCKWIND_FIELD(Player, zero, 0, "", ""),
};

} // namespace lockwind
