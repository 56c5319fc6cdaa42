#pragma once

#include "log/log_reader.h"
#include "log/record_file.h"

#include "lockwind/event.h"
#include "lockwind/result.h"
#include "lockwind/simulation.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lockwind {

/// Appends a match's records to a new log. Each write_... is one write(2) of one whole record, so
/// that a kill at any moment leaves whole records only (and a machine's crash a torn last one). An
/// Error is final: the record was not written, the log keeps what it has, and the match must not
/// confirm the tick.
class LogWriter {
public:
    /// An existing file is never overwritten: Error.
    static Result<std::unique_ptr<LogWriter>> create(const std::string& path,
                                                     const LogHeader& header);

    /// Hash of state(0); before the first tick.
    Status write_start_hash(std::uint64_t hash);
    /// Inputs of a tick and, where it is due, the hash of state(tick): two records, one write(2),
    /// so that a kill leaves no tick that cannot be verified. Call before the tick's confirmation
    /// is sent. Ticks are consecutive from 1; one input per slot, none of them predicted.
    Status
    write_tick(Tick tick, std::span<const SlotInput> inputs, std::optional<std::uint64_t> hash);
    /// True where state(tick) is due as a keyframe (every kKeyframeIntervalTicks).
    static bool keyframe_due(Tick tick) { return tick % kKeyframeIntervalTicks == 0; }
    /// `state` as Simulation::save gives it, of the last tick written; stored compressed.
    Status write_keyframe(Tick tick, std::uint64_t hash, std::span<const std::byte> state);
    Status write_join(const JoinRecord& join);
    Status write_leave(const LeaveRecord& leave);
    Status write_pause(const PauseRecord& pause);
    Status write_setting(const SettingRecord& setting);
    Status write_events(Tick tick, std::span<const Event> events);
    Status write_desync(const DesyncRecord& desync);
    /// The last record; nothing may follow.
    Status write_summary(const LogSummary& summary);

    const std::string& path() const { return file_.path(); }
    std::uint64_t size_bytes() const { return file_.size_bytes(); }
    /// The last tick written; 0 before the first.
    Tick last_tick() const { return last_tick_; }

private:
    LogWriter(RecordWriter file, const LogHeader& header);
    Status append(const LogRecord& record);

    RecordWriter file_;
    std::uint32_t players_;
    std::uint32_t input_size_bytes_;
    Tick last_tick_ = 0;
    bool ended_ = false;
};

} // namespace lockwind
