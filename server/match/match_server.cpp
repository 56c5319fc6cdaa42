#include "match/match_server.h"

#include "codec/codec.h"
#include "forensics/bundle.h"
#include "forensics/match_simulation.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <variant>

namespace lockwind {

namespace {

/// States that may be asked for: those whose hashes are not yet agreed on by all.
constexpr std::size_t kHistoryCapacity = 256;

std::uint64_t unix_time_us() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

/// The match's world, or what is wrong with its configuration or scene.
Result<std::unique_ptr<WorldSimulation>> make_simulation(const MatchConfig& config) {
    if (const Status valid = check(config); !valid) {
        return valid.error();
    }
    // Clients get the scene with their Welcome.
    Welcome welcome;
    welcome.config = config;
    if (const Status sendable = check(Message{welcome}); !sendable) {
        return sendable.error();
    }
    return create_match_simulation(config);
}

LockstepServerSettings session_settings(const MatchSettings& settings,
                                        const WorldSimulation& simulation) {
    LockstepServerSettings session;
    session.config = settings.config;
    session.sim_version = sim_version();
    session.build_info = build_info();
    session.input_size_bytes = simulation.input_size_bytes();
    session.initial_state_hash = simulation.state_hash();
    session.stall_policy = settings.stall_policy;
    session.join_timeout_ms = settings.join_timeout_ms;
    return session;
}

} // namespace

Status MatchServer::check_settings(const MatchConfig& config) {
    const Result<std::unique_ptr<WorldSimulation>> simulation = make_simulation(config);
    return simulation ? Status(Success{}) : Status(simulation.error());
}

Result<std::unique_ptr<MatchServer>> MatchServer::create(const MatchSettings& settings,
                                                         Transport& transport) {
    const MatchConfig& config = settings.config;
    Result<std::unique_ptr<WorldSimulation>> simulation = make_simulation(config);
    if (!simulation) {
        return simulation.error();
    }
    LogHeader header;
    header.sim_version = sim_version();
    header.build_info = build_info();
    header.started_unix_us = unix_time_us();
    header.config = config;
    header.input_size_bytes = simulation.value()->input_size_bytes();
    Result<std::unique_ptr<LogWriter>> log = LogWriter::create(settings.log_path, header);
    if (!log) {
        return log.error();
    }
    const LockstepServerSettings session = session_settings(settings, *simulation.value());
    const Status started = log.value()->write_start_hash(session.initial_state_hash);
    if (!started) {
        return started.error();
    }
    return std::unique_ptr<MatchServer>(
        new MatchServer(std::move(simulation).value(), std::move(log).value(), session, transport));
}

MatchServer::MatchServer(std::unique_ptr<WorldSimulation> simulation,
                         std::unique_ptr<LogWriter> log,
                         const LockstepServerSettings& settings,
                         Transport& transport)
    : simulation_(std::move(simulation)), log_(std::move(log)), session_(settings),
      transport_(transport), history_(kHistoryCapacity) {
    history_.save(*simulation_, settings.initial_state_hash);
}

void MatchServer::poll() {
    receive();
    session_.update(transport_.clock_us());
    for (std::vector<Request> requests = session_.take_requests(); !requests.empty();
         requests = session_.take_requests()) {
        for (const Request& request : requests) {
            if (failed_ && !failure_told_) {
                break; // nobody may hear of a tick that was not stepped or is not in the log
            }
            std::visit([this](const auto& wanted) { execute(wanted); }, request);
        }
        failure_told_ = failed_;
        session_.update(transport_.clock_us());
    }
    history_.discard_before(session_.oldest_needed_tick());
    if (session_.ended()) {
        finish();
    }
}

void MatchServer::receive() {
    packets_.clear();
    transport_.receive(packets_);
    MessageLimits limits;
    limits.direction = Direction::to_server;
    for (const Packet& packet : packets_) {
        const Result<Message> message = decode(packet.bytes, limits);
        if (!message) {
            session_.receive_undecodable(packet.from, transport_.clock_us());
            continue;
        }
        session_.receive(packet.from, message.value(), transport_.clock_us());
    }
}

void MatchServer::execute(const SendRequest& request) {
    encode(request.message, encoded_);
    const Channel channel =
        request.delivery == Delivery::reliable ? Channel::reliable : Channel::best_effort;
    // A full queue loses the message; the session repeats whatever is not acknowledged.
    static_cast<void>(transport_.send(request.to, channel, encoded_));
}

void MatchServer::execute(const PersistRequest& request) {
    if (const Status written = log_->write_tick(request.tick, request.inputs, hash_); !written) {
        fail_log(written.error());
        return;
    }
    recorded_tick_ = request.tick;
    if (LogWriter::keyframe_due(request.tick)) {
        std::vector<std::byte> state;
        simulation_->save(state);
        const std::uint64_t hash = hash_ ? *hash_ : simulation_->state_hash();
        require_logged(log_->write_keyframe(request.tick, hash, state));
    }
    record_events(request.tick);
}

void MatchServer::execute(const AdvanceRequest& request) {
    const std::uint64_t began_us = transport_.clock_us();
    if (const Status stepped = simulation_->advance(request.inputs); !stepped) {
        failed_ = true;
        session_.fail(stepped.error().message, recorded_tick_);
        return;
    }
    hash_.reset();
    if (request.hash_due) {
        hash_ = simulation_->state_hash();
        history_.save(*simulation_, *hash_);
    }
    figures_.step_us.add(transport_.clock_us() - began_us);
    figures_.contacts.add(simulation_->world().counts().contacts);
    session_.advanced(request.tick, hash_.value_or(0), began_us);
}

void MatchServer::execute(const SnapshotRequest& request) {
    const std::uint64_t hash = simulation_->state_hash();
    // What a slot comes back to is the state it agrees on, whether or not its hash was due.
    if (history_.find(request.tick) == nullptr) {
        history_.save(*simulation_, hash);
    }
    session_.snapshot_saved(request.slot, request.tick, hash, history_.find(request.tick)->bytes);
}

void MatchServer::execute(const BundleRequest& request) {
    Result<DesyncOutcome> outcome = trace_desync(request);
    if (outcome) {
        desyncs_.push_back(std::move(outcome).value());
    } else {
        desyncs_.push_back({request.desync, "", "", outcome.error().message});
    }
}

void MatchServer::execute(const NotifyRequest& request) {
    require_logged(record_session_event(request.event));
    if (listener_) {
        listener_(request.event);
    }
}

void MatchServer::record_events(Tick tick) {
    logged_events_.clear();
    for (const Event& event : simulation_->world().events()) {
        figures_.created += event.type == EventType::created ? 1 : 0;
        figures_.destroyed += event.type == EventType::destroyed ? 1 : 0;
        figures_.scores += event.type == EventType::score ? 1 : 0;
        if (is_logged(event)) {
            logged_events_.push_back(event);
        }
    }
    if (!logged_events_.empty()) {
        require_logged(log_->write_events(tick, logged_events_));
    }
}

Status MatchServer::record_session_event(const SessionEvent& event) {
    switch (event.kind) {
    case SessionEventKind::joined:
    case SessionEventKind::reconnected:
        return log_->write_join({event.tick,
                                 event.slot,
                                 event.kind == SessionEventKind::reconnected,
                                 session_.slot_status(event.slot).build_info});
    case SessionEventKind::left:
        return log_->write_leave({event.tick, event.slot, LeaveReason::left});
    case SessionEventKind::dropped:
        return log_->write_leave({event.tick, event.slot, LeaveReason::dropped});
    case SessionEventKind::desync_detected: {
        const std::span<const HashMismatch> desyncs = session_.desyncs();
        const auto desync = std::find_if(desyncs.begin(), desyncs.end(), [&](const auto& one) {
            return one.slot == event.slot;
        });
        LOCKWIND_ASSERT(desync != desyncs.end());
        return log_->write_desync(
            {desync->bad_tick, desync->slot, desync->server_hash, desync->client_hash});
    }
    case SessionEventKind::paused:
        return Success{};
    case SessionEventKind::unpaused:
        return log_->write_pause({event.tick, event.duration_us, event.text});
    default:
        return Success{};
    }
}

Result<DesyncOutcome> MatchServer::trace_desync(const BundleRequest& request) {
    const HashMismatch& desync = request.desync;
    const SavedState* agreed = history_.find(desync.agreed_tick);
    const SavedState* bad = history_.find(desync.bad_tick);
    if (agreed == nullptr || bad == nullptr) {
        return Error{"the server no longer has its states of ticks " +
                     std::to_string(desync.agreed_tick) + " and " +
                     std::to_string(desync.bad_tick)};
    }
    std::vector<std::vector<SlotInput>> inputs;
    for (Tick tick = desync.agreed_tick + 1; tick <= desync.bad_tick; ++tick) {
        const std::span<const SlotInput> confirmed = session_.confirmed_inputs(tick);
        inputs.emplace_back(confirmed.begin(), confirmed.end());
    }
    DesyncEvidence evidence;
    evidence.slot = desync.slot;
    evidence.interval = {desync.agreed_tick, agreed->bytes, inputs};
    evidence.server_hash = desync.server_hash;
    evidence.client_hash = desync.client_hash;
    evidence.server_state = bad->bytes;
    evidence.server = {std::string(sim_version()), std::string(build_info()), session_.config()};
    const Result<Bundle> bundle = make_bundle(*simulation_, evidence, request.report);
    if (!bundle) {
        return bundle.error();
    }
    const std::string path = bundle_path(log_->path(), desync.slot, desync.bad_tick);
    if (const Status written = write_bundle(path, bundle.value()); !written) {
        return written.error();
    }
    return DesyncOutcome{desync, path, std::string(to_text(bundle.value().verdict)), ""};
}

/// What is told beside the ticks.
void MatchServer::require_logged(const Status& status) {
    if (!status) {
        fail_log(status.error());
    }
}

void MatchServer::fail_log(const Error& error) {
    if (!failed_) {
        failed_ = true;
        log_trouble_ = error.message;
        session_.fail(error.message, recorded_tick_);
    }
}

void MatchServer::finish() {
    if (finished_) {
        return;
    }
    finished_ = true;
    LogSummary summary;
    summary.ticks = session_.confirmed_tick();
    summary.state_hash_tick = session_.state_hash_tick();
    summary.state_hash = session_.state_hash();
    summary.desyncs = static_cast<std::uint32_t>(session_.counters().desyncs);
    summary.reason = session_.end_reason();
    summary.message = session_.end_message();
    summary.ended_unix_us = unix_time_us();
    if (!failed_) {
        require_logged(log_->write_summary(summary));
    }
}

} // namespace lockwind
