#pragma once

#include "session/lockstep_server.h"
#include "session/messages.h"
#include "transport/sim/link_conditions.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lockwind::swarm {

enum class FaultKind : std::uint8_t {
    partition = 0,     // neither end hears the other
    deaf = 1,          // the client does not hear the server
    mute = 2,          // the server does not hear the client
    storm = 3,         // the link is far worse than usual
    freeze = 4,        // the client's process stands still
    kill = 5,          // it is gone; another with the same token comes at the end of the fault
    leave = 6,         // the same, by its own wish
    server_freeze = 7, // the server's process stands still
};

std::string_view to_string(FaultKind kind);

struct Fault {
    FaultKind kind = FaultKind::partition;
    std::uint32_t client = 0; // index; none of a client's faults overlap
    std::uint64_t begin_us = 0;
    std::uint64_t end_us = 0;
    LinkConditions conditions; // of a storm, both directions
};

/// One player. Times are of the network's clock, conditions of its links while nothing else is
/// wrong.
struct ClientPlan {
    std::string behaviour;
    std::uint64_t arrival_us = 0;
    LinkConditions up;
    LinkConditions down;
    std::uint64_t clock_offset_us = 0; // its clock shows so much at the network's 0
    std::int32_t clock_drift_ppm = 0;  // and runs faster by this
};

/// All that happens to one match: a function of the seed, and of the ticks and the scene asked for.
struct Scenario {
    MatchConfig config;
    StallPolicy stall_policy = StallPolicy::pause;
    std::uint32_t join_timeout_ms = 0;
    std::vector<ClientPlan> clients;
    std::vector<Fault> faults; // by begin_us
    std::uint64_t heal_us = 0; // all faults are over, all links are good, everybody is back
};

/// How many clients a seed may draw.
inline constexpr std::uint32_t kClientsMin = 2;
inline constexpr std::uint32_t kClientsMax = 8;
/// Fewest ticks of a match that leave time for faults and for coming back from them.
inline constexpr Tick kTicksMin = 600;

Scenario draw_scenario(std::uint64_t seed,
                       Tick ticks,
                       const std::string& scene_name,
                       const std::string& scene_text);

/// What the seed drew, a line each; faults are left out.
std::vector<std::string> describe(const Scenario& scenario);

} // namespace lockwind::swarm
