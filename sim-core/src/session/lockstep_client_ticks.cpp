#include "session/input_buffer.h"
#include "session/lockstep_client_player.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lockwind {
namespace {

constexpr std::uint64_t kUsPerMs = 1000;
/// The server hears from a client at least this often.
constexpr std::uint64_t kKeepAliveUs = 100'000;
constexpr std::uint64_t kHashResendUs = 250'000;
/// Confirmed ticks this far behind a gap are not kept.
constexpr Tick kAheadTicksMax = 2 * kConfirmationTicksMax;
/// Room in the server's window of inputs behind the one that is furthest ahead.
constexpr Tick kWindowRoomTicks = 8;
/// Received ticks that are kept to notice that one is told differently later.
constexpr Tick kKeptTicks = 128;

} // namespace

bool LockstepClient::Player::well_formed(const Confirmation& confirmation) const {
    const std::size_t count = confirmation.ticks.size();
    if (confirmation.acks.size() != config.players || count > kConfirmationTicksMax ||
        confirmation.confirmed_tick > kMatchTicksMax) {
        return false;
    }
    if (count > 0 &&
        (confirmation.first_tick == 0 || confirmation.first_tick > confirmation.confirmed_tick ||
         count > confirmation.confirmed_tick - confirmation.first_tick + 1)) {
        return false;
    }
    return std::all_of(
        confirmation.ticks.begin(), confirmation.ticks.end(), [this](const ConfirmedTick& tick) {
            return tick.inputs.size() == config.players;
        });
}

void LockstepClient::Player::on_confirmation(const Confirmation& confirmation) {
    if (phase != ClientPhase::ready && phase != ClientPhase::playing) {
        return;
    }
    if (!well_formed(confirmation)) {
        counters.violations.add(Violation::confirmation_malformed);
        return;
    }
    server_tick_ = std::max(server_tick_, confirmation.confirmed_tick);
    for (std::size_t i = 0; i < confirmation.ticks.size(); ++i) {
        take_tick(confirmation.first_tick + i, confirmation.ticks[i].inputs);
    }
    append_received();
    take_ack(confirmation.acks[slot]);
}

void LockstepClient::Player::take_tick(Tick tick, const std::vector<SlotInput>& inputs) {
    if (tick > received.newest_tick() + kAheadTicksMax) {
        return;
    }
    std::span<const SlotInput> known = received.find(tick);
    if (const auto entry = ahead_.find(tick); entry != ahead_.end()) {
        known = entry->second;
    }
    if (tick > received.newest_tick() && known.empty()) {
        ahead_.emplace(tick, inputs);
        return;
    }
    ++counters.confirmations_doubled;
    if (!known.empty() && !std::equal(known.begin(), known.end(), inputs.begin(), inputs.end())) {
        counters.violations.add(Violation::confirmation_changed);
    }
}

void LockstepClient::Player::append_received() {
    const Tick before = received.newest_tick();
    while (!ahead_.empty() && ahead_.begin()->first == received.newest_tick() + 1) {
        received.push(std::move(ahead_.begin()->second));
        ahead_.erase(ahead_.begin());
    }
    if (received.newest_tick() == before) {
        return;
    }
    ticks_received_ = true;
    const std::uint64_t gap_us = now_us_ - confirmed_us_;
    if (confirmed_us_ != 0 && gap_us > settings.stall_after_ticks * tick_period_us(config)) {
        ++counters.stalls;
        counters.stall_ms_max = std::max(counters.stall_ms_max, gap_us / kUsPerMs);
    }
    confirmed_us_ = now_us_;
}

