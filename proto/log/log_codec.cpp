#include "log/log_codec.h"

#include "log.pb.h"
#include "log/quiet_parse.h"
#include "session/match_config.h"

#include <algorithm>

namespace lockwind {

namespace {

std::string bytes_text(std::span<const std::byte> bytes) {
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

std::vector<std::byte> text_bytes(const std::string& text) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(text.data(), text.size()));
    return {bytes.begin(), bytes.end()};
}

/// Fills one kind of the oneof from one kind of the variant.
struct Encoder {
    log_format::Record& out;
    std::uint32_t input_size_bytes;

    void operator()(const TickRecord& record) const {
        log_format::Tick& tick = *out.mutable_tick();
        tick.set_tick(record.tick);
        for (const SlotInput& input : record.inputs) {
            tick.mutable_statuses()->push_back(static_cast<char>(input.status));
            tick.mutable_inputs()->append(reinterpret_cast<const char*>(input.bytes.data()),
                                          input_size_bytes);
        }
    }
    void operator()(const HashRecord& record) const {
        out.mutable_hash()->set_tick(record.tick);
        out.mutable_hash()->set_hash(record.hash);
    }
    void operator()(const KeyframeRecord& record) const {
        out.mutable_keyframe()->set_tick(record.tick);
        out.mutable_keyframe()->set_hash(record.hash);
        out.mutable_keyframe()->set_packed_state(bytes_text(record.packed_state));
    }
    void operator()(const JoinRecord& record) const {
        out.mutable_join()->set_tick(record.tick);
        out.mutable_join()->set_slot(record.slot);
        out.mutable_join()->set_reconnect(record.reconnect);
        out.mutable_join()->set_build_info(record.build_info);
    }
    void operator()(const LeaveRecord& record) const {
        out.mutable_leave()->set_tick(record.tick);
        out.mutable_leave()->set_slot(record.slot);
        out.mutable_leave()->set_reason(static_cast<std::uint32_t>(record.reason));
    }
    void operator()(const PauseRecord& record) const {
        out.mutable_pause()->set_tick(record.tick);
        out.mutable_pause()->set_paused_us(record.paused_us);
        out.mutable_pause()->set_reason(record.reason);
    }
    void operator()(const SettingRecord& record) const {
        out.mutable_setting()->set_tick(record.tick);
        out.mutable_setting()->set_name(record.name);
        out.mutable_setting()->set_value(record.value);
    }
    void operator()(const EventsRecord& record) const {
        out.mutable_events()->set_tick(record.tick);
        for (const Event& event : record.events) {
            log_format::Event& added = *out.mutable_events()->add_events();
            added.set_type(static_cast<std::uint32_t>(event.type));
            added.set_a(event.a);
            added.set_b(event.b);
            added.set_value(event.value);
        }
    }
    void operator()(const DesyncRecord& record) const {
        out.mutable_desync()->set_tick(record.tick);
        out.mutable_desync()->set_slot(record.slot);
        out.mutable_desync()->set_server_hash(record.server_hash);
        out.mutable_desync()->set_client_hash(record.client_hash);
    }
    void operator()(const LogSummary& record) const {
        log_format::Summary& summary = *out.mutable_summary();
        summary.set_ticks(record.ticks);
        summary.set_state_hash_tick(record.state_hash_tick);
        summary.set_state_hash(record.state_hash);
        summary.set_desyncs(record.desyncs);
        summary.set_reason(static_cast<std::uint32_t>(record.reason));
        summary.set_message(record.message);
        summary.set_ended_unix_us(record.ended_unix_us);
    }
};

Result<LogRecord> decode_tick(const log_format::Tick& message, const LogHeader& header) {
    const std::size_t players = header.config.players;
    const std::size_t size = header.input_size_bytes;
    if (message.statuses().size() != players || message.inputs().size() != players * size) {
        return Error{"tick " + std::to_string(message.tick()) + " does not hold " +
                     std::to_string(players) + " inputs of " + std::to_string(size) + " bytes"};
    }
    TickRecord record{message.tick(), std::vector<SlotInput>(players)};
    for (std::size_t slot = 0; slot < players; ++slot) {
        const auto status = static_cast<std::uint8_t>(message.statuses()[slot]);
        if (status > static_cast<std::uint8_t>(InputStatus::disconnected)) {
            return Error{"tick " + std::to_string(message.tick()) + ", slot " +
                         std::to_string(slot) + ": unknown input status " + std::to_string(status)};
        }
        record.inputs[slot].status = static_cast<InputStatus>(status);
        std::copy_n(reinterpret_cast<const std::uint8_t*>(message.inputs().data()) + slot * size,
                    size,
                    record.inputs[slot].bytes.begin());
    }
    return LogRecord(std::move(record));
}

Result<LogRecord> decode_leave(const log_format::Leave& message) {
    if (message.reason() > static_cast<std::uint32_t>(LeaveReason::kicked)) {
        return Error{"unknown reason " + std::to_string(message.reason()) + " of a leave"};
    }
    return LogRecord(
        LeaveRecord{message.tick(), message.slot(), static_cast<LeaveReason>(message.reason())});
}

Result<LogRecord> decode_events(const log_format::Events& message) {
    EventsRecord record{message.tick(), {}};
    for (const log_format::Event& event : message.events()) {
        if (event.type() > static_cast<std::uint32_t>(EventType::score)) {
            return Error{"unknown event type " + std::to_string(event.type())};
        }
        record.events.push_back(
            {static_cast<EventType>(event.type()), event.a(), event.b(), event.value()});
    }
    return LogRecord(std::move(record));
}

Result<LogRecord> decode_summary(const log_format::Summary& message) {
    if (message.reason() > static_cast<std::uint32_t>(EndReason::failed)) {
        return Error{"unknown reason " + std::to_string(message.reason()) + " of the end"};
    }
    LogSummary record;
    record.ticks = message.ticks();
    record.state_hash_tick = message.state_hash_tick();
    record.state_hash = message.state_hash();
    record.desyncs = message.desyncs();
    record.reason = static_cast<EndReason>(message.reason());
    record.message = message.message();
    record.ended_unix_us = message.ended_unix_us();
    return LogRecord(std::move(record));
}

} // namespace

