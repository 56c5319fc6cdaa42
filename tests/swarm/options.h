#pragma once

#include "tests/swarm/seed_run.h"
#include "tests/swarm/workers.h"

#include <optional>

namespace lockwind::swarm {

/// The command line of lockwind-swarm.
struct SwarmOptions {
    WorkerSettings workers;
    SwarmSettings swarm; // scene_text and folder not yet filled in
    bool verbose = false;
    bool json = false;
};

/// What parsing came to: options, or a reason to exit at once, already said.
struct ParsedOptions {
    std::optional<SwarmOptions> options;
    int exit_code = 0;
};

ParsedOptions parse_options(int argc, const char* const* argv);

} // namespace lockwind::swarm
