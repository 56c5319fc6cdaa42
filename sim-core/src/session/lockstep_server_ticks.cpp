#include "session/lockstep_server_match.h"

#include <algorithm>
#include <utility>

namespace lockwind {
namespace {

constexpr std::uint64_t kUsPerMs = 1000;
/// Clients hear from the server at least this often.
constexpr std::uint64_t kStatusIntervalUs = 100'000;
constexpr std::uint64_t kRepeatIntervalUsMin = 5'000;
/// A catch-up piece is repeated where nothing of it was acknowledged for this long.
constexpr std::uint64_t kPieceIntervalUs = 100'000;
/// Even with many players a broadcast repeats as many ticks, so that few lost ones cost a piece.
constexpr std::size_t kTicksPerMessageMin = 4;
/// Upper estimates of encoded sizes.
constexpr std::size_t kAckSizeBytes = 40;
constexpr std::size_t kInputOverheadBytes = 6;
constexpr std::size_t kTickOverheadBytes = 8;

} // namespace

void LockstepServer::Match::on_input_batch(Slot slot, const InputBatch& batch) {
    if (!speaks_for(slot, batch.slot)) {
        return;
    }
    const Tick newest = confirmed.newest_tick();
    Line& line = lines_[slot];
    if (!roster_.at(slot).attached()) {
        return; // of an earlier connection, or early
    }
    if (batch.inputs.size() > kInputBatchTicksMax) {
        counters.violations.add(Violation::input_malformed);
        return;
    }
    if (batch.confirmed_tick > newest) {
        counters.violations.add(Violation::ack_unconfirmed);
        return;
    }
    line.confirmed_tick = std::max(line.confirmed_tick, batch.confirmed_tick);
    if (batch.sent_us > line.echo_us) {
        line.echo_us = batch.sent_us;
        line.echo_arrived_us = now_us_;
    }
    counters.late_inputs +=
        line.inputs.receive(batch.first_tick, batch.inputs, newest, counters.violations);
    const bool may_play = phase == MatchPhase::gathering || phase == MatchPhase::running;
    const bool caught_up = newest - line.hash_tick <= settings.hash_lag_ticks_max / 2;
    if (may_play && caught_up && roster_.at(slot).state == SlotState::catching_up &&
        line.inputs.find(newest + 1) != nullptr) {
        start_playing(slot);
    }
}

void LockstepServer::Match::start_playing(Slot slot) {
    const bool came_back = roster_.at(slot).has_played;
    const Tick newest = confirmed.newest_tick();
    roster_.set_state(slot, SlotState::playing);
    lines_[slot].inputs.count_late_after(newest);
    ++(came_back ? counters.reconnects : counters.joins);
    notify(came_back ? SessionEventKind::reconnected : SessionEventKind::joined,
           slot,
           newest + 1,
           roster_.at(slot).build_info);
}

void LockstepServer::Match::run() {
    check_abandoned();
    drop_laggards();
    if (phase != MatchPhase::running || advancing()) {
        return;
    }
    const Tick tick = confirmed.newest_tick() + 1;
    if (now_us_ < clock_.due_us(tick)) {
        return;
    }
    if (!inputs_complete(tick)) {
        stall(tick);
    }
    if (inputs_complete(tick)) {
        finish_stall(tick);
        confirm(tick);
    }
}

bool LockstepServer::Match::waits_for(Slot slot, Tick tick) const {
    const Line& line = lines_[slot];
    return roster_.at(slot).state == SlotState::playing && !line.lagging &&
           line.inputs.find(tick) == nullptr;
}

bool LockstepServer::Match::inputs_complete(Tick tick) const {
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        if (waits_for(slot, tick)) {
            return false;
        }
    }
    return true;
}

