#pragma once

#include "log/log_reader.h"

#include "lockwind/result.h"
#include "lockwind/world_simulation.h"

#include <cstdint>
#include <optional>
#include <string>

namespace lockwind {

struct RerecordResult {
    Tick ticks = 0;               // the last tick that was stepped
    std::uint64_t state_hash = 0; // of state(ticks)
    std::uint64_t bytes = 0;      // of the new log
    /// Where the new log is not the old one's valid bytes. Behind them it may go on: a kill may
    /// have come before the last tick's keyframe or events.
    std::optional<std::uint64_t> first_different_byte;
    std::string failure; // why a step of the log could not be taken
    LogEnd ended = LogEnd::interrupted;
    std::string damage;
};

/// Steps `simulation`, which is at state(0), through the log's inputs and writes the log that this
/// build would have recorded of them to `path`, which must not exist. Hashes, keyframes, events and
/// the summary's state hash are computed; copied is what no replay can know: settings, inputs,
/// arrivals, pauses, reported desyncs, build_info and the wall clock. An Error where the log does
/// not fit the simulation or `path` cannot be written.
Result<RerecordResult>
rerecord(LogReader& log, WorldSimulation& simulation, const std::string& path);

/// One JSON object.
std::string rerecord_json(const RerecordResult& result);
/// For a person; ends with a newline.
std::string rerecord_text(const RerecordResult& result);
/// 0, 1 (the bytes differ or a step failed) or 3 (the log is damaged).
int rerecord_exit_code(const RerecordResult& result);

} // namespace lockwind
