#pragma once

#include "log/log_reader.h"

#include "lockwind/result.h"
#include "lockwind/simulation.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace lockwind {

class TraceSink;

struct ReplayOptions {
    bool verify = false; // compare every hash and keyframe that the log has
    std::optional<Tick>
        from; // first tick to step; what is before is skipped from the keyframe before it
    std::optional<Tick> to;     // last tick to step
    TraceSink* trace = nullptr; // gets the phases of from .. to
    bool trace_states = false;
    std::function<void(Tick tick, Tick last)> progress; // called now and then
};

struct ReplayResult {
    Tick ticks = 0; // the last tick that was stepped
    std::uint64_t hashes_checked = 0;
    std::uint64_t hashes_wrong = 0;
    std::optional<Tick> first_bad_tick;
    std::uint64_t expected_hash = 0; // of first_bad_tick, as logged
    std::uint64_t actual_hash = 0;   // of first_bad_tick, as replayed
    std::string failure;             // why a step of the log could not be taken
    std::uint64_t state_hash = 0;    // of state(ticks)
    Tick verified_to_tick = 0;       // last tick whose hash was right, all before it too
    LogEnd ended = LogEnd::interrupted;
    std::uint64_t valid_bytes = 0;
    std::string damage;
    double realtime_factor = 0.0; // simulated time / wall time
};

/// Steps `simulation`, which is at state(0), through the log. What verification finds is told,
/// never corrected. An Error where the simulation does not fit the log or `from` cannot be reached.
Result<ReplayResult> replay(LogReader& log, Simulation& simulation, const ReplayOptions& options);

/// One JSON object with the fields of the contract.
std::string replay_json(const ReplayResult& result);
/// For a person; ends with a newline.
std::string replay_text(const ReplayResult& result);
/// 0, 1 (a hash was wrong or a step failed) or 3 (the log is damaged).
int replay_exit_code(const ReplayResult& result);

} // namespace lockwind