void LockstepServer::Match::stall(Tick tick) {
    if (!stalled_) {
        stalled_ = true;
        stall_policy_applied_ = false;
        stall_began_us_ = now_us_;
        counters.stalls += behind_ ? 0U : 1U;
    }
    if (!stall_policy_applied_ &&
        now_us_ - stall_began_us_ >= settings.stall_timeout_ms * kUsPerMs) {
        stall_policy_applied_ = true;
        apply_stall_policy(tick);
    }
}

void LockstepServer::Match::apply_stall_policy(Tick tick) {
    const std::string why = "no input for " + std::to_string(settings.stall_timeout_ms) + " ms";
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        if (!waits_for(slot, tick)) {
            continue;
        }
        notify(SessionEventKind::stalled, slot, tick, why);
        if (settings.stall_policy == StallPolicy::substitute) {
            lines_[slot].lagging = true;
        } else if (settings.stall_policy == StallPolicy::drop) {
            drop(slot, why);
        }
    }
    if (settings.stall_policy == StallPolicy::pause) {
        paused_ = true;
        notify(SessionEventKind::paused, kNoSlot, tick, why);
    }
}

void LockstepServer::Match::finish_stall(Tick tick) {
    if (!stalled_) {
        behind_ = behind_ && now_us_ >= clock_.due_us(tick + 1);
        return;
    }
    const std::uint64_t stall_ms = (now_us_ - stall_began_us_) / kUsPerMs;
    counters.stall_ms_max = std::max(counters.stall_ms_max, stall_ms);
    if (paused_) {
        const std::uint64_t pause_us = now_us_ - clock_.due_us(tick);
        clock_.rebase(pause_us);
        notify_unpaused(tick, pause_us, "the clock stood still");
    }
    behind_ = !paused_;
    stalled_ = false;
    paused_ = false;
}

/// To be asked once a tick, in slot order, before the tick is pushed.
SlotInput LockstepServer::Match::confirmed_input(Slot slot, Tick tick) {
    if (roster_.at(slot).state != SlotState::playing) {
        return SlotInput{};
    }
    Line& line = lines_[slot];
    if (const SlotInput* input = line.inputs.find(tick)) {
        line.lagging = false;
        return *input;
    }
    ++counters.substituted_inputs;
    SlotInput input;
    if (const auto last = confirmed.find(tick - 1); !last.empty()) {
        input = last[slot];
    }
    input.status = InputStatus::substituted;
    return input;
}

// The server steps first: the record that is written before anybody hears of the tick then holds
// its hash too, and a tick that cannot be stepped is never confirmed. Telling the clients before
// the step would let all step at the same time, and save one step of a latency of
// input_delay_ticks.
void LockstepServer::Match::confirm(Tick tick) {
    std::vector<SlotInput> inputs(roster_.size());
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        inputs[slot] = confirmed_input(slot, tick);
    }
    confirmed.push(inputs);
    requests.push_back(AdvanceRequest{tick, inputs, hash_due(settings.config, tick)});
    requests.push_back(PersistRequest{tick, std::move(inputs)});
    send_confirmations();
    discard_history();
}

void LockstepServer::Match::drop_laggards() {
    const Tick newest = confirmed.newest_tick();
    const Tick hash_lag_max = settings.hash_lag_ticks_max + settings.config.hash_interval_ticks;
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        const Seat& seat = roster_.at(slot);
        const Line& line = lines_[slot];
        if (seat.state == SlotState::playing && newest - line.hash_tick > hash_lag_max) {
            drop(slot, "no state hash since tick " + std::to_string(line.hash_tick));
        } else if (seat.connected() && newest - line.confirmed_tick > settings.catch_up_ticks_max) {
            drop(slot,
                 "stands at tick " + std::to_string(line.confirmed_tick) + ", too far behind");
        }
    }
}

