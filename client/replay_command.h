#pragma once

#include "lockwind/types.h"

#include <optional>
#include <string>

namespace lockwind {

/// The command line of `lockwind replay`.
struct ReplayCommandOptions {
    std::string log;
    bool verify = false;
    std::optional<Tick> from;
    std::optional<Tick> to;
    std::string trace;         // file to write a trace to; "" for none
    bool trace_states = false; // with states, so that a diff names the field
    std::string snapshot;      // file to write the last state to; "" for none
    std::string rerecord;      // file to write the log as recorded here to; "" for none
    std::string bisect;        // another build's lockwind; "" for none
    bool json = false;
};

/// Replays a log; prints the report; returns the exit code.
int run_replay(const ReplayCommandOptions& options);

} // namespace lockwind
