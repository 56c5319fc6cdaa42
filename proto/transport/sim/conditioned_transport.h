#pragma once

#include "transport/sim/link_model.h"
#include "transport/transport.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace lockwind {

/// Makes a client's transport behave like a worse link: every packet, outgoing and incoming, is
/// delayed, lost, doubled or reordered under the same conditions, seeded. Packets move inside the
/// calls of this object only. What is on its way out when it is destroyed leaves at once, so that a
/// farewell is heard.
class ConditionedTransport final : public Transport {
public:
    ConditionedTransport(std::unique_ptr<Transport> inner,
                         const LinkConditions& conditions,
                         std::uint64_t seed);
    ConditionedTransport(const ConditionedTransport&) = delete;
    ConditionedTransport& operator=(const ConditionedTransport&) = delete;
    ~ConditionedTransport() override;

    SendResult send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) override;
    void receive(std::vector<Packet>& out) override;
    void wait_until(std::uint64_t deadline_us) override;
    std::uint64_t clock_us() const override { return inner_->clock_us(); }
    std::uint32_t peer_count() const override { return inner_->peer_count(); }
    /// Of what was given to send() and what receive() gave, not of what the inner transport
    /// carried.
    TransportStats stats() const override { return stats_; }

    /// When the next packet is due, outgoing or incoming; UINT64_MAX for none. Whoever waits for
    /// several transports at once (DdsParticipant::wait_until) wakes up then and calls receive().
    std::uint64_t next_due_us() const;

    /// Reliable bytes that may be on their way out before send() returns full.
    static constexpr std::size_t kBacklogSizeBytesMax = std::size_t{16} << 20U;

private:
    struct Outgoing {
        std::uint32_t to = 0;
        Channel channel = Channel::best_effort;
        std::vector<std::byte> bytes;
    };

    void send_due(std::uint64_t now_us);
    bool take_arrived();

    std::unique_ptr<Transport> inner_;
    LinkModel out_model_;
    LinkModel in_model_;
    // By the time they are due; equal times keep the order of insertion.
    std::multimap<std::uint64_t, Outgoing> outgoing_;
    std::multimap<std::uint64_t, Packet> incoming_;
    std::uint64_t retry_us_ = 0; // no sooner is the inner transport, which was full, tried again
    std::size_t backlog_size_bytes_ = 0;
    std::vector<Packet> arrived_; // kept for its capacity
    TransportStats stats_;
};

} // namespace lockwind