void LockstepClient::Player::take_ack(const SlotAck& ack) {
    if (ack.attached != attached_) {
        attached_ = ack.attached;
        if (attached_ && phase == ClientPhase::ready) {
            phase = ClientPhase::playing;
            notify(attempt_ > 1 ? SessionEventKind::reconnected : SessionEventKind::synchronized,
                   resume_tick_,
                   "");
        }
    }
    while (!inputs_.empty() && inputs_tick_ <= ack.input_tick) {
        inputs_.pop_front();
        ++inputs_tick_;
    }
    if (ack.hash_tick > agreed_tick && ack.hash_tick <= advanced_tick) {
        agreed_tick = ack.hash_tick;
        hashes_resend_us_ = now_us_ + kHashResendUs;
        while (!hashes_.empty() && hashes_.front().tick <= agreed_tick) {
            hashes_.pop_front();
        }
        received.discard_before(std::min(
            agreed_tick, received.newest_tick() - std::min(received.newest_tick(), kKeptTicks)));
    }
    if (ack.echo_us > echo_us_ && ack.echo_us + ack.echo_hold_us <= now_us_) {
        echo_us_ = ack.echo_us;
        const std::uint64_t rtt_us = now_us_ - ack.echo_us - ack.echo_hold_us;
        counters.rtt_us.add(rtt_us);
        round_trip_.add(rtt_us);
    }
}

/// Ticks that pass while a confirmation and the input it leads to are under way.
Tick LockstepClient::Player::lead_ticks() const {
    const Tick taken = config.input_delay_ticks + kWindowRoomTicks;
    const Tick longest = kInputWindowTicks - std::min(kInputWindowTicks, taken);
    return std::min(round_trip_.bound_us() / tick_period_us(config), longest);
}

/// Newest tick whose input may be given now. It follows the client's own steps, not a clock: a
/// client that cannot keep up slows the match instead of falling behind it.
Tick LockstepClient::Player::input_horizon() const {
    const Tick horizon = advanced_tick + 1 + config.input_delay_ticks + lead_ticks();
    return config.ticks == 0 ? horizon : std::min(horizon, config.ticks);
}

/// Inputs of ticks that are confirmed already come too late.
Tick LockstepClient::Player::next_input_tick() const {
    return std::max(inputs_tick_ + inputs_.size(), server_tick_ + 1);
}

bool LockstepClient::Player::wants_input() const {
    return phase == ClientPhase::playing && next_input_tick() <= input_horizon();
}

void LockstepClient::Player::add_local_input(Tick tick, const SlotInput& input) {
    LOCKWIND_ASSERT(wants_input() && tick == next_input_tick());
    LOCKWIND_ASSERT(std::all_of(input.bytes.begin() + input_size_bytes_,
                                input.bytes.end(),
                                [](std::uint8_t byte) { return byte == 0; }));
    if (tick != inputs_tick_ + inputs_.size()) {
        inputs_.clear();
        inputs_tick_ = tick;
    }
    inputs_.push_back(input);
    inputs_.back().status = InputStatus::confirmed;
    inputs_added_ = true;
}

void LockstepClient::Player::send_inputs() {
    const std::uint64_t period_us = tick_period_us(config);
    const std::uint64_t repeat_us = std::min(2 * period_us, kKeepAliveUs);
    const bool due = inputs_added_ || (ticks_received_ && now_us_ >= inputs_sent_us_ + period_us) ||
                     (!inputs_.empty() && now_us_ >= inputs_sent_us_ + repeat_us) ||
                     now_us_ >= inputs_sent_us_ + kKeepAliveUs;
    if (!due) {
        return;
    }
    InputBatch batch;
    batch.slot = slot;
    batch.first_tick = inputs_tick_;
    const auto count = static_cast<std::ptrdiff_t>(std::min(inputs_.size(), kInputBatchTicksMax));
    batch.inputs.assign(inputs_.begin(), inputs_.begin() + count);
    batch.confirmed_tick = received.newest_tick();
    batch.sent_us = now_us_;
    inputs_added_ = false;
    ticks_received_ = false;
    inputs_sent_us_ = now_us_;
    send(std::move(batch));
}

void LockstepClient::Player::advance() {
    if (handed_tick_ != advanced_tick) {
        return;
    }
    const Tick last = std::min(received.newest_tick(), handed_tick_ + settings.advance_ticks_max);
    while (handed_tick_ < last) {
        ++handed_tick_;
        const std::span<const SlotInput> inputs = received.find(handed_tick_);
        requests.push_back(AdvanceRequest{
            handed_tick_, {inputs.begin(), inputs.end()}, hash_due(config, handed_tick_)});
    }
}

