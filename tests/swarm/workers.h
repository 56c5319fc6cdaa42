#pragma once

#include "tests/swarm/seed_run.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace lockwind::swarm {

struct WorkerSettings {
    std::uint64_t first_seed = 1;
    std::uint64_t seeds = 1;
    std::uint32_t jobs = 1;
    bool stop_at_failure = false; // no further seed begins once one has failed
};

/// Plays each seed in a process of its own, `jobs` at a time, so that an assert or an endless loop
/// is a failure of that seed and not the end of the run. The results, in order of their seeds, do
/// not depend on `jobs`; they have no timelines. With stop_at_failure the failing one is the last.
/// `progress` is called with each result as it comes.
std::vector<SeedResult> run_seeds(const WorkerSettings& workers,
                                  const std::function<SeedResult(std::uint64_t seed)>& play,
                                  const std::function<void(const SeedResult&)>& progress);

} // namespace lockwind::swarm
