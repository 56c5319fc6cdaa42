#include "session/lockstep_server_match.h"

#include <utility>

namespace lockwind {
namespace {

constexpr std::uint64_t kUsPerMs = 1000;
/// A dropped client that still talks is told so this often.
constexpr std::uint64_t kRebukeIntervalUs = 250'000;

std::string hex(std::uint64_t value) {
    std::string text(16, '0');
    for (std::size_t digit = 16; digit-- > 0; value >>= 4U) {
        text[digit] = "0123456789abcdef"[value & 15U];
    }
    return text;
}

} // namespace

void LockstepServer::Match::on_hello(PeerId from, const Hello& hello) {
    if (phase != MatchPhase::gathering && phase != MatchPhase::running) {
        send(from, Refuse{RefuseReason::match_over, "", "the match is over"});
        return;
    }
    const Admission admission = roster_.admit(from, hello, now_us_);
    const Slot slot = admission.slot;
    switch (admission.kind) {
    case Admission::Kind::refused:
        if (admission.refuse.reason != RefuseReason::match_full &&
            admission.refuse.reason != RefuseReason::token_in_use &&
            admission.refuse.reason != RefuseReason::misconduct) {
            counters.violations.add(Violation::bad_hello);
        }
        send(from, admission.refuse);
        break;
    case Admission::Kind::too_soon:
        counters.violations.add(Violation::hello_flood);
        break;
    case Admission::Kind::repeated:
        if (roster_.at(slot).state == SlotState::joining && lines_[slot].welcomed &&
            now_us_ >= lines_[slot].welcome_us) {
            welcome(slot, lines_[slot].resume_tick == 0 ? 0 : lines_[slot].snapshot.transfer());
        }
        break;
    case Admission::Kind::replaces:
        drop(slot, "its player connected anew");
        seat(slot, from, hello);
        break;
    case Admission::Kind::seated:
        seat(slot, from, hello);
        break;
    }
}

void LockstepServer::Match::seat(Slot slot, PeerId from, const Hello& hello) {
    const Tick tick = confirmed.newest_tick();
    Line& line = lines_[slot];
    if (roster_.at(slot).token != hello.token) {
        line.conduct = Conduct(conduct_of(settings));
    }
    roster_.seat(slot, from, hello, now_us_);
    line.inputs.reset();
    line.report = BlobReceiver();
    line.confirmed_tick = tick;
    line.hash_tick = tick;
    line.resume_tick = tick;
    line.resume_hash = settings.initial_state_hash;
    line.welcomed = false;
    line.lagging = false;
    line.echo_us = 0;
    line.piece_us = 0;
    notify(SessionEventKind::synchronizing, slot, tick, hello.build_info);
    if (tick == 0) {
        welcome(slot, 0);
    } else {
        requests.push_back(SnapshotRequest{slot, tick}); // behind the AdvanceRequest of this tick
    }
}

void LockstepServer::Match::snapshot_saved(Slot slot,
                                           Tick tick,
                                           std::uint64_t hash,
                                           std::vector<std::byte> bytes) {
    Line& line = lines_[slot];
    const bool awaited = roster_.at(slot).state == SlotState::joining && !line.welcomed;
    if (!awaited || line.resume_tick != tick) {
        return; // the player has gone, or come again, meanwhile
    }
    line.resume_hash = hash;
    line.snapshot.start(BlobKind::snapshot, ++snapshots_, std::move(bytes));
    welcome(slot, line.snapshot.transfer());
}

void LockstepServer::Match::welcome(Slot slot, std::uint32_t transfer) {
    const Seat& seat = roster_.at(slot);
    Welcome message;
    message.slot = slot;
    message.config = settings.config;
    message.sim_version = settings.sim_version;
    message.build_info = settings.build_info;
    message.resume_tick = lines_[slot].resume_tick;
    message.transfer = transfer;
    message.attempt = seat.attempt;
    lines_[slot].welcomed = true;
    lines_[slot].welcome_us = now_us_ + settings.welcome_interval_ms * kUsPerMs;
    send(seat.peer, std::move(message));
}

void LockstepServer::Match::on_ready(Slot slot, const Ready& ready) {
    const Seat& seat = roster_.at(slot);
    Line& line = lines_[slot];
    if (seat.attached()) {
        send_status(seat.peer); // it has not heard yet that it is
        return;
    }
    if (!line.welcomed || ready.tick != line.resume_tick) {
        return; // of an earlier connection
    }
    if (ready.state_hash != line.resume_hash) {
        counters.violations.add(Violation::bad_state_hash);
        send(seat.peer,
             Refuse{RefuseReason::config,
                    "state_hash",
                    "state of tick " + std::to_string(ready.tick) + ": the server has " +
                        hex(line.resume_hash) + ", the client " + hex(ready.state_hash)});
        vacate(slot, seat.has_played ? SlotState::dropped : SlotState::empty);
        return;
    }
    line.snapshot.cancel();
    roster_.set_state(slot, SlotState::catching_up);
    notify(SessionEventKind::synchronized, slot, ready.tick, "");
    send_status(seat.peer);
}

void LockstepServer::Match::vacate(Slot slot, SlotState state) {
    roster_.set_state(slot, state);
    Line& line = lines_[slot];
    line.inputs.reset();
    line.snapshot.cancel();
    line.report.close();
    line.lagging = false;
}

void LockstepServer::Match::drop(Slot slot, const std::string& why) {
    const Seat& seat = roster_.at(slot);
    ++counters.drops;
    send(seat.peer, End{EndReason::dropped, confirmed.newest_tick(), seat.attempt, why});
    vacate(slot, seat.has_played ? SlotState::dropped : SlotState::empty);
    notify(SessionEventKind::dropped, slot, confirmed.newest_tick(), why);
}

void LockstepServer::Match::leave(Slot slot, const End& end_of_client) {
    vacate(slot, roster_.at(slot).has_played ? SlotState::left : SlotState::empty);
    notify(SessionEventKind::left, slot, confirmed.newest_tick(), end_of_client.message);
}

/// Tells a peer without a seat that it has none any more: else it might wait for ever.
void LockstepServer::Match::rebuke(PeerId from) {
    FormerPeer* former = roster_.former(from);
    if (former == nullptr) {
        counters.violations.add(Violation::unknown_peer);
    } else if (!former->left && now_us_ >= former->told_us + kRebukeIntervalUs) {
        former->told_us = now_us_;
        send(from,
             End{EndReason::dropped,
                 confirmed.newest_tick(),
                 former->attempt,
                 "the slot was dropped"});
    }
}

void LockstepServer::Match::check_silence() {
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        switch (roster_.check_silence(slot, now_us_)) {
        case Roster::Silence::none:
            break;
        case Roster::Silence::begins:
            notify(SessionEventKind::interrupted, slot, confirmed.newest_tick(), "");
            break;
        case Roster::Silence::too_long:
            // Who re-simulates for a report may say nothing for long; report_timeout_ms binds him.
            if (phase != MatchPhase::halted) {
                drop(slot, "nothing heard for " + std::to_string(settings.drop_timeout_ms) + " ms");
            }
            break;
        case Roster::Silence::never_ready:
            if (phase != MatchPhase::halted) {
                drop(slot, "not ready within " + std::to_string(settings.ready_timeout_ms) + " ms");
            }
            break;
        }
    }
}