void encode_config(const MatchConfig& config, log_format::MatchConfig& out) {
    out.set_match(config.match);
    out.set_mode(config.mode);
    out.set_scene_name(config.scene_name);
    out.set_scene_text(config.scene_text);
    out.set_seed(config.seed);
    out.set_tick_rate_hz(config.tick_rate_hz);
    out.set_players(config.players);
    out.set_input_delay_ticks(config.input_delay_ticks);
    out.set_hash_interval_ticks(config.hash_interval_ticks);
    out.set_ticks(config.ticks);
}

MatchConfig decode_config(const log_format::MatchConfig& message) {
    MatchConfig config;
    config.match = message.match();
    config.mode = message.mode();
    config.scene_name = message.scene_name();
    config.scene_text = message.scene_text();
    config.seed = message.seed();
    config.tick_rate_hz = message.tick_rate_hz();
    config.players = message.players();
    config.input_delay_ticks = message.input_delay_ticks();
    config.hash_interval_ticks = message.hash_interval_ticks();
    config.ticks = message.ticks();
    return config;
}

Status check_readable(const MatchConfig& config) {
    if (config.players < 1 || config.players > kPlayersMax) {
        return Error{"header: players is " + std::to_string(config.players) + ", not 1 to " +
                     std::to_string(kPlayersMax)};
    }
    if (config.tick_rate_hz < 1 || config.tick_rate_hz > kTickRateHzMax) {
        return Error{"header: tick_rate_hz is " + std::to_string(config.tick_rate_hz) +
                     ", not 1 to " + std::to_string(kTickRateHzMax)};
    }
    return Success{};
}

std::string encode_header(const LogHeader& header) {
    log_format::Record message;
    log_format::Header& out = *message.mutable_header();
    out.set_format_version(header.format_version);
    out.set_sim_version(header.sim_version);
    out.set_build_info(header.build_info);
    out.set_started_unix_us(header.started_unix_us);
    encode_config(header.config, *out.mutable_config());
    out.set_input_size_bytes(header.input_size_bytes);
    return message.SerializeAsString();
}

Result<LogHeader> decode_header(std::string_view payload) {
    log_format::Record message;
    if (!parse_quietly(payload, message)) {
        return Error{"the header does not parse; its texts must be UTF-8"};
    }
    if (!message.has_header()) {
        return Error{"the first record is no header"};
    }
    LogHeader header;
    header.format_version = message.header().format_version();
    header.sim_version = message.header().sim_version();
    header.build_info = message.header().build_info();
    header.started_unix_us = message.header().started_unix_us();
    header.config = decode_config(message.header().config());
    header.input_size_bytes = message.header().input_size_bytes();
    if (header.format_version == 0 || header.format_version > kLogFormatVersion) {
        return Error{"log format " + std::to_string(header.format_version) +
                     " is not known here (up to " + std::to_string(kLogFormatVersion) +
                     "); read it with a newer lockwind"};
    }
    if (Status status = check_readable(header.config); !status) {
        return status.error();
    }
    if (header.input_size_bytes < 1 || header.input_size_bytes > kInputSizeBytesMax) {
        return Error{"header: input_size_bytes is " + std::to_string(header.input_size_bytes) +
                     ", not 1 to " + std::to_string(kInputSizeBytesMax)};
    }
    return header;
}

std::string encode_record(const LogRecord& record, std::uint32_t input_size_bytes) {
    log_format::Record message;
    std::visit(Encoder{message, input_size_bytes}, record);
    return message.SerializeAsString();
}

Result<LogRecord> decode_record(std::string_view payload, const LogHeader& header) {
    log_format::Record message;
    if (!parse_quietly(payload, message)) {
        return Error{"a record that does not parse"};
    }
    switch (message.kind_case()) {
    case log_format::Record::kTick:
        return decode_tick(message.tick(), header);
    case log_format::Record::kHash:
        return LogRecord(HashRecord{message.hash().tick(), message.hash().hash()});
    case log_format::Record::kKeyframe:
        return LogRecord(KeyframeRecord{message.keyframe().tick(),
                                        message.keyframe().hash(),
                                        text_bytes(message.keyframe().packed_state())});
    case log_format::Record::kJoin:
        return LogRecord(JoinRecord{message.join().tick(),
                                    message.join().slot(),
                                    message.join().reconnect(),
                                    message.join().build_info()});
    case log_format::Record::kLeave:
        return decode_leave(message.leave());
    case log_format::Record::kPause:
        return LogRecord(PauseRecord{
            message.pause().tick(), message.pause().paused_us(), message.pause().reason()});
    case log_format::Record::kSetting:
        return LogRecord(SettingRecord{
            message.setting().tick(), message.setting().name(), message.setting().value()});
    case log_format::Record::kEvents:
        return decode_events(message.events());
    case log_format::Record::kDesync:
        return LogRecord(DesyncRecord{message.desync().tick(),
                                      message.desync().slot(),
                                      message.desync().server_hash(),
                                      message.desync().client_hash()});
    case log_format::Record::kSummary:
        return decode_summary(message.summary());
    case log_format::Record::kHeader:
        return Error{"a second header"};
    case log_format::Record::KIND_NOT_SET:
        break;
    }
    return Error{"a record of an unknown kind"};
}

} // namespace lockwind
