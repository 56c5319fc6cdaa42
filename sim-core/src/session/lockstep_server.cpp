#include "session/lockstep_server.h"

#include "session/lockstep_server_match.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lockwind {

LockstepServer::LockstepServer(const LockstepServerSettings& settings)
    : match_(std::make_unique<Match>(settings)) {}
LockstepServer::~LockstepServer() = default;
LockstepServer::LockstepServer(LockstepServer&&) noexcept = default;
LockstepServer& LockstepServer::operator=(LockstepServer&&) noexcept = default;

void LockstepServer::receive(PeerId from, const Message& message, std::uint64_t now_us) {
    match_->receive(from, message, now_us);
}

void LockstepServer::receive_undecodable(PeerId from, std::uint64_t now_us) {
    match_->receive_undecodable(from, now_us);
}

void LockstepServer::update(std::uint64_t now_us) {
    match_->update(now_us);
}

std::vector<Request> LockstepServer::take_requests() {
    return std::exchange(match_->requests, {});
}

std::uint64_t LockstepServer::next_deadline_us() const {
    return match_->next_deadline_us();
}

void LockstepServer::advanced(Tick tick, std::uint64_t hash, std::uint64_t step_began_us) {
    match_->advanced(tick, hash, step_began_us);
}

void LockstepServer::snapshot_saved(Slot slot,
                                    Tick tick,
                                    std::uint64_t hash,
                                    std::vector<std::byte> bytes) {
    match_->snapshot_saved(slot, tick, hash, std::move(bytes));
}

void LockstepServer::stop(const std::string& reason) {
    match_->stop(reason);
}

void LockstepServer::fail(const std::string& message, Tick recorded_tick) {
    match_->fail(message, recorded_tick);
}

MatchPhase LockstepServer::phase() const {
    return match_->phase;
}

EndReason LockstepServer::end_reason() const {
    return match_->end_reason;
}

const std::string& LockstepServer::end_message() const {
    return match_->end_message;
}

Tick LockstepServer::confirmed_tick() const {
    return match_->confirmed.newest_tick();
}

Tick LockstepServer::advanced_tick() const {
    return match_->advanced_tick;
}

std::uint64_t LockstepServer::state_hash() const {
    return match_->state_hash;
}

Tick LockstepServer::state_hash_tick() const {
    return match_->state_hash_tick;
}

const MatchConfig& LockstepServer::config() const {
    return match_->settings.config;
}

SlotStatus LockstepServer::slot_status(Slot slot) const {
    return match_->slot_status(slot);
}

const LockstepServerCounters& LockstepServer::counters() const {
    return match_->counters;
}

std::span<const HashMismatch> LockstepServer::desyncs() const {
    return match_->desyncs;
}

Tick LockstepServer::oldest_needed_tick() const {
    return match_->oldest_needed_tick();
}

std::span<const SlotInput> LockstepServer::confirmed_inputs(Tick tick) const {
    return match_->confirmed.find(tick);
}

namespace {

constexpr std::uint64_t kUsPerMs = 1000;

RosterSettings roster_settings(const LockstepServerSettings& settings) {
    RosterSettings roster;
    roster.slots = settings.config.players;
    roster.sim_version = settings.sim_version;
    roster.interrupted_timeout_us = settings.interrupted_timeout_ms * kUsPerMs;
    roster.drop_timeout_us = settings.drop_timeout_ms * kUsPerMs;
    roster.ready_timeout_us = settings.ready_timeout_ms * kUsPerMs;
    roster.seat_interval_us = settings.seat_interval_ms * kUsPerMs;
    return roster;
}

} // namespace

LockstepServer::Match::Match(const LockstepServerSettings& match_settings)
    : settings(match_settings), state_hash(match_settings.initial_state_hash),
      roster_(roster_settings(match_settings)),
      lines_(match_settings.config.players,
             Line(match_settings.input_size_bytes, conduct_of(match_settings))),
      clock_(match_settings.config.tick_rate_hz), ledger_(match_settings.config) {
    LOCKWIND_ASSERT(check(settings.config).ok());
    LOCKWIND_ASSERT(settings.input_size_bytes >= 1);
    LOCKWIND_ASSERT(settings.input_size_bytes <= kInputSizeBytesMax);
}

