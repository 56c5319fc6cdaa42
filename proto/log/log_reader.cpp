#include "log/log_reader.h"

#include "log/log_codec.h"

#include <algorithm>
#include <utility>

namespace lockwind {

namespace {

/// Number of keyframes that an index holds: one each ten seconds for a month at 60 Hz.
constexpr std::size_t kIndexedKeyframesMax = 1U << 18U;

std::string tick_text(Tick tick) {
    return std::to_string(tick);
}

} // namespace

LogReader::LogReader(RecordReader file, LogHeader header, std::uint64_t first_offset)
    : file_(std::move(file)), header_(std::move(header)), first_offset_(first_offset) {}

Result<LogReader> LogReader::open(const std::string& path) {
    Result<RecordReader> file = RecordReader::open(path, FileKind::log);
    if (!file) {
        return file.error();
    }
    std::string payload;
    if (file.value().next(payload) != RecordRead::record) {
        return Error{path + ": the header is not whole: nothing can be read"};
    }
    Result<LogHeader> header = decode_header(payload);
    if (!header) {
        return Error{path + ": " + header.error().message};
    }
    const std::uint64_t first_offset = file.value().offset();
    return LogReader(std::move(file).value(), std::move(header).value(), first_offset);
}

std::string LogReader::check(const LogRecord& record) const {
    if (summary_read_) {
        return "a record behind the summary";
    }
    if (const auto* tick = std::get_if<TickRecord>(&record);
        tick != nullptr && tick->tick != last_tick_ + 1) {
        return "tick " + tick_text(tick->tick) + " follows tick " + tick_text(last_tick_);
    }
    if (const auto* hash = std::get_if<HashRecord>(&record);
        hash != nullptr && hash->tick != last_tick_) {
        return "hash of tick " + tick_text(hash->tick) + " behind tick " + tick_text(last_tick_);
    }
    if (const auto* keyframe = std::get_if<KeyframeRecord>(&record);
        keyframe != nullptr && keyframe->tick != last_tick_) {
        return "keyframe of tick " + tick_text(keyframe->tick) + " behind tick " +
               tick_text(last_tick_);
    }
    if (const auto* summary = std::get_if<LogSummary>(&record);
        summary != nullptr && summary->ticks != last_tick_) {
        return "summary of " + tick_text(summary->ticks) + " ticks behind tick " +
               tick_text(last_tick_);
    }
    return "";
}

std::optional<LogRecord> LogReader::fail(std::string what) {
    done_ = true;
    ended_ = LogEnd::damaged;
    damage_ = std::move(what);
    return std::nullopt;
}

std::optional<LogRecord> LogReader::next() {
    if (done_) {
        return std::nullopt;
    }
    const std::uint64_t start = file_.offset();
    switch (file_.next(payload_)) {
    case RecordRead::end:
        done_ = true;
        ended_ = summary_read_ ? LogEnd::summary : LogEnd::interrupted;
        return std::nullopt;
    case RecordRead::damaged:
        return fail(file_.damage());
    case RecordRead::record:
        break;
    }
    Result<LogRecord> record = decode_record(payload_, header_);
    const std::string wrong = record ? check(record.value()) : record.error().message;
    if (!wrong.empty()) {
        file_.seek(start);
        return fail("at byte " + std::to_string(start) + ": " + wrong);
    }
    if (const auto* tick = std::get_if<TickRecord>(&record.value())) {
        last_tick_ = tick->tick;
    }
    summary_read_ = std::holds_alternative<LogSummary>(record.value());
    return std::move(record).value();
}

void LogReader::rewind() {
    seek(first_offset_, 0);
}

void LogReader::seek(std::uint64_t offset, Tick last_tick) {
    file_.seek(offset);
    last_tick_ = last_tick;
    summary_read_ = false;
    done_ = false;
    ended_ = LogEnd::interrupted;
    damage_.clear();
}

namespace {

/// Adds what one record tells.
struct Indexer {
    LogIndex& index;
    std::uint64_t offset;

    void operator()(const TickRecord& record) const {
        index.ticks = record.tick;
        index.substituted_inputs += static_cast<std::uint64_t>(
            std::count_if(record.inputs.begin(), record.inputs.end(), [](const SlotInput& input) {
                return input.status == InputStatus::substituted;
            }));
    }
    void operator()(const HashRecord& record) const {
        index.hashed_to_tick = record.tick;
        index.hashes += 1;
    }
    void operator()(const KeyframeRecord& record) const {
        if (index.keyframes.size() < kIndexedKeyframesMax) {
            index.keyframes.push_back({record.tick, offset});
        }
    }
    void operator()(const JoinRecord&) const { index.joins += 1; }
    void operator()(const LeaveRecord&) const { index.leaves += 1; }
    void operator()(const PauseRecord&) const { index.pauses += 1; }
    void operator()(const SettingRecord&) const {}
    void operator()(const EventsRecord& record) const { index.events += record.events.size(); }
    void operator()(const DesyncRecord&) const { index.desyncs += 1; }
    void operator()(const LogSummary& record) const { index.summary = record; }
};

} // namespace

LogIndex index_log(LogReader& reader) {
    LogIndex index;
    reader.rewind();
    std::uint64_t offset = reader.offset();
    while (const std::optional<LogRecord> record = reader.next()) {
        std::visit(Indexer{index, offset}, *record);
        offset = reader.offset();
    }
    index.ended = reader.ended();
    index.valid_bytes = reader.valid_bytes();
    index.file_bytes = reader.file_bytes();
    index.damage = reader.damage();
    reader.rewind();
    return index;
}

} // namespace lockwind
