#include "session/lockstep_client.h"

#include "session/lockstep_client_player.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lockwind {

LockstepClient::LockstepClient(const LockstepClientSettings& settings)
    : player_(std::make_unique<Player>(settings)) {}
LockstepClient::~LockstepClient() = default;
LockstepClient::LockstepClient(LockstepClient&&) noexcept = default;
LockstepClient& LockstepClient::operator=(LockstepClient&&) noexcept = default;

void LockstepClient::receive(PeerId from, const Message& message, std::uint64_t now_us) {
    player_->receive(from, message, now_us);
}

void LockstepClient::update(std::uint64_t now_us) {
    player_->update(now_us);
}

std::vector<Request> LockstepClient::take_requests() {
    return std::exchange(player_->requests, {});
}

std::uint64_t LockstepClient::next_deadline_us() const {
    return player_->next_deadline_us();
}

void LockstepClient::created(std::uint64_t state_hash, std::uint32_t input_size_bytes) {
    player_->created(state_hash, input_size_bytes);
}

void LockstepClient::restored(std::uint64_t state_hash) {
    player_->restored(state_hash);
}

void LockstepClient::advanced(Tick tick, std::uint64_t hash) {
    player_->advanced(tick, hash);
}

void LockstepClient::send_blob(BlobKind kind, std::vector<std::byte> bytes) {
    player_->send_blob(kind, std::move(bytes));
}

void LockstepClient::leave() {
    player_->leave(EndReason::left, "");
}

void LockstepClient::fail(const std::string& message) {
    player_->leave(EndReason::failed, message);
}

bool LockstepClient::wants_input() const {
    return player_->wants_input();
}

Tick LockstepClient::next_input_tick() const {
    return player_->next_input_tick();
}

void LockstepClient::add_local_input(Tick tick, const SlotInput& input) {
    player_->add_local_input(tick, input);
}

ClientPhase LockstepClient::phase() const {
    return player_->phase;
}

EndReason LockstepClient::end_reason() const {
    return player_->end_reason;
}

const std::string& LockstepClient::end_message() const {
    return player_->end_message;
}

bool LockstepClient::refused() const {
    return player_->refused;
}

Slot LockstepClient::slot() const {
    return player_->slot;
}

const MatchConfig& LockstepClient::config() const {
    return player_->config;
}

Tick LockstepClient::confirmed_tick() const {
    return player_->received.newest_tick();
}

Tick LockstepClient::advanced_tick() const {
    return player_->advanced_tick;
}

std::uint64_t LockstepClient::state_hash() const {
    return player_->state_hash;
}

Tick LockstepClient::state_hash_tick() const {
    return player_->state_hash_tick;
}

const LockstepClientCounters& LockstepClient::counters() const {
    return player_->counters;
}

Tick LockstepClient::oldest_needed_tick() const {
    return player_->agreed_tick;
}

std::span<const SlotInput> LockstepClient::confirmed_inputs(Tick tick) const {
    return player_->received.find(tick);
}

LockstepClient::Player::Player(const LockstepClientSettings& player_settings)
    : settings(player_settings) {
    LOCKWIND_ASSERT(settings.token != 0);
    LOCKWIND_ASSERT(settings.advance_ticks_max >= 1);
}

void LockstepClient::Player::send(Message message) {
    const Delivery delivery = delivery_of(message);
    requests.push_back(SendRequest{kServerPeer, delivery, std::move(message)});
}

void LockstepClient::Player::notify(SessionEventKind kind, Tick tick, std::string text) {
    requests.push_back(NotifyRequest{SessionEvent{kind, slot, tick, std::move(text)}});
}

void LockstepClient::Player::receive(PeerId from, const Message& message, std::uint64_t now_us) {
    now_us_ = std::max(now_us_, now_us);
    if (from != kServerPeer) {
        counters.violations.add(Violation::unknown_peer);
        return;
    }
    heard_us_ = now_us_;
    if (interrupted_) {
        interrupted_ = false;
        notify(SessionEventKind::resumed, received.newest_tick(), "");
    }
    if (const auto* confirmation = std::get_if<Confirmation>(&message)) {
        on_confirmation(*confirmation);
    } else if (const auto* welcome = std::get_if<Welcome>(&message)) {
        on_welcome(*welcome);
    } else if (const auto* refuse = std::get_if<Refuse>(&message)) {
        on_refuse(*refuse);
    } else if (const auto* chunk = std::get_if<Chunk>(&message)) {
        on_chunk(*chunk);
    } else if (const auto* ack = std::get_if<ChunkAck>(&message)) {
        blob_.receive(*ack);
    } else if (const auto* query = std::get_if<DesyncQuery>(&message)) {
        on_desync_query(*query);
    } else if (const auto* end = std::get_if<End>(&message)) {
        on_end(*end);
    } else {
        counters.violations.add(Violation::unexpected_message);
    }
}

void LockstepClient::Player::update(std::uint64_t now_us) {
    now_us_ = std::max(now_us_, now_us);
    if (phase == ClientPhase::greeting) {
        greet();
        return;
    }
    if (phase == ClientPhase::ready || phase == ClientPhase::playing) {
        say_ready();
    }
    if (phase == ClientPhase::playing) {
        advance();
        send_inputs();
        send_hashes();
    }
    if (phase != ClientPhase::ended) {
        check_silence();
    }
    if (phase == ClientPhase::playing) {
        std::vector<Chunk> chunks;
        blob_.poll(now_us_, chunks);
        for (Chunk& chunk : chunks) {
            send(std::move(chunk));
        }
    }
}

} // namespace lockwind
