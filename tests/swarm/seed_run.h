#pragma once

#include "tests/swarm/plant.h"

#include "lockwind/types.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lockwind::swarm {

struct SwarmSettings {
    std::string scene_name = "swarm_small";
    std::string scene_text;
    Tick ticks = kDefaultTicks;
    Plant plant = Plant::none;
    std::string folder; // for the logs, which are removed again

    static constexpr Tick kDefaultTicks = 600;
};

/// Counts of one seed, and, added up, of many.
struct SwarmFigures {
    std::uint64_t ticks = 0;    // confirmed
    std::uint64_t contacts = 0; // contact points, over all ticks
    std::uint64_t hashes_agreed = 0;
    std::uint64_t joins = 0;
    std::uint64_t drops = 0;
    std::uint64_t reconnects = 0;
    std::uint64_t stalls = 0;
    std::uint64_t late_inputs = 0;
    std::uint64_t substituted_inputs = 0;
    std::uint64_t late_joins = 0; // by players who came after the start
    std::uint64_t partitions = 0; // one-way ones included
    std::uint64_t one_way_partitions = 0;
    std::uint64_t storms = 0;
    std::uint64_t freezes = 0; // the server's included
    std::uint64_t kills = 0;
    std::uint64_t leaves = 0;
    std::uint64_t packets_lost = 0;
    std::uint64_t packets_duplicated = 0;
    std::uint64_t packets_reordered = 0;
    std::uint64_t virtual_us = 0;

    SwarmFigures& operator+=(const SwarmFigures& other);
};

struct SeedResult {
    std::uint64_t seed = 0;
    SwarmFigures figures;
    std::uint64_t digest = 0;
    std::vector<std::string> failures; // the first few; none: all promises were kept
    std::vector<std::string> timeline; // in virtual time
};

/// Plays one match of the shipped server and bots under the seed's faults, heals them, and checks
/// what everybody saw. The same arguments give the same result, the folder aside.
SeedResult run_seed(std::uint64_t seed, const SwarmSettings& settings);

} // namespace lockwind::swarm
