#include "session/lockstep_server_match.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <utility>

namespace lockwind {
namespace {

constexpr std::uint64_t kUsPerMs = 1000;
constexpr std::uint64_t kQueryIntervalUs = 500'000;
constexpr std::uint64_t kEndIntervalUs = 100'000;

} // namespace

void LockstepServer::Match::on_hash_report(Slot slot, const HashReport& report) {
    if (!speaks_for(slot, report.slot)) {
        return;
    }
    const bool under_inquiry =
        std::any_of(inquiries_.begin(), inquiries_.end(), [slot](const Inquiry& inquiry) {
            return inquiry.desync.slot == slot;
        });
    if (!roster_.at(slot).attached() || under_inquiry) {
        return;
    }
    Line& line = lines_[slot];
    const HashLedger::Verdict verdict =
        ledger_.verify(report, line.hash_tick, confirmed.newest_tick(), counters.violations);
    line.hash_tick = verdict.agreed_tick;
    counters.hashes_agreed += verdict.agreed_count;
    if (verdict.mismatch) {
        begin_inquiry(HashMismatch{slot,
                                   verdict.agreed_tick,
                                   verdict.mismatch->tick,
                                   verdict.mismatch->own_hash,
                                   verdict.mismatch->reported_hash});
    }
}

/// Policy halt: no further tick is confirmed.
void LockstepServer::Match::begin_inquiry(const HashMismatch& desync) {
    ++counters.desyncs;
    desyncs.push_back(desync);
    inquiries_.push_back(Inquiry{desync, now_us_, false});
    lines_[desync.slot].report.expect(BlobKind::desync_report, settings.report_size_bytes_max);
    notify(SessionEventKind::desync_detected,
           desync.slot,
           desync.bad_tick,
           "agreed up to tick " + std::to_string(desync.agreed_tick));
    if (phase != MatchPhase::halted) {
        phase = MatchPhase::halted;
        phase_deadline_us_ = now_us_ + settings.report_timeout_ms * kUsPerMs;
        others_deadline_us_ = now_us_ + settings.settle_timeout_ms * kUsPerMs;
    }
}

void LockstepServer::Match::inquire() {
    Tick bad_tick = confirmed.newest_tick();
    bool resolved = true;
    for (Inquiry& inquiry : inquiries_) {
        const HashMismatch& desync = inquiry.desync;
        bad_tick = std::min(bad_tick, desync.bad_tick);
        if (inquiry.resolved) {
            continue;
        }
        if (!roster_.at(desync.slot).connected() || now_us_ >= phase_deadline_us_) {
            resolve(inquiry, {});
            continue;
        }
        resolved = false;
        if (now_us_ >= inquiry.query_us && lines_[desync.slot].report.received_bytes() == 0) {
            inquiry.query_us = now_us_ + kQueryIntervalUs;
            send(roster_.at(desync.slot).peer,
                 DesyncQuery{
                     desync.agreed_tick, desync.bad_tick, desync.server_hash, desync.client_hash});
        }
    }
    // The others' hashes of that tick are on their way; whoever differs too is asked as well.
    const bool others_awaited = hashes_awaited(bad_tick) && now_us_ < others_deadline_us_;
    if (resolved && !others_awaited) {
        end(EndReason::desync,
            "desync at tick " + std::to_string(bad_tick) + " in " +
                std::to_string(inquiries_.size()) + " of " + std::to_string(roster_.size()) +
                " slots");
    }
}

void LockstepServer::Match::resolve(Inquiry& inquiry, std::vector<std::byte> report) {
    inquiry.resolved = true;
    lines_[inquiry.desync.slot].report.close();
    requests.push_back(BundleRequest{inquiry.desync, std::move(report)});
}

void LockstepServer::Match::on_chunk(Slot slot, const Chunk& chunk) {
    BlobReceiver::Outcome outcome = lines_[slot].report.receive(chunk);
    if (outcome.violation) {
        counters.violations.add(*outcome.violation);
    }
    if (outcome.ack) {
        send(roster_.at(slot).peer, *outcome.ack);
    }
    const auto inquiry =
        std::find_if(inquiries_.begin(), inquiries_.end(), [slot](const Inquiry& candidate) {
            return candidate.desync.slot == slot && !candidate.resolved;
        });
    if (outcome.blob && inquiry != inquiries_.end()) {
        resolve(*inquiry, std::move(outcome.blob->bytes));
    }
}

/// Has somebody who has the world, and with whom there is no quarrel, not reported `tick` yet?
bool LockstepServer::Match::hashes_awaited(Tick tick) const {
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        const bool under_inquiry =
            std::any_of(inquiries_.begin(), inquiries_.end(), [slot](const Inquiry& inquiry) {
                return inquiry.desync.slot == slot;
            });
        if (roster_.at(slot).attached() && !under_inquiry && lines_[slot].hash_tick < tick) {
            return true;
        }
    }
    return false;
}

