#include "session/lockstep_client_player.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lockwind {
namespace {

constexpr std::uint64_t kUsPerMs = 1000;

} // namespace

void LockstepClient::Player::greet() {
    if (connect_deadline_us_ == 0) {
        ++attempt_;
        connect_deadline_us_ = now_us_ + settings.connect_timeout_ms * kUsPerMs;
        greeting_us_ = now_us_;
        notify(SessionEventKind::synchronizing, advanced_tick, "");
    }
    if (now_us_ >= connect_deadline_us_) {
        finish(EndReason::failed,
               "the server gave no place in the match within " +
                   std::to_string(settings.connect_timeout_ms) + " ms" +
                   (end_message.empty() ? "" : ": " + end_message));
        return;
    }
    if (now_us_ >= greeting_us_) {
        greeting_us_ = now_us_ + settings.hello_interval_ms * kUsPerMs;
        send(Hello{
            kProtocolVersion, settings.sim_version, settings.build_info, settings.token, attempt_});
    }
}

void LockstepClient::Player::on_welcome(const Welcome& welcome) {
    if (phase != ClientPhase::greeting || welcome.attempt != attempt_) {
        return; // doubled
    }
    if (welcome.sim_version != settings.sim_version) {
        leave(EndReason::failed,
              "the server simulates with version " + welcome.sim_version + ", this client with " +
                  settings.sim_version);
        return;
    }
    const Status valid = check(welcome.config);
    if (!valid || welcome.slot >= welcome.config.players || welcome.resume_tick > kMatchTicksMax) {
        leave(EndReason::failed,
              valid ? "the server's Welcome names no slot of the match" : valid.error().message);
        return;
    }
    phase = ClientPhase::creating;
    slot = welcome.slot;
    config = welcome.config;
    end_message.clear();
    resume_tick_ = welcome.resume_tick;
    created_ = false;
    snapshot_.reset();
    if (resume_tick_ > 0) {
        snapshot_receiver_.expect(
            BlobKind::snapshot, settings.snapshot_size_bytes_max, welcome.transfer);
    }
    requests.push_back(CreateRequest{config, slot});
}

void LockstepClient::Player::created(std::uint64_t hash, std::uint32_t input_size_bytes) {
    LOCKWIND_ASSERT(input_size_bytes >= 1 && input_size_bytes <= kInputSizeBytesMax);
    if (phase != ClientPhase::creating) {
        return; // ended meanwhile
    }
    input_size_bytes_ = input_size_bytes;
    created_ = true;
    if (resume_tick_ == 0) {
        begin(0, hash);
    } else {
        phase = ClientPhase::receiving;
        take_snapshot();
    }
}

void LockstepClient::Player::on_chunk(const Chunk& chunk) {
    BlobReceiver::Outcome outcome = snapshot_receiver_.receive(chunk);
    // An unsolicited one may be of a connection that is given up: the Welcome says which one
    // counts.
    if (outcome.violation == Violation::chunk_malformed) {
        counters.violations.add(*outcome.violation);
    }
    if (outcome.ack) {
        send(*outcome.ack);
    }
    if (outcome.blob) {
        snapshot_ = std::move(outcome.blob);
        take_snapshot();
    }
}

void LockstepClient::Player::take_snapshot() {
    if (phase == ClientPhase::receiving && snapshot_) {
        phase = ClientPhase::restoring;
        requests.push_back(RestoreRequest{resume_tick_, std::move(snapshot_->bytes)});
        snapshot_.reset();
    }
}

void LockstepClient::Player::restored(std::uint64_t hash) {
    if (phase == ClientPhase::restoring) {
        begin(resume_tick_, hash);
    }
}

/// The simulation stands at `tick`: nothing of an earlier connection counts any more.
void LockstepClient::Player::begin(Tick tick, std::uint64_t hash) {
    phase = ClientPhase::ready;
    attached_ = false;
    greeting_us_ = now_us_;
    ready_hash_ = hash;
    received = ConfirmedHistory(tick);
    ahead_.clear();
    server_tick_ = tick;
    advanced_tick = tick;
    handed_tick_ = tick;
    confirmed_us_ = 0;
    agreed_tick = tick;
    state_hash = hash;
    state_hash_tick = tick;
    inputs_.clear();
    inputs_tick_ = tick + 1;
    inputs_added_ = false;
    ticks_received_ = false;
    hashes_.clear();
    hashes_sent_tick_ = tick;
    queried_tick_ = 0;
    blob_.cancel();
}

void LockstepClient::Player::say_ready() {
    if (!attached_ && now_us_ >= greeting_us_) {
        greeting_us_ = now_us_ + settings.hello_interval_ms * kUsPerMs;
        send(Ready{resume_tick_, ready_hash_});
    }
}

void LockstepClient::Player::on_refuse(const Refuse& refuse) {
    if (phase == ClientPhase::playing || phase == ClientPhase::ended) {
        return; // doubled
    }
    if (refuse.reason == RefuseReason::token_in_use && phase == ClientPhase::greeting) {
        end_message = refuse.message; // until the server misses who held the slot before
        return;
    }
    refused = true;
    finish(EndReason::failed,
           refuse.message.empty() ? std::string(to_string(refuse.reason)) : refuse.message);
}

void LockstepClient::Player::on_end(const End& end) {
    if (end.reason == EndReason::dropped) {
        if (phase != ClientPhase::greeting && phase != ClientPhase::ended &&
            end.attempt == attempt_) {
            connect_anew(end.message);
        }
        return;
    }
    send(End{EndReason::left, received.newest_tick(), attempt_, ""}); // the server waits for it
    if (phase != ClientPhase::ended) {
        finish(end.reason, end.message);
    }
}

void LockstepClient::Player::connect_anew(const std::string& why) {
    notify(SessionEventKind::dropped, received.newest_tick(), why);
    if (!settings.reconnect) {
        finish(EndReason::dropped, why);
        return;
    }
    ++counters.reconnects;
    phase = ClientPhase::greeting;
    connect_deadline_us_ = 0;
    interrupted_ = false;
    attached_ = false;
    snapshot_receiver_.close();
    blob_.cancel();
}

void LockstepClient::Player::check_silence() {
    if (phase != ClientPhase::playing) {
        if (now_us_ >= connect_deadline_us_) {
            leave(EndReason::failed,
                  "the match was not reached within " +
                      std::to_string(settings.connect_timeout_ms) + " ms");
        }
        return;
    }
    const std::uint64_t silent_us = now_us_ - heard_us_;
    if (silent_us >= settings.drop_timeout_ms * kUsPerMs) {
        connect_anew("nothing heard for " + std::to_string(settings.drop_timeout_ms) + " ms");
    } else if (!interrupted_ && silent_us >= settings.interrupted_timeout_ms * kUsPerMs) {
        interrupted_ = true;
        notify(SessionEventKind::interrupted, received.newest_tick(), "");
    }
}

void LockstepClient::Player::leave(EndReason reason, const std::string& message) {
    if (phase != ClientPhase::ended) {
        send(End{reason, received.newest_tick(), attempt_, message});
        finish(reason, message);
    }
}

void LockstepClient::Player::finish(EndReason reason, const std::string& message) {
    phase = ClientPhase::ended;
    end_reason = reason;
    end_message = message;
    notify(SessionEventKind::ended, received.newest_tick(), message);
}

} // namespace lockwind