void LockstepClient::Player::advanced(Tick tick, std::uint64_t hash) {
    if (phase != ClientPhase::playing) {
        return; // ended, or connecting anew, meanwhile
    }
    LOCKWIND_ASSERT(tick == advanced_tick + 1 && tick <= handed_tick_);
    advanced_tick = tick;
    ++counters.ticks_confirmed;
    if (hash_due(config, tick)) {
        state_hash = hash;
        state_hash_tick = tick;
        hashes_.push_back(HashReport::Entry{tick, hash});
    }
}

/// New hashes at once; all of them again where nothing was agreed on for a while.
void LockstepClient::Player::send_hashes() {
    const bool repeat = now_us_ >= hashes_resend_us_;
    const Tick sent_tick = repeat ? agreed_tick : hashes_sent_tick_;
    HashReport report;
    report.slot = slot;
    for (const HashReport::Entry& entry : hashes_) {
        if (entry.tick > sent_tick && report.entries.size() < kHashReportEntriesMax) {
            report.entries.push_back(entry);
        }
    }
    if (repeat) {
        hashes_resend_us_ = now_us_ + kHashResendUs;
    }
    if (!report.entries.empty()) {
        hashes_sent_tick_ = std::max(hashes_sent_tick_, report.entries.back().tick);
        send(std::move(report));
    }
}

void LockstepClient::Player::on_desync_query(const DesyncQuery& query) {
    if (phase != ClientPhase::playing || query.bad_tick > advanced_tick ||
        query.agreed_tick >= query.bad_tick) {
        counters.violations.add(Violation::unexpected_message);
        return;
    }
    if (query.bad_tick == queried_tick_) {
        return; // doubled: the report is under way
    }
    queried_tick_ = query.bad_tick;
    ++counters.desyncs;
    notify(SessionEventKind::desync_detected,
           query.bad_tick,
           "agreed up to tick " + std::to_string(query.agreed_tick));
    requests.push_back(DesyncReportRequest{HashMismatch{
        slot, query.agreed_tick, query.bad_tick, query.server_hash, query.client_hash}});
}

void LockstepClient::Player::send_blob(BlobKind kind, std::vector<std::byte> bytes) {
    if (phase == ClientPhase::playing) {
        blob_.start(kind, blob_.transfer() + 1, std::move(bytes));
    }
}

std::uint64_t LockstepClient::Player::next_deadline_us() const {
    switch (phase) {
    case ClientPhase::ended:
        return std::numeric_limits<std::uint64_t>::max();
    case ClientPhase::greeting:
        return connect_deadline_us_ == 0 ? now_us_ : std::min(greeting_us_, connect_deadline_us_);
    case ClientPhase::creating:
    case ClientPhase::receiving:
    case ClientPhase::restoring:
        return connect_deadline_us_;
    case ClientPhase::ready:
        return std::min(greeting_us_, connect_deadline_us_);
    case ClientPhase::playing:
        break;
    }
    if (inputs_added_ || (handed_tick_ == advanced_tick && handed_tick_ < received.newest_tick())) {
        return now_us_;
    }
    const std::uint64_t period_us = tick_period_us(config);
    const std::uint64_t repeat_us = std::min(2 * period_us, kKeepAliveUs);
    std::uint64_t deadline = inputs_sent_us_ + (inputs_.empty() ? kKeepAliveUs : repeat_us);
    if (ticks_received_) {
        deadline = std::min(deadline, inputs_sent_us_ + period_us);
    }
    if (!hashes_.empty()) {
        const bool unsent = hashes_.back().tick > hashes_sent_tick_;
        deadline = std::min(deadline, unsent ? now_us_ : hashes_resend_us_);
    }
    if (!attached_) {
        deadline = std::min(deadline, greeting_us_);
    }
    deadline = std::min(deadline, blob_.next_deadline_us());
    const std::uint64_t timeout_ms =
        interrupted_ ? settings.drop_timeout_ms : settings.interrupted_timeout_ms;
    return std::min(deadline, heard_us_ + timeout_ms * kUsPerMs);
}

} // namespace lockwind
