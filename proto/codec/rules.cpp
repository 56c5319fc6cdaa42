#include "codec/rules.h"

#include "codec/utf8.h"

#include <algorithm>

namespace lockwind {
namespace {

/// Upper bound of a SlotAck on the wire: tag, length, and five varints with their tags.
constexpr std::size_t kSlotAckSizeBytesMax = 2 + 11 + 11 + 11 + 6 + 2;
/// Of a Confirmation without inputs and acks.
constexpr std::size_t kConfirmationBaseSizeBytes = 64;

void config_rules(const MatchConfig& config, Rules& rules) {
    rules.text("config.match", config.match, kNameSizeBytesMax);
    rules.text("config.mode", config.mode, kNameSizeBytesMax);
    rules.text("config.scene_name", config.scene_name, kSceneNameSizeBytesMax);
    rules.text("config.scene_text", config.scene_text, kConfigSceneTextSizeBytesMax);
    rules.in_range("config.tick_rate_hz", config.tick_rate_hz, 1, kTickRateHzMax);
    rules.in_range("config.players", config.players, 1, rules.limits().players_max);
    rules.at_most("config.input_delay_ticks", config.input_delay_ticks, kInputDelayTicksMax);
    rules.in_range(
        "config.hash_interval_ticks", config.hash_interval_ticks, 1, kHashIntervalTicksMax);
    rules.tick("config.ticks", config.ticks);
}

} // namespace

Status Rules::status() const {
    if (broken_) {
        return *broken_;
    }
    return Success{};
}

void Rules::fail(const std::string& rule) {
    if (!broken_) {
        broken_ = Error{std::string(kind_) + ": " + rule};
    }
}

void Rules::in_range(std::string_view field,
                     std::uint64_t value,
                     std::uint64_t min,
                     std::uint64_t max) {
    if (value < min || value > max) {
        fail(std::string(field) + " is " + std::to_string(value) + ", allowed are " +
             std::to_string(min) + " .. " + std::to_string(max));
    }
}

void Rules::equal(std::string_view field,
                  std::uint64_t value,
                  std::uint64_t expected,
                  std::string_view expected_name) {
    if (value != expected) {
        fail(std::string(field) + " is " + std::to_string(value) + ", expected " +
             std::string(expected_name) + " = " + std::to_string(expected));
    }
}

void Rules::text(std::string_view field, std::string_view value, std::size_t size_bytes_max) {
    if (value.size() > size_bytes_max) {
        fail(std::string(field) + " has " + std::to_string(value.size()) + " bytes, allowed are " +
             std::to_string(size_bytes_max));
    } else if (!is_utf8(value)) {
        fail(std::string(field) + " is not UTF-8");
    }
}

void Rules::require(bool kept, std::string_view rule) {
    if (!kept) {
        fail(std::string(rule));
    }
}

std::size_t input_size_bytes(const SlotInput& input) {
    const auto last = std::find_if(
        input.bytes.rbegin(), input.bytes.rend(), [](std::uint8_t byte) { return byte != 0; });
    return static_cast<std::size_t>(input.bytes.rend() - last);
}

std::size_t input_size_bytes(const InputBatch& message) {
    std::size_t size = 0;
    for (const SlotInput& input : message.inputs) {
        size = std::max(size, input_size_bytes(input));
    }
    return size;
}

std::size_t input_size_bytes(const Confirmation& message) {
    std::size_t size = 0;
    for (const ConfirmedTick& tick : message.ticks) {
        for (const SlotInput& input : tick.inputs) {
            size = std::max(size, input_size_bytes(input));
        }
    }
    return size;
}

void apply_rules(const Hello& message, Rules& rules) {
    rules.text("sim_version", message.sim_version, kNameSizeBytesMax);
    rules.text("build_info", message.build_info, kTextSizeBytesMax);
}

void apply_rules(const Welcome& message, Rules& rules) {
    rules.slot(message.slot);
    config_rules(message.config, rules);
    rules.text("sim_version", message.sim_version, kNameSizeBytesMax);
    rules.text("build_info", message.build_info, kTextSizeBytesMax);
    rules.tick("resume_tick", message.resume_tick);
}

void apply_rules(const Refuse& message, Rules& rules) {
    rules.at_most("reason", static_cast<std::uint64_t>(message.reason), kRefuseReasonMax);
    rules.text("field", message.field, kNameSizeBytesMax);
    rules.text("message", message.message, kTextSizeBytesMax);
}

void apply_rules(const Ready& message, Rules& rules) {
    rules.tick("tick", message.tick);
}

void apply_rules(const InputBatch& message, Rules& rules) {
    rules.slot(message.slot);
    rules.tick("first_tick", message.first_tick);
    rules.at_most("tick_count", message.inputs.size(), kInputBatchTicksMax);
    rules.tick("confirmed_tick", message.confirmed_tick);
}

void apply_rules(const Confirmation& message, Rules& rules) {
    rules.tick("first_tick", message.first_tick);
    rules.tick("confirmed_tick", message.confirmed_tick);
    rules.at_most("tick_count", message.ticks.size(), kConfirmationTicksMax);
    const std::size_t slots = message.ticks.empty() ? 0 : message.ticks.front().inputs.size();
    rules.in_range("slot_count", slots, message.ticks.empty() ? 0 : 1, rules.limits().players_max);
    for (const ConfirmedTick& tick : message.ticks) {
        rules.equal("inputs of a tick", tick.inputs.size(), slots, "slot_count");
        for (const SlotInput& input : tick.inputs) {
            rules.at_most("status", static_cast<std::uint64_t>(input.status), kSentStatusMax);
        }
    }
    rules.at_most("acks", message.acks.size(), rules.limits().players_max);
    for (const SlotAck& ack : message.acks) {
        rules.tick("acks.input_tick", ack.input_tick);
        rules.tick("acks.hash_tick", ack.hash_tick);
    }
    if (rules.kept()) {
        // One byte more an input for its status.
        const std::size_t size_bytes =
            message.ticks.size() * slots * (input_size_bytes(message) + 1) +
            message.acks.size() * kSlotAckSizeBytesMax + kConfirmationBaseSizeBytes;
        rules.at_most("size in bytes", size_bytes, kMessageSizeBytesMax);
    }
}

void apply_rules(const HashReport& message, Rules& rules) {
    rules.slot(message.slot);
    rules.at_most("entries", message.entries.size(), kHashReportEntriesMax);
    for (const HashReport::Entry& entry : message.entries) {
        rules.tick("entries.tick", entry.tick);
    }
}

void apply_rules(const Chunk& message, Rules& rules) {
    rules.at_most("kind", static_cast<std::uint64_t>(message.kind), kBlobKindMax);
    rules.require(message.transfer > 0, "transfer is 0; transfers count from 1");
    rules.at_most("blob_size_bytes", message.blob_size_bytes, rules.limits().blob_size_bytes_max);
    rules.at_most("bytes", message.bytes.size(), kChunkSizeBytesMax);
    // A piece holds a byte at least, unless the blob is empty, and kChunkSizeBytesMax at most.
    const std::uint64_t blob = message.blob_size_bytes;
    const std::uint64_t count_min =
        std::max<std::uint64_t>(1, (blob + kChunkSizeBytesMax - 1) / kChunkSizeBytesMax);
    rules.in_range("count", message.count, count_min, std::max<std::uint64_t>(1, blob));
    rules.require(message.index < message.count, "index is not below count");
    rules.require(message.bytes.size() <= message.blob_size_bytes,
                  "bytes has more bytes than the blob");
}

void apply_rules(const ChunkAck& message, Rules& rules) {
    rules.require(message.transfer > 0, "transfer is 0; transfers count from 1");
    rules.at_most("index", message.index, rules.limits().blob_size_bytes_max);
}

void apply_rules(const DesyncQuery& message, Rules& rules) {
    rules.tick("agreed_tick", message.agreed_tick);
    rules.tick("bad_tick", message.bad_tick);
    rules.require(message.bad_tick > message.agreed_tick, "bad_tick is not after agreed_tick");
    if (rules.kept()) {
        rules.at_most("bad_tick - agreed_tick",
                      message.bad_tick - message.agreed_tick,
                      rules.limits().query_ticks_max);
    }
}

void apply_rules(const End& message, Rules& rules) {
    rules.at_most("reason", static_cast<std::uint64_t>(message.reason), kEndReasonMax);
    rules.tick("last_tick", message.last_tick);
    rules.text("message", message.message, kTextSizeBytesMax);
}

} // namespace lockwind