ConductSettings LockstepServer::Match::conduct_of(const LockstepServerSettings& settings) {
    ConductSettings conduct = settings.conduct;
    conduct.messages_per_s += 8 * settings.config.tick_rate_hz;
    return conduct;
}

/// Who held `slot` when a message of his came has offended where there are more offences now.
void LockstepServer::Match::check_conduct(Slot slot, std::uint64_t offences_before) {
    if (slot == kNoSlot || counters.violations.offences() == offences_before) {
        return;
    }
    const bool bearable = lines_[slot].conduct.offences.take(now_us_);
    if (!bearable && roster_.at(slot).connected() && phase <= MatchPhase::settling) {
        roster_.ban(roster_.at(slot).token);
        drop(slot, "broke the protocol again and again");
        if (roster_.at(slot).state == SlotState::dropped) {
            roster_.set_state(slot, SlotState::left); // who is banned does not come back to it
        }
    }
}

void LockstepServer::Match::gather() {
    if (gather_deadline_us_ == 0) {
        gather_deadline_us_ = now_us_ + settings.join_timeout_ms * kUsPerMs;
    }
    const std::uint32_t playing = roster_.count(SlotState::playing);
    const bool waited_enough = now_us_ >= gather_deadline_us_;
    if (playing == settings.config.players || (waited_enough && playing > 0)) {
        start();
    } else if (waited_enough) {
        end(EndReason::failed,
            "no player joined within " + std::to_string(settings.join_timeout_ms) + " ms");
    }
}

void LockstepServer::Match::start() {
    phase = MatchPhase::running;
    clock_.start(now_us_ + settings.start_delay_ms * kUsPerMs);
    notify(SessionEventKind::started,
           kNoSlot,
           0,
           std::to_string(roster_.count(SlotState::playing)) + " of " +
               std::to_string(settings.config.players) + " players");
}

} // namespace lockwind