void LockstepServer::Match::settle(EndReason reason, const std::string& message) {
    phase = MatchPhase::settling;
    phase_deadline_us_ = now_us_ + settings.settle_timeout_ms * kUsPerMs;
    pending_reason_ = reason;
    pending_message_ = message;
}

void LockstepServer::Match::check_settled() {
    if (advancing()) {
        return;
    }
    if (hashes_awaited(state_hash_tick) && now_us_ < phase_deadline_us_) {
        return;
    }
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        if (roster_.at(slot).attached() && lines_[slot].hash_tick < state_hash_tick) {
            drop(slot, "no state hash since tick " + std::to_string(lines_[slot].hash_tick));
        }
    }
    end(pending_reason_, pending_message_);
}

void LockstepServer::Match::stop(const std::string& reason) {
    if (phase == MatchPhase::gathering) {
        end(EndReason::stopped, reason);
    } else if (phase == MatchPhase::running) {
        settle(EndReason::stopped, reason);
    } else if (phase == MatchPhase::halted) {
        phase_deadline_us_ =
            std::min(phase_deadline_us_, now_us_ + settings.settle_timeout_ms * kUsPerMs);
    }
}

void LockstepServer::Match::fail(const std::string& message, Tick recorded_tick) {
    LOCKWIND_ASSERT(recorded_tick + 1 >= confirmed.newest_tick());
    if (confirmed.newest_tick() > recorded_tick) {
        confirmed.retract(); // nobody has heard of it
    }
    advanced_tick = std::min(advanced_tick, recorded_tick);
    if (state_hash_tick > recorded_tick) {
        state_hash = previous_hash_;
        state_hash_tick = previous_hash_tick_;
    }
    end(EndReason::failed, message);
}

void LockstepServer::Match::end(EndReason reason, const std::string& message) {
    if (phase == MatchPhase::closing || phase == MatchPhase::ended) {
        return;
    }
    for (Inquiry& inquiry : inquiries_) {
        if (!inquiry.resolved) {
            resolve(inquiry, {});
        }
    }
    for (Line& line : lines_) {
        line.snapshot.cancel();
    }
    phase = MatchPhase::closing;
    end_reason = reason;
    end_message = message;
    phase_deadline_us_ = now_us_ + settings.close_timeout_ms * kUsPerMs;
    status_us_ = now_us_;
    notify(SessionEventKind::ended, kNoSlot, confirmed.newest_tick(), message);
    close();
}

void LockstepServer::Match::close() {
    bool answered = true;
    for (Slot slot = 0; slot < roster_.size(); ++slot) {
        const Seat& seat = roster_.at(slot);
        if (!seat.connected() || lines_[slot].end_answered) {
            continue;
        }
        answered = false;
        if (now_us_ >= status_us_) {
            send(seat.peer, End{end_reason, confirmed.newest_tick(), 0, end_message});
        }
    }
    if (now_us_ >= status_us_) {
        status_us_ = now_us_ + kEndIntervalUs;
    }
    if (answered || now_us_ >= phase_deadline_us_) {
        phase = MatchPhase::ended;
    }
}

void LockstepServer::Match::on_message_while_closing(PeerId from, const Message& message) {
    if (std::holds_alternative<Hello>(message)) {
        send(from, Refuse{RefuseReason::match_over, "", "the match is over"});
        return;
    }
    const Slot slot = roster_.slot_of(from);
    if (slot != kNoSlot && std::holds_alternative<End>(message)) {
        lines_[slot].end_answered = true;
    }
}

} // namespace lockwind