void LockstepServer::Match::send(PeerId to, Message message) {
    const Delivery delivery = delivery_of(message);
    requests.push_back(SendRequest{to, delivery, std::move(message)});
}

void LockstepServer::Match::notify(SessionEventKind kind, Slot slot, Tick tick, std::string text) {
    requests.push_back(NotifyRequest{SessionEvent{kind, slot, tick, std::move(text)}});
}

void LockstepServer::Match::notify_unpaused(Tick tick,
                                            std::uint64_t duration_us,
                                            const std::string& why) {
    SessionEvent event{SessionEventKind::unpaused, kNoSlot, tick, ""};
    event.text = why + " for " + std::to_string(duration_us) + " us";
    event.duration_us = duration_us;
    requests.push_back(NotifyRequest{std::move(event)});
}

bool LockstepServer::Match::speaks_for(Slot slot, Slot claimed) {
    if (slot != claimed) {
        counters.violations.add(Violation::wrong_slot);
    }
    return slot == claimed;
}

void LockstepServer::Match::receive(PeerId from, const Message& message, std::uint64_t now_us) {
    pass_time(now_us);
    if (phase == MatchPhase::closing || phase == MatchPhase::ended) {
        on_message_while_closing(from, message);
        return;
    }
    if (from == kServerPeer || from == kAllPeers) {
        counters.violations.add(Violation::unknown_peer);
        return;
    }
    const Slot slot = roster_.slot_of(from);
    const std::uint64_t offences_before = counters.violations.offences();
    if (slot != kNoSlot && !lines_[slot].conduct.messages.take(now_us_)) {
        counters.violations.add(Violation::message_flood);
    } else if (const auto* hello = std::get_if<Hello>(&message)) {
        on_hello(from, *hello);
    } else if (slot == kNoSlot) {
        rebuke(from);
    } else {
        hear(slot, message);
    }
    check_conduct(slot, offences_before);
}

void LockstepServer::Match::receive_undecodable(PeerId from, std::uint64_t now_us) {
    pass_time(now_us);
    const std::uint64_t offences_before = counters.violations.offences();
    counters.violations.add(Violation::undecodable);
    check_conduct(roster_.slot_of(from), offences_before);
}

/// A driver calls at least every kStatusIntervalUs. Where it did not (the process was stopped, the
/// machine slept), nobody could be heard and no tick could be played: all clocks stand still for
/// that long.
void LockstepServer::Match::pass_time(std::uint64_t now_us) {
    const std::uint64_t before_us = now_us_;
    now_us_ = std::max(now_us_, now_us);
    const std::uint64_t away_us = now_us_ - before_us;
    if (before_us == 0 || away_us < settings.drop_timeout_ms * kUsPerMs / 2) {
        return;
    }
    roster_.excuse(away_us);
    gather_deadline_us_ += gather_deadline_us_ == 0 ? 0 : away_us;
    phase_deadline_us_ += away_us;
    others_deadline_us_ += away_us;
    if (phase == MatchPhase::running) {
        clock_.rebase(away_us);
        stall_began_us_ += away_us;
        notify_unpaused(confirmed.newest_tick() + 1, away_us, "the server stood still");
    }
}

void LockstepServer::Match::hear(Slot slot, const Message& message) {
    if (roster_.hear(slot, now_us_)) {
        notify(SessionEventKind::resumed, slot, confirmed.newest_tick(), "");
    }
    dispatch(slot, message);
}

void LockstepServer::Match::dispatch(Slot slot, const Message& message) {
    if (const auto* ready = std::get_if<Ready>(&message)) {
        on_ready(slot, *ready);
    } else if (const auto* batch = std::get_if<InputBatch>(&message)) {
        on_input_batch(slot, *batch);
    } else if (const auto* report = std::get_if<HashReport>(&message)) {
        on_hash_report(slot, *report);
    } else if (const auto* piece = std::get_if<Chunk>(&message)) {
        on_chunk(slot, *piece);
    } else if (const auto* ack = std::get_if<ChunkAck>(&message)) {
        lines_[slot].snapshot.receive(*ack);
    } else if (const auto* end_of_client = std::get_if<End>(&message)) {
        leave(slot, *end_of_client);
    } else {
        counters.violations.add(Violation::unexpected_message);
    }
}

