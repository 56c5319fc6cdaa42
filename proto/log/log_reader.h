#pragma once

#include "log/log_format.h"
#include "log/record_file.h"

#include "lockwind/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace lockwind {

using LogRecord = std::variant<TickRecord,
                               HashRecord,
                               KeyframeRecord,
                               JoinRecord,
                               LeaveRecord,
                               PauseRecord,
                               SettingRecord,
                               EventsRecord,
                               DesyncRecord,
                               LogSummary>;

/// Reads a log record by record; holds one record. A file may hold anything: what is wrong ends the
/// log as `damaged`, and all before it is good.
class LogReader {
public:
    /// An Error where the file is missing, not a log, or has no whole header.
    static Result<LogReader> open(const std::string& path);

    const LogHeader& header() const { return header_; }
    const std::string& path() const { return file_.path(); }

    /// Nothing at the end: then ended(), valid_bytes() and damage() tell how it ends.
    std::optional<LogRecord> next();
    LogEnd ended() const { return ended_; }
    /// Bytes up to the end of the last good record.
    std::uint64_t valid_bytes() const { return file_.offset(); }
    std::uint64_t file_bytes() const { return file_.file_bytes(); }
    /// What is wrong where ended() is `damaged`.
    const std::string& damage() const { return damage_; }

    /// The next record is again the first after the header.
    void rewind();
    /// Goes on with the record that begins at `offset` (a value that offset() had); `last_tick` is
    /// the last tick before it.
    void seek(std::uint64_t offset, Tick last_tick);
    /// Where the record that next() gives next begins.
    std::uint64_t offset() const { return file_.offset(); }

private:
    LogReader(RecordReader file, LogHeader header, std::uint64_t first_offset);
    std::optional<LogRecord> fail(std::string what);
    std::string check(const LogRecord& record) const;

    RecordReader file_;
    LogHeader header_;
    std::uint64_t first_offset_;
    Tick last_tick_ = 0;
    bool summary_read_ = false;
    bool done_ = false;
    LogEnd ended_ = LogEnd::interrupted;
    std::string damage_;
    std::string payload_;
};

/// What one pass over a log finds.
struct LogIndex {
    struct Keyframe {
        Tick tick = 0;
        std::uint64_t offset = 0; // of the keyframe's record
    };
    Tick ticks = 0;          // last whole tick
    Tick hashed_to_tick = 0; // last tick with a hash: as far as a replay can verify
    std::uint64_t hashes = 0;
    std::uint64_t substituted_inputs = 0;
    std::uint64_t events = 0;
    std::uint32_t joins = 0;
    std::uint32_t leaves = 0;
    std::uint32_t pauses = 0;
    std::uint32_t desyncs = 0;
    std::vector<Keyframe> keyframes; // ascending
    std::optional<LogSummary> summary;
    LogEnd ended = LogEnd::interrupted;
    std::uint64_t valid_bytes = 0;
    std::uint64_t file_bytes = 0;
    std::string damage;
};

/// Reads the whole log, checking every record; leaves the reader rewound.
LogIndex index_log(LogReader& reader);

} // namespace lockwind
