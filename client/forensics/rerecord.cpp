#include "forensics/rerecord.h"

#include "log/log_writer.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace lockwind {

namespace {

/// First byte in which the files differ before `size_bytes`; nothing where there is none.
std::optional<std::uint64_t>
first_difference(const std::string& a, const std::string& b, std::uint64_t size_bytes) {
    std::ifstream file_a(a, std::ios::binary);
    std::ifstream file_b(b, std::ios::binary);
    std::array<char, 4096> block_a{};
    std::array<char, 4096> block_b{};
    for (std::uint64_t offset = 0; offset < size_bytes; offset += block_a.size()) {
        const auto want = static_cast<std::streamsize>(
            std::min<std::uint64_t>(block_a.size(), size_bytes - offset));
        file_a.read(block_a.data(), want);
        file_b.read(block_b.data(), want);
        const auto count = std::min(file_a.gcount(), file_b.gcount());
        const auto end = block_a.begin() + count;
        const auto different = std::mismatch(block_a.begin(), end, block_b.begin()).first;
        if (different != end || count < want) {
            return offset + static_cast<std::uint64_t>(different - block_a.begin());
        }
    }
    return std::nullopt;
}

/// Takes a log's records in order. A tick is written when the next record is known, which may be
/// its hash: whether one was due is the log's to say.
class Rerecorder {
public:
    Rerecorder(WorldSimulation& simulation, LogWriter& writer)
        : simulation_(simulation), writer_(writer) {}

    Status operator()(const TickRecord& record) {
        if (Status written = flush(); !written) {
            return written;
        }
        if (const Status stepped = simulation_.advance(record.inputs); !stepped) {
            failure_ = "tick " + std::to_string(record.tick) + ": " + stepped.error().message;
            return Success{};
        }
        inputs_ = record.inputs;
        pending_ = true;
        hash_due_ = false;
        return Success{};
    }
    Status operator()(const HashRecord& record) {
        if (record.tick == 0) {
            return writer_.write_start_hash(remember_hash());
        }
        hash_due_ = true;
        return Success{};
    }
    Status operator()(const KeyframeRecord& /*record*/) { return Success{}; }
    Status operator()(const EventsRecord& /*record*/) { return Success{}; }
    Status operator()(const JoinRecord& record) {
        return copy(record.slot, [&] { return writer_.write_join(record); });
    }
    Status operator()(const LeaveRecord& record) {
        return copy(record.slot, [&] { return writer_.write_leave(record); });
    }
    Status operator()(const PauseRecord& record) {
        return copy(0, [&] { return writer_.write_pause(record); });
    }
    Status operator()(const SettingRecord& record) {
        return copy(0, [&] { return writer_.write_setting(record); });
    }
    Status operator()(const DesyncRecord& record) {
        return copy(record.slot, [&] { return writer_.write_desync(record); });
    }
    Status operator()(LogSummary record) {
        return copy(0, [&] {
            record.state_hash = record.state_hash_tick == hash_tick_ ? hash_ : record.state_hash;
            return writer_.write_summary(record);
        });
    }

    /// Writes the tick that was stepped last, if it is not yet written.
    Status flush() {
        if (!std::exchange(pending_, false)) {
            return Success{};
        }
        const Tick tick = simulation_.tick();
        std::optional<std::uint64_t> hash;
        if (hash_due_) {
            hash = remember_hash();
        }
        Status status = writer_.write_tick(tick, inputs_, hash);
        if (status && LogWriter::keyframe_due(tick)) {
            simulation_.save(state_);
            status = writer_.write_keyframe(tick, simulation_.state_hash(), state_);
        }
        return status ? write_events(tick) : status;
    }

    const std::string& failure() const { return failure_; }

private:
    template <class Write>
    Status copy(Slot slot, Write write) {
        if (slot >= simulation_.slot_count()) {
            return Error{"a record of slot " + std::to_string(slot) + ", which the match has not"};
        }
        const Status written = flush();
        return written ? write() : written;
    }

    Status write_events(Tick tick) {
        std::vector<Event> events;
        for (const Event& event : simulation_.world().events()) {
            if (is_logged(event)) {
                events.push_back(event);
            }
        }
        return events.empty() ? Status(Success{}) : writer_.write_events(tick, events);
    }

    std::uint64_t remember_hash() {
        hash_tick_ = simulation_.tick();
        return hash_ = simulation_.state_hash();
    }

    WorldSimulation& simulation_;
    LogWriter& writer_;
    std::vector<SlotInput> inputs_; // of the pending tick
    bool pending_ = false;
    bool hash_due_ = false;
    Tick hash_tick_ = 0; // of the last hash written
    std::uint64_t hash_ = 0;
    std::string failure_;
    std::vector<std::byte> state_; // scratch
};

} // namespace

Result<RerecordResult>
rerecord(LogReader& log, WorldSimulation& simulation, const std::string& path) {
    const LogHeader& header = log.header();
    LOCKWIND_ASSERT(simulation.tick() == 0);
    if (simulation.slot_count() != header.config.players ||
        simulation.input_size_bytes() != header.input_size_bytes) {
        return Error{log.path() + ": its players or inputs do not fit its scene"};
    }
    Result<std::unique_ptr<LogWriter>> writer = LogWriter::create(path, header);
    if (!writer) {
        return writer.error();
    }
    Rerecorder rerecorder(simulation, *writer.value());
    log.rewind();
    while (const std::optional<LogRecord> record = log.next()) {
        if (const Status taken = std::visit(rerecorder, *record); !taken) {
            return Error{log.path() + ": " + taken.error().message};
        }
        if (!rerecorder.failure().empty()) {
            break;
        }
    }
    if (const Status flushed = rerecorder.flush(); !flushed) {
        return flushed.error();
    }
    RerecordResult result;
    result.ticks = simulation.tick();
    result.state_hash = simulation.state_hash();
    result.bytes = writer.value()->size_bytes();
    result.failure = rerecorder.failure();
    result.ended = log.ended();
    result.damage = log.damage();
    result.first_different_byte = first_difference(log.path(), path, log.valid_bytes());
    return result;
}

int rerecord_exit_code(const RerecordResult& result) {
    if (!result.failure.empty() || result.first_different_byte) {
        return 1;
    }
    return result.ended == LogEnd::damaged ? 3 : 0;
}

std::string rerecord_json(const RerecordResult& result) {
    nlohmann::ordered_json json;
    json["ticks"] = result.ticks;
    json["state_hash"] = hash_text(result.state_hash);
    json["bytes"] = result.bytes;
    json["first_different_byte"] = nullptr;
    if (result.first_different_byte) {
        json["first_different_byte"] = *result.first_different_byte;
    }
    json["ended"] = to_text(result.ended);
    json["failure"] =
        result.failure.empty() ? nlohmann::json(nullptr) : nlohmann::json(result.failure);
    json["damage"] =
        result.damage.empty() ? nlohmann::json(nullptr) : nlohmann::json(result.damage);
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string rerecord_text(const RerecordResult& result) {
    std::string text = "recorded again to tick " + std::to_string(result.ticks) + ", state hash " +
                       hash_text(result.state_hash) + ", " + std::to_string(result.bytes) +
                       " bytes\n";
    if (!result.failure.empty()) {
        text += "FAILED: " + result.failure + "\n";
    } else if (result.first_different_byte) {
        text += "FAILED: byte " + std::to_string(*result.first_different_byte) +
                " is not the log's; lockwind diff of the two tells the tick\n";
    } else {
        text += "the same bytes as the log\n";
    }
    text += result.damage.empty() ? "" : "damaged " + result.damage + "\n";
    return text;
}

} // namespace lockwind
