#include "tests/swarm/watched_transport.h"

#include "codec/codec.h"

#include <limits>
#include <utility>

namespace lockwind::swarm {

namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
constexpr std::int64_t kMillion = 1'000'000;

} // namespace

WatchedTransport::WatchedTransport(std::unique_ptr<Transport> inner, ClockSkew skew)
    : inner_(std::move(inner)), skew_(skew) {}

std::uint64_t WatchedTransport::clock_us() const {
    const auto network = static_cast<std::int64_t>(inner_->clock_us());
    const std::int64_t drift = network * skew_.drift_ppm / kMillion;
    return skew_.offset_us + static_cast<std::uint64_t>(network + drift);
}

std::uint64_t WatchedTransport::network_us(std::uint64_t local_us) const {
    if (local_us == kNever) {
        return kNever;
    }
    if (local_us <= skew_.offset_us) {
        return 0;
    }
    const auto elapsed = static_cast<std::int64_t>(local_us - skew_.offset_us);
    if (skew_.drift_ppm == 0) {
        return static_cast<std::uint64_t>(elapsed);
    }
    // A step beyond what rounding takes off.
    return static_cast<std::uint64_t>(elapsed * kMillion / (kMillion + skew_.drift_ppm)) + 1;
}

bool WatchedTransport::fetch() {
    inner_->receive(waiting_);
    return !waiting_.empty();
}

SendResult
WatchedTransport::send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) {
    if (outgoing_.empty()) {
        return inner_->send(to, channel, bytes);
    }
    Result<Message> message = decode(bytes);
    LOCKWIND_ASSERT(message.ok());
    bool changed = false;
    for (WireTap* tap : outgoing_) {
        changed = tap->on_send(message.value()) || changed;
    }
    if (!changed) {
        return inner_->send(to, channel, bytes);
    }
    encode(message.value(), changed_);
    return inner_->send(to, channel, changed_);
}

void WatchedTransport::change(Packet& packet) const {
    Result<Message> message = decode(packet.bytes);
    LOCKWIND_ASSERT(message.ok());
    bool changed = false;
    for (WireTap* tap : incoming_) {
        changed = tap->on_receive(message.value()) || changed;
    }
    if (changed) {
        encode(message.value(), packet.bytes);
    }
}

void WatchedTransport::receive(std::vector<Packet>& out) {
    fetch();
    for (Packet& packet : waiting_) {
        if (!incoming_.empty()) {
            change(packet);
        }
        out.push_back(std::move(packet));
    }
    waiting_.clear();
}

} // namespace lockwind::swarm
