#include "log/log_writer.h"

#include "codec/utf8.h"
#include "log/log_codec.h"
#include "log/state_pack.h"

#include <algorithm>
#include <utility>

namespace lockwind {

LogWriter::LogWriter(RecordWriter file, const LogHeader& header)
    : file_(std::move(file)), players_(header.config.players),
      input_size_bytes_(header.input_size_bytes) {}

Result<std::unique_ptr<LogWriter>> LogWriter::create(const std::string& path,
                                                     const LogHeader& header) {
    for (const std::string* text : {&header.sim_version,
                                    &header.build_info,
                                    &header.config.match,
                                    &header.config.mode,
                                    &header.config.scene_name,
                                    &header.config.scene_text}) {
        if (!is_utf8(*text)) {
            return Error{path + ": the match's settings or its scene are not UTF-8 text"};
        }
    }
    const std::string payload = encode_header(header);
    // What a reader would refuse is refused before the match.
    if (const Result<LogHeader> checked = decode_header(payload); !checked) {
        return Error{path + ": " + checked.error().message};
    }
    Result<RecordWriter> file = RecordWriter::create(path, FileKind::log, payload);
    if (!file) {
        return file.error();
    }
    return std::unique_ptr<LogWriter>(new LogWriter(std::move(file).value(), header));
}

Status LogWriter::append(const LogRecord& record) {
    LOCKWIND_ASSERT(!ended_);
    return file_.write(encode_record(record, input_size_bytes_));
}

Status LogWriter::write_start_hash(std::uint64_t hash) {
    LOCKWIND_ASSERT(last_tick_ == 0);
    return append(HashRecord{0, hash});
}

Status LogWriter::write_tick(Tick tick,
                             std::span<const SlotInput> inputs,
                             std::optional<std::uint64_t> hash) {
    LOCKWIND_ASSERT(!ended_);
    LOCKWIND_ASSERT(tick == last_tick_ + 1 && inputs.size() == players_);
    LOCKWIND_ASSERT(std::none_of(inputs.begin(), inputs.end(), [](const SlotInput& input) {
        return input.status == InputStatus::predicted;
    }));
    const std::string record =
        encode_record(TickRecord{tick, {inputs.begin(), inputs.end()}}, input_size_bytes_);
    Status status = hash ? file_.stage(record) : file_.write(record);
    if (status && hash) {
        status = append(HashRecord{tick, *hash});
    }
    if (status) {
        last_tick_ = tick;
    }
    return status;
}

Status LogWriter::write_keyframe(Tick tick, std::uint64_t hash, std::span<const std::byte> state) {
    LOCKWIND_ASSERT(tick == last_tick_);
    return append(KeyframeRecord{tick, hash, pack_state(state)});
}

Status LogWriter::write_join(const JoinRecord& join) {
    LOCKWIND_ASSERT(join.slot < players_);
    return append(join);
}

Status LogWriter::write_leave(const LeaveRecord& leave) {
    LOCKWIND_ASSERT(leave.slot < players_);
    return append(leave);
}

Status LogWriter::write_pause(const PauseRecord& pause) {
    return append(pause);
}

Status LogWriter::write_setting(const SettingRecord& setting) {
    return append(setting);
}

Status LogWriter::write_events(Tick tick, std::span<const Event> events) {
    return append(EventsRecord{tick, {events.begin(), events.end()}});
}

Status LogWriter::write_desync(const DesyncRecord& desync) {
    LOCKWIND_ASSERT(desync.slot < players_);
    return append(desync);
}

Status LogWriter::write_summary(const LogSummary& summary) {
    LOCKWIND_ASSERT(summary.ticks == last_tick_);
    Status status = append(summary);
    ended_ = true;
    return status ? file_.sync() : status;
}

} // namespace lockwind