void LockstepServer::Match::update(std::uint64_t now_us) {
    pass_time(now_us);
    if (phase == MatchPhase::ended) {
        return;
    }
    if (phase == MatchPhase::closing) {
        close();
        return;
    }
    check_silence();
    switch (phase) {
    case MatchPhase::gathering:
        gather();
        break;
    case MatchPhase::running:
        run();
        break;
    case MatchPhase::settling:
        check_settled();
        break;
    case MatchPhase::halted:
        inquire();
        break;
    case MatchPhase::closing:
    case MatchPhase::ended:
        return;
    }
    poll_snapshots();
    if (now_us_ >= status_us_) {
        send_confirmations();
    }
}

std::uint64_t LockstepServer::Match::next_deadline_us() const {
    if (phase == MatchPhase::ended) {
        return std::numeric_limits<std::uint64_t>::max();
    }
    std::uint64_t deadline = std::max(status_us_, std::uint64_t{1});
    for (const Line& line : lines_) {
        deadline = std::min(deadline, line.snapshot.next_deadline_us());
    }
    if (phase != MatchPhase::halted && phase != MatchPhase::closing) {
        deadline = std::min(deadline, roster_.next_deadline_us());
    }
    if (phase == MatchPhase::gathering) {
        return std::min(deadline, gather_deadline_us_);
    }
    if (phase != MatchPhase::running) {
        return std::min(deadline, phase_deadline_us_);
    }
    if (!advancing() && !stalled_) {
        deadline = std::min(deadline, clock_.due_us(confirmed.newest_tick() + 1));
    }
    if (stalled_ && !stall_policy_applied_) {
        deadline = std::min(deadline, stall_began_us_ + settings.stall_timeout_ms * kUsPerMs);
    }
    return deadline;
}

void LockstepServer::Match::advanced(Tick tick, std::uint64_t hash, std::uint64_t step_began_us) {
    LOCKWIND_ASSERT(tick == advanced_tick + 1 && tick <= confirmed.newest_tick());
    advanced_tick = tick;
    const std::uint64_t due_us = clock_.due_us(tick);
    counters.tick_lateness_us.add(step_began_us > due_us ? step_began_us - due_us : 0);
    if (hash_due(settings.config, tick)) {
        ledger_.record(tick, hash);
        previous_hash_ = state_hash;
        previous_hash_tick_ = state_hash_tick;
        state_hash = hash;
        state_hash_tick = tick;
    }
    if (phase == MatchPhase::running && tick == settings.config.ticks) {
        settle(EndReason::complete, "all ticks are played");
    }
}

Tick LockstepServer::Match::oldest_needed_tick() const {
    Tick oldest = confirmed.newest_tick();
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        if (roster_.at(slot).connected()) {
            oldest = std::min({oldest, lines_[slot].hash_tick, lines_[slot].confirmed_tick});
        }
    }
    for (const Inquiry& inquiry : inquiries_) {
        oldest = std::min(oldest, inquiry.desync.agreed_tick);
    }
    return oldest;
}

void LockstepServer::Match::discard_history() {
    const Tick oldest = oldest_needed_tick();
    ledger_.discard_before(oldest);
    confirmed.discard_before(oldest); // the newest one stays, for substitution
}

SlotStatus LockstepServer::Match::slot_status(Slot slot) const {
    LOCKWIND_ASSERT(slot < roster_.size());
    const Seat& seat = roster_.at(slot);
    const Line& line = lines_[slot];
    SlotStatus status;
    status.state = seat.state;
    status.peer = seat.peer;
    status.token = seat.token;
    status.build_info = seat.build_info;
    status.interrupted = seat.interrupted;
    status.input_tick = line.inputs.contiguous_tick(confirmed.newest_tick());
    status.confirmed_tick = line.confirmed_tick;
    status.hash_tick = line.hash_tick;
    return status;
}

} // namespace lockwind
