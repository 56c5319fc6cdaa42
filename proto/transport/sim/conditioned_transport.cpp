#include "transport/sim/conditioned_transport.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lockwind {
namespace {

constexpr std::uint64_t kRetryUs = 1'000;
constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

} // namespace

// Each direction has its own draws.
ConditionedTransport::ConditionedTransport(std::unique_ptr<Transport> inner,
                                           const LinkConditions& conditions,
                                           std::uint64_t seed)
    : inner_(std::move(inner)), out_model_(conditions, seed), in_model_(conditions, ~seed) {}

ConditionedTransport::~ConditionedTransport() {
    for (const auto& [due_us, packet] : outgoing_) {
        (void)inner_->send(packet.to, packet.channel, packet.bytes);
    }
}

SendResult
ConditionedTransport::send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) {
    LOCKWIND_ASSERT(bytes.size() <= kPayloadSizeBytesMax);
    if (channel == Channel::reliable) {
        if (backlog_size_bytes_ + bytes.size() > kBacklogSizeBytesMax) {
            return SendResult::full;
        }
    }
    const std::uint64_t now_us = clock_us();
    const Arrivals arrivals = out_model_.schedule(now_us, channel, bytes.size());
    for (const std::uint64_t at_us : arrivals.times()) {
        outgoing_.emplace(at_us, Outgoing{to, channel, {bytes.begin(), bytes.end()}});
        backlog_size_bytes_ += channel == Channel::reliable ? bytes.size() : 0;
    }
    ++stats_.packets_out;
    stats_.bytes_out += bytes.size();
    send_due(now_us);
    return SendResult::sent;
}

void ConditionedTransport::receive(std::vector<Packet>& out) {
    send_due(clock_us());
    take_arrived();
    const auto end = incoming_.upper_bound(clock_us());
    for (auto it = incoming_.begin(); it != end; ++it) {
        ++stats_.packets_in;
        stats_.bytes_in += it->second.bytes.size();
        out.push_back(std::move(it->second));
    }
    incoming_.erase(incoming_.begin(), end);
}

void ConditionedTransport::wait_until(std::uint64_t deadline_us) {
    bool progress = true;
    while (progress) {
        const std::uint64_t now_us = clock_us();
        send_due(now_us);
        bool taken = take_arrived();
        const bool arrived = !incoming_.empty() && incoming_.begin()->first <= now_us;
        if (arrived || now_us >= deadline_us) {
            return;
        }
        inner_->wait_until(std::min(deadline_us, next_due_us()));
        taken = take_arrived() || taken;
        // On a virtual clock time stands still in here.
        progress = taken || clock_us() != now_us;
    }
}

std::uint64_t ConditionedTransport::next_due_us() const {
    const std::uint64_t out_us =
        outgoing_.empty() ? kNever : std::max(outgoing_.begin()->first, retry_us_);
    const std::uint64_t in_us = incoming_.empty() ? kNever : incoming_.begin()->first;
    return std::min(out_us, in_us);
}

void ConditionedTransport::send_due(std::uint64_t now_us) {
    if (now_us < retry_us_) {
        return;
    }
    bool full = false;
    for (auto it = outgoing_.begin(); it != outgoing_.end() && it->first <= now_us;) {
        const Outgoing& packet = it->second;
        const bool reliable = packet.channel == Channel::reliable;
        // A reliable packet waits for those before it, which keeps their order.
        const bool sent = !(reliable && full) &&
                          inner_->send(packet.to, packet.channel, packet.bytes) == SendResult::sent;
        if (reliable && !sent) {
            full = true;
            ++it;
            continue;
        }
        backlog_size_bytes_ -= reliable ? packet.bytes.size() : 0;
        it = outgoing_.erase(it);
    }
    retry_us_ = full ? now_us + kRetryUs : 0;
}

bool ConditionedTransport::take_arrived() {
    arrived_.clear();
    inner_->receive(arrived_);
    const std::uint64_t now_us = clock_us();
    for (const Packet& packet : arrived_) {
        const Arrivals arrivals = in_model_.schedule(now_us, packet.channel, packet.bytes.size());
        for (const std::uint64_t at_us : arrivals.times()) {
            incoming_.emplace(at_us, packet);
        }
    }
    return !arrived_.empty();
}

} // namespace lockwind
