#pragma once

#include "lockwind/player_input.h"
#include "lockwind/result.h"
#include "lockwind/world.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace lockwind {

/// Decides a bot's input from the last confirmed state. Its decisions travel as inputs, so that a
/// log replays without it.
class Behaviour {
public:
    virtual ~Behaviour() = default;
    /// The input of `tick`, the slot's next one to send.
    virtual PlayerInput decide(const World& world, Slot slot, Tick tick) = 0;
};

/// Names that make_behaviour takes, in order of the help text.
std::span<const std::string_view> behaviour_names();

/// `seed` draws the bot's whims. An Error lists the names.
Result<std::unique_ptr<Behaviour>> make_behaviour(std::string_view name, std::uint64_t seed);

} // namespace lockwind
