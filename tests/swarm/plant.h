#pragma once

#include "bot/bot.h"
#include "tests/swarm/watched_transport.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace lockwind::swarm {

/// Bugs that the swarm must find. Each is a double at a client's wire, which says there what a
/// client with the bug would say: the shipped code has no hook for it.
enum class Plant : std::uint8_t {
    none = 0,
    unconfirmed_hash = 1, // a predicted state is hashed and reported
    reordered_input = 2,  // where confirmations overtake each other, an input is forgotten
    missing_field = 3,    // the snapshot that a client loads lacks a field
};

/// All but none.
std::span<const std::string_view> plant_names();
std::string_view to_string(Plant plant);
std::optional<Plant> find_plant(std::string_view name);

/// To be added to the client's incoming and outgoing messages; nullptr for none. Holds the
/// references.
std::unique_ptr<WireTap> make_plant(Plant plant, const MatchConfig& config, const Bot& bot);

} // namespace lockwind::swarm
