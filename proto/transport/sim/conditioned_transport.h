#pragma once

#include "transport/sim/link_model.h"
#include "transport/transport.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace lockwind {

/// Makes a real transport behave like a worse link: every packet, outgoing and incoming, is
/// delayed, lost, doubled or reordered by the same conditions, seeded. What is on the way when it
/// is destroyed is sent at once, so that a farewell still leaves.
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

    /// Reliable bytes that may be on the way before send() returns full.
    static constexpr std::size_t kBacklogSizeBytesMax = std::size_t{16} << 20U;

private:
    struct Outgoing {
        std::uint32_t to = 0;
        Channel channel = Channel::best_effort;
        std::vector<std::byte> bytes;
    };

    void pump();
    void send_due(std::uint64_t now_us);
    void take_arrived(std::uint64_t now_us);

    std::unique_ptr<Transport> inner_;
    LinkModel out_model_;
    LinkModel in_model_;
    std::multimap<std::uint64_t, Outgoing> outgoing_; // by time of sending; equal times keep order
    std::multimap<std::uint64_t, Packet> incoming_;   // by time of arrival; likewise
    std::vector<Packet> arrived_;                     // scratch
    std::size_t backlog_size_bytes_ = 0;
    bool inner_full_ = false;
    TransportStats stats_;
};

} // namespace lockwind
