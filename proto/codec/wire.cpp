#include "codec/wire.h"

#include <algorithm>
#include <cstring>

namespace lockwind {
namespace {

static_assert(wire::REFUSE_REASON_MISCONDUCT == static_cast<int>(RefuseReason::misconduct));
static_assert(wire::RefuseReason_MAX == static_cast<int>(kRefuseReasonMax));
static_assert(wire::END_REASON_DROPPED == static_cast<int>(EndReason::dropped));
static_assert(wire::EndReason_MAX == static_cast<int>(kEndReasonMax));
static_assert(wire::BLOB_KIND_DESYNC_REPORT == static_cast<int>(BlobKind::desync_report));
static_assert(wire::BlobKind_MAX == static_cast<int>(kBlobKindMax));

/// Reads an open enum of the wire: any int32.
template <class Enum>
void read_enum(std::string_view field, int value, std::uint64_t max, Rules& rules, Enum& out) {
    const auto number = static_cast<std::uint64_t>(static_cast<std::uint32_t>(value));
    rules.at_most(field, number, max);
    if (number <= max) {
        out = static_cast<Enum>(number);
    }
}

void append_input(const SlotInput& input, std::size_t size_bytes, std::string& out) {
    out.append(reinterpret_cast<const char*>(input.bytes.data()), size_bytes);
}

SlotInput read_input(const std::string& inputs, std::size_t index, std::size_t size_bytes) {
    SlotInput input;
    input.status = InputStatus::confirmed;
    std::memcpy(input.bytes.data(), inputs.data() + index * size_bytes, size_bytes);
    return input;
}

void to_wire(const MatchConfig& config, wire::MatchConfig& out) {
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

void from_wire(const wire::MatchConfig& config, MatchConfig& out) {
    out.match = config.match();
    out.mode = config.mode();
    out.scene_name = config.scene_name();
    out.scene_text = config.scene_text();
    out.seed = config.seed();
    out.tick_rate_hz = config.tick_rate_hz();
    out.players = config.players();
    out.input_delay_ticks = config.input_delay_ticks();
    out.hash_interval_ticks = config.hash_interval_ticks();
    out.ticks = config.ticks();
}

void write_inputs(const Confirmation& message, wire::Confirmation& out) {
    const std::size_t size_bytes = input_size_bytes(message);
    const std::size_t slots = message.ticks.empty() ? 0 : message.ticks.front().inputs.size();
    out.set_tick_count(static_cast<std::uint32_t>(message.ticks.size()));
    out.set_slot_count(static_cast<std::uint32_t>(slots));
    out.set_input_size_bytes(static_cast<std::uint32_t>(size_bytes));
    std::string& inputs = *out.mutable_inputs();
    std::string& statuses = *out.mutable_statuses();
    inputs.reserve(message.ticks.size() * slots * size_bytes);
    statuses.reserve(message.ticks.size() * slots);
    bool all_confirmed = true;
    for (const ConfirmedTick& tick : message.ticks) {
        for (const SlotInput& input : tick.inputs) {
            append_input(input, size_bytes, inputs);
            statuses.push_back(static_cast<char>(input.status));
            all_confirmed = all_confirmed && input.status == InputStatus::confirmed;
        }
    }
    if (all_confirmed && size_bytes > 0) {
        statuses.clear();
    }
}

void read_inputs(const wire::Confirmation& message, Rules& rules, Confirmation& out) {
    const std::size_t ticks = message.tick_count();
    const std::size_t slots = message.slot_count();
    const std::size_t size_bytes = message.input_size_bytes();
    const std::string& statuses = message.statuses();
    rules.at_most("tick_count", ticks, kConfirmationTicksMax);
    rules.in_range("slot_count", slots, ticks == 0 ? 0 : 1, rules.limits().players_max);
    rules.at_most("input_size_bytes", size_bytes, kInputSizeBytesMax);
    if (!rules.kept()) {
        return;
    }
    rules.equal("bytes of inputs",
                message.inputs().size(),
                ticks * slots * size_bytes,
                "tick_count x slot_count x input_size_bytes");
    // Without a byte of its own an input would cost a peer nothing, and us memory.
    if (!statuses.empty() || size_bytes == 0) {
        rules.equal("bytes of statuses", statuses.size(), ticks * slots, "tick_count x slot_count");
    }
    for (const char status : statuses) {
        rules.at_most("status", static_cast<unsigned char>(status), kSentStatusMax);
    }
    if (!rules.kept()) {
        return;
    }
    out.ticks.resize(ticks);
    for (std::size_t i = 0; i < ticks * slots; ++i) {
        SlotInput input = read_input(message.inputs(), i, size_bytes);
        if (!statuses.empty()) {
            input.status = static_cast<InputStatus>(statuses[i]);
        }
        out.ticks[i / slots].inputs.push_back(input);
    }
}

} // namespace

void to_wire(const Hello& message, wire::Hello& out) {
    out.set_protocol_version(message.protocol_version);
    out.set_sim_version(message.sim_version);
    out.set_build_info(message.build_info);
    out.set_token(message.token);
    out.set_attempt(message.attempt);
}

void from_wire(const wire::Hello& message, Rules& /*rules*/, Hello& out) {
    out.protocol_version = message.protocol_version();
    out.sim_version = message.sim_version();
    out.build_info = message.build_info();
    out.token = message.token();
    out.attempt = message.attempt();
}

void to_wire(const Welcome& message, wire::Welcome& out) {
    out.set_slot(message.slot);
    to_wire(message.config, *out.mutable_config());
    out.set_sim_version(message.sim_version);
    out.set_build_info(message.build_info);
    out.set_resume_tick(message.resume_tick);
    out.set_transfer(message.transfer);
    out.set_attempt(message.attempt);
}

void from_wire(const wire::Welcome& message, Rules& rules, Welcome& out) {
    rules.require(message.has_config(), "config is missing");
    out.slot = message.slot();
    from_wire(message.config(), out.config);
    out.sim_version = message.sim_version();
    out.build_info = message.build_info();
    out.resume_tick = message.resume_tick();
    out.transfer = message.transfer();
    out.attempt = message.attempt();
}

void to_wire(const Refuse& message, wire::Refuse& out) {
    out.set_reason(static_cast<wire::RefuseReason>(message.reason));
    out.set_field(message.field);
    out.set_message(message.message);
}

void from_wire(const wire::Refuse& message, Rules& rules, Refuse& out) {
    read_enum("reason", message.reason(), kRefuseReasonMax, rules, out.reason);
    out.field = message.field();
    out.message = message.message();
}

void to_wire(const Ready& message, wire::Ready& out) {
    out.set_tick(message.tick);
    out.set_state_hash(message.state_hash);
}

void from_wire(const wire::Ready& message, Rules& /*rules*/, Ready& out) {
    out.tick = message.tick();
    out.state_hash = message.state_hash();
}

void to_wire(const InputBatch& message, wire::InputBatch& out) {
    const std::size_t size_bytes = input_size_bytes(message);
    out.set_slot(message.slot);
    out.set_first_tick(message.first_tick);
    out.set_tick_count(static_cast<std::uint32_t>(message.inputs.size()));
    out.set_input_size_bytes(static_cast<std::uint32_t>(size_bytes));
    for (const SlotInput& input : message.inputs) {
        append_input(input, size_bytes, *out.mutable_inputs());
    }
    out.set_confirmed_tick(message.confirmed_tick);
    out.set_sent_us(message.sent_us);
}

void from_wire(const wire::InputBatch& message, Rules& rules, InputBatch& out) {
    const std::size_t ticks = message.tick_count();
    const std::size_t size_bytes = message.input_size_bytes();
    rules.at_most("tick_count", ticks, kInputBatchTicksMax);
    rules.at_most("input_size_bytes", size_bytes, kInputSizeBytesMax);
    if (!rules.kept()) {
        return;
    }
    rules.equal("bytes of inputs",
                message.inputs().size(),
                ticks * size_bytes,
                "tick_count x input_size_bytes");
    if (!rules.kept()) {
        return;
    }
    out.slot = message.slot();
    out.first_tick = message.first_tick();
    out.confirmed_tick = message.confirmed_tick();
    out.sent_us = message.sent_us();
    out.inputs.reserve(ticks);
    for (std::size_t i = 0; i < ticks; ++i) {
        out.inputs.push_back(read_input(message.inputs(), i, size_bytes));
    }
}

void to_wire(const Confirmation& message, wire::Confirmation& out) {
    out.set_first_tick(message.first_tick);
    out.set_confirmed_tick(message.confirmed_tick);
    write_inputs(message, out);
    for (const SlotAck& ack : message.acks) {
        wire::SlotAck& wire_ack = *out.add_acks();
        wire_ack.set_input_tick(ack.input_tick);
        wire_ack.set_hash_tick(ack.hash_tick);
        wire_ack.set_echo_us(ack.echo_us);
        wire_ack.set_echo_hold_us(ack.echo_hold_us);
        wire_ack.set_attached(ack.attached);
    }
}

void from_wire(const wire::Confirmation& message, Rules& rules, Confirmation& out) {
    rules.at_most(
        "acks", static_cast<std::uint64_t>(message.acks_size()), rules.limits().players_max);
    if (!rules.kept()) {
        return;
    }
    out.first_tick = message.first_tick();
    out.confirmed_tick = message.confirmed_tick();
    read_inputs(message, rules, out);
    for (const wire::SlotAck& ack : message.acks()) {
        out.acks.push_back(
            {ack.input_tick(), ack.hash_tick(), ack.echo_us(), ack.echo_hold_us(), ack.attached()});
    }
}

void to_wire(const HashReport& message, wire::HashReport& out) {
    out.set_slot(message.slot);
    for (const HashReport::Entry& entry : message.entries) {
        wire::HashReport::Entry& wire_entry = *out.add_entries();
        wire_entry.set_tick(entry.tick);
        wire_entry.set_hash(entry.hash);
    }
}

void from_wire(const wire::HashReport& message, Rules& rules, HashReport& out) {
    rules.at_most(
        "entries", static_cast<std::uint64_t>(message.entries_size()), kHashReportEntriesMax);
    if (!rules.kept()) {
        return;
    }
    out.slot = message.slot();
    for (const wire::HashReport::Entry& entry : message.entries()) {
        out.entries.push_back({entry.tick(), entry.hash()});
    }
}

void to_wire(const Chunk& message, wire::Chunk& out) {
    out.set_kind(static_cast<wire::BlobKind>(message.kind));
    out.set_transfer(message.transfer);
    out.set_index(message.index);
    out.set_count(message.count);
    out.set_blob_size_bytes(message.blob_size_bytes);
    out.set_bytes(message.bytes.data(), message.bytes.size());
}

void from_wire(const wire::Chunk& message, Rules& rules, Chunk& out) {
    read_enum("kind", message.kind(), kBlobKindMax, rules, out.kind);
    rules.at_most("bytes", message.bytes().size(), kChunkSizeBytesMax);
    if (!rules.kept()) {
        return;
    }
    out.transfer = message.transfer();
    out.index = message.index();
    out.count = message.count();
    out.blob_size_bytes = message.blob_size_bytes();
    const auto* data = reinterpret_cast<const std::byte*>(message.bytes().data());
    out.bytes.assign(data, data + message.bytes().size());
}

void to_wire(const ChunkAck& message, wire::ChunkAck& out) {
    out.set_transfer(message.transfer);
    out.set_index(message.index);
}

void from_wire(const wire::ChunkAck& message, Rules& /*rules*/, ChunkAck& out) {
    out.transfer = message.transfer();
    out.index = message.index();
}

void to_wire(const DesyncQuery& message, wire::DesyncQuery& out) {
    out.set_agreed_tick(message.agreed_tick);
    out.set_bad_tick(message.bad_tick);
    out.set_server_hash(message.server_hash);
    out.set_client_hash(message.client_hash);
}

void from_wire(const wire::DesyncQuery& message, Rules& /*rules*/, DesyncQuery& out) {
    out.agreed_tick = message.agreed_tick();
    out.bad_tick = message.bad_tick();
    out.server_hash = message.server_hash();
    out.client_hash = message.client_hash();
}

void to_wire(const End& message, wire::End& out) {
    out.set_reason(static_cast<wire::EndReason>(message.reason));
    out.set_last_tick(message.last_tick);
    out.set_attempt(message.attempt);
    out.set_message(message.message);
}

void from_wire(const wire::End& message, Rules& rules, End& out) {
    read_enum("reason", message.reason(), kEndReasonMax, rules, out.reason);
    out.last_tick = message.last_tick();
    out.attempt = message.attempt();
    out.message = message.message();
}

} // namespace lockwind
