#pragma once

#include "tests/swarm/options.h"
#include "tests/swarm/seed_run.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lockwind::swarm {

/// All seeds of a run.
struct SwarmReport {
    std::uint64_t seeds = 0;
    std::uint64_t failures = 0; // seeds that failed
    std::optional<std::uint64_t> first_failing_seed;
    SwarmFigures total;
    std::uint64_t digest = 0;         // of the seeds' digests
    std::vector<std::string> vacuous; // what should have happened somewhere and did not
};

/// Fewest seeds of which everything that the swarm is about must have happened.
inline constexpr std::uint64_t kSeedsForVacuity = 50;

SwarmReport sum_up(const std::vector<SeedResult>& results);
/// Nothing failed, and it was worth something.
bool passed(const SwarmReport& report);

/// How to see this seed again.
std::string replay_command(std::uint64_t seed, const SwarmOptions& options);
/// For a person; ends with a newline.
std::string report_text(const SwarmReport& report, const SwarmOptions& options);
/// One JSON object.
std::string report_json(const SwarmReport& report, const SwarmOptions& options);

} // namespace lockwind::swarm
