#pragma once

#include "replay_command.h"

namespace lockwind {

/// `lockwind replay LOG --bisect BINARY`: has this program and another build's `lockwind` trace the
/// log, finds the first tick where they part, traces that one again with states, and prints the
/// diff. Returns the exit code: 0 where they agree, 1 where they do not.
int run_bisect(const ReplayCommandOptions& options);

} // namespace lockwind