// A match of a given length is played to its end whoever is there. Without one it ends with its
// last player; who was dropped may still come back for a while.
void LockstepServer::Match::check_abandoned() {
    if (settings.config.ticks != 0) {
        return;
    }
    if (roster_.connected_count() > 0) {
        nobody_since_us_ = 0;
        return;
    }
    if (nobody_since_us_ == 0) {
        nobody_since_us_ = now_us_;
    }
    if (roster_.count(SlotState::dropped) == 0) {
        settle(EndReason::complete, "all players have left");
    } else if (now_us_ - nobody_since_us_ >= settings.abandon_timeout_ms * kUsPerMs) {
        settle(EndReason::complete, "no dropped player came back");
    }
}

std::size_t LockstepServer::Match::ticks_per_message(std::size_t size_bytes) const {
    const std::size_t tick_bytes =
        kTickOverheadBytes + roster_.size() * (kInputOverheadBytes + settings.input_size_bytes);
    const std::size_t ack_bytes = roster_.size() * kAckSizeBytes;
    const std::size_t ticks = size_bytes > ack_bytes ? (size_bytes - ack_bytes) / tick_bytes : 0;
    return std::clamp(ticks, kTicksPerMessageMin, kConfirmationTicksMax);
}

Confirmation LockstepServer::Match::acknowledgements() const {
    Confirmation confirmation;
    confirmation.first_tick = confirmed.newest_tick() + 1;
    confirmation.confirmed_tick = confirmed.newest_tick();
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        const Line& line = lines_[slot];
        SlotAck ack;
        ack.input_tick = line.inputs.contiguous_tick(confirmed.newest_tick());
        ack.hash_tick = line.hash_tick;
        ack.attached = roster_.at(slot).attached();
        if (line.echo_us != 0) {
            ack.echo_us = line.echo_us;
            ack.echo_hold_us = static_cast<std::uint32_t>(
                std::min<std::uint64_t>(now_us_ - line.echo_arrived_us, 0xffffffffU));
        }
        confirmation.acks.push_back(ack);
    }
    return confirmation;
}

void LockstepServer::Match::send_status(PeerId to) {
    send(to, acknowledgements());
}

void LockstepServer::Match::send_confirmations() {
    const Tick newest = confirmed.newest_tick();
    Tick first_tick = newest + 1;
    bool anybody = false;
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        if (roster_.at(slot).attached()) {
            anybody = true;
            first_tick = std::min(first_tick, lines_[slot].confirmed_tick + 1);
        }
    }
    const std::uint64_t repeat_us =
        std::clamp(2 * tick_period_us(settings.config), kRepeatIntervalUsMin, kStatusIntervalUs);
    status_us_ = now_us_ + (first_tick <= newest ? repeat_us : kStatusIntervalUs);
    if (!anybody) {
        return;
    }
    const std::size_t ticks_max = ticks_per_message(settings.confirmation_size_bytes);
    if (newest >= ticks_max) {
        first_tick = std::max<Tick>(first_tick, newest + 1 - ticks_max);
    }
    Confirmation confirmation = acknowledgements();
    confirmed.fill(confirmation, first_tick, ticks_max);
    send(kAllPeers, std::move(confirmation));
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        if (roster_.at(slot).attached() && lines_[slot].confirmed_tick + 1 < first_tick) {
            send_piece(slot);
        }
    }
}

void LockstepServer::Match::send_piece(Slot slot) {
    Line& line = lines_[slot];
    if (line.piece_tick == line.confirmed_tick && now_us_ < line.piece_us + kPieceIntervalUs) {
        return;
    }
    line.piece_tick = line.confirmed_tick;
    line.piece_us = now_us_;
    Confirmation piece = acknowledgements();
    confirmed.fill(piece, line.confirmed_tick + 1, ticks_per_message(settings.catch_up_size_bytes));
    send(roster_.at(slot).peer, std::move(piece));
}

void LockstepServer::Match::poll_snapshots() {
    std::vector<Chunk> chunks;
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        chunks.clear();
        lines_[slot].snapshot.poll(now_us_, chunks);
        for (Chunk& chunk : chunks) {
            send(roster_.at(slot).peer, std::move(chunk));
        }
    }
}

} // namespace lockwind
