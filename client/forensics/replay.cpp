#include "forensics/replay.h"

#include "forensics/trace.h"
#include "log/state_pack.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace lockwind {

namespace {

constexpr Tick kProgressTicks = 60;

/// One pass of a simulation over a log's records.
class Replayer {
public:
    Replayer(LogReader& log, Simulation& simulation, const ReplayOptions& options)
        : log_(log), simulation_(simulation), options_(options) {}

    Result<ReplayResult> run() {
        const auto began = std::chrono::steady_clock::now();
        const LogIndex index = index_log(log_);
        last_ = std::min(options_.to.value_or(index.ticks), index.ticks);
        if (Status status = seek(index); !status) {
            return status.error();
        }
        const Tick first = simulation_.tick();
        if (Status status = step_all(); !status) {
            return status.error();
        }
        const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - began;
        result_.ticks = simulation_.tick();
        result_.state_hash = simulation_.state_hash();
        result_.ended = index.ended;
        result_.valid_bytes = index.valid_bytes;
        result_.damage = index.damage;
        const double simulated = static_cast<double>(result_.ticks - first) /
                                 static_cast<double>(log_.header().config.tick_rate_hz);
        result_.realtime_factor = wall.count() > 0 ? simulated / wall.count() : 0;
        return std::move(result_);
    }

private:
    /// Loads the last keyframe before `from` that is good; stays at state(0) where there is none.
    Status seek(const LogIndex& index) {
        const Tick from = options_.from.value_or(1);
        if (from > std::max<Tick>(index.ticks, 1)) {
            return Error{log_.path() + ": --from " + std::to_string(from) +
                         " is behind its last tick, " + std::to_string(index.ticks)};
        }
        for (auto keyframe = index.keyframes.rbegin(); keyframe != index.keyframes.rend();
             ++keyframe) {
            if (keyframe->tick < from && keyframe->tick > 0 && load(*keyframe)) {
                return Success{};
            }
        }
        log_.rewind();
        return Success{};
    }

    bool load(const LogIndex::Keyframe& keyframe) {
        log_.seek(keyframe.offset, keyframe.tick);
        const std::optional<LogRecord> record = log_.next();
        const auto* content = record ? std::get_if<KeyframeRecord>(&*record) : nullptr;
        if (content == nullptr) {
            return false;
        }
        const Result<std::vector<std::byte>> state = unpack_state(content->packed_state);
        if (!state || !simulation_.load(state.value()) || simulation_.tick() != keyframe.tick) {
            return false;
        }
        check_hash(content->hash);
        return true;
    }

    Status step_all() {
        const Tick from = options_.from.value_or(1);
        while (const std::optional<LogRecord> record = log_.next()) {
            if (const auto* tick = std::get_if<TickRecord>(&*record)) {
                if (tick->tick > last_) {
                    break;
                }
                start_trace(tick->tick, from);
                if (!step(*tick)) {
                    break;
                }
            } else if (options_.verify) {
                verify(*record);
            }
        }
        simulation_.observe(nullptr);
        return recorder_ ? recorder_->status() : Status(Success{});
    }

    void start_trace(Tick tick, Tick from) {
        if (options_.trace == nullptr || recorder_ || tick < from) {
            return;
        }
        recorder_.emplace(
            simulation_, *options_.trace, TraceOptions{options_.trace_states, UINT64_MAX, nullptr});
        recorder_->start();
        simulation_.observe(&*recorder_);
    }

    bool step(const TickRecord& tick) {
        if (Status status = simulation_.advance(tick.inputs); !status) {
            result_.failure = "tick " + std::to_string(tick.tick) + ": " + status.error().message;
            result_.first_bad_tick = result_.first_bad_tick.value_or(tick.tick);
            return false;
        }
        if (options_.progress && (tick.tick % kProgressTicks == 0 || tick.tick == last_)) {
            options_.progress(tick.tick, last_);
        }
        return true;
    }

    void verify(const LogRecord& record) {
        if (const auto* hash = std::get_if<HashRecord>(&record)) {
            ++result_.hashes_checked;
            check_hash(hash->hash);
        } else if (const auto* keyframe = std::get_if<KeyframeRecord>(&record)) {
            check_hash(keyframe->hash);
            check_keyframe(*keyframe);
        } else if (const auto* summary = std::get_if<LogSummary>(&record);
                   summary != nullptr && summary->state_hash_tick == simulation_.tick()) {
            check_hash(summary->state_hash);
        }
    }

    /// Compares the hash of the state that the simulation is in.
    void check_hash(std::uint64_t expected) {
        if (!options_.verify) {
            return;
        }
        const std::uint64_t actual = simulation_.state_hash();
        if (actual == expected) {
            result_.verified_to_tick =
                result_.first_bad_tick ? result_.verified_to_tick : simulation_.tick();
            return;
        }
        found_bad(expected, actual);
    }

    void check_keyframe(const KeyframeRecord& keyframe) {
        const Result<std::vector<std::byte>> state = unpack_state(keyframe.packed_state);
        std::vector<std::byte> own;
        simulation_.save(own);
        if (!state || state.value() != own) {
            found_bad(keyframe.hash, simulation_.state_hash());
        }
    }

    void found_bad(std::uint64_t expected, std::uint64_t actual) {
        ++result_.hashes_wrong;
        if (!result_.first_bad_tick) {
            result_.first_bad_tick = simulation_.tick();
            result_.expected_hash = expected;
            result_.actual_hash = actual;
        }
    }

    LogReader& log_;
    Simulation& simulation_;
    const ReplayOptions& options_;
    Tick last_ = 0;
    ReplayResult result_;
    std::optional<TraceRecorder> recorder_;
};

} // namespace

Result<ReplayResult> replay(LogReader& log, Simulation& simulation, const ReplayOptions& options) {
    const LogHeader& header = log.header();
    if (simulation.slot_count() != header.config.players ||
        simulation.input_size_bytes() != header.input_size_bytes) {
        return Error{log.path() + ": " + std::to_string(header.config.players) +
                     " players with inputs of " + std::to_string(header.input_size_bytes) +
                     " bytes do not fit a simulation of " +
                     std::to_string(simulation.slot_count()) + " with " +
                     std::to_string(simulation.input_size_bytes())};
    }
    LOCKWIND_ASSERT(simulation.tick() == 0);
    return Replayer(log, simulation, options).run();
}

int replay_exit_code(const ReplayResult& result) {
    if (result.first_bad_tick) {
        return 1;
    }
    return result.ended == LogEnd::damaged ? 3 : 0;
}

} // namespace lockwind
