#pragma once

#include "session/messages.h"
#include "transport/transport.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace lockwind::swarm {

/// Sees, and may change, the messages of one endpoint.
class WireTap {
public:
    virtual ~WireTap() = default;
    /// True where the message was changed.
    virtual bool on_send(Message& /*message*/) { return false; }
    virtual bool on_receive(Message& /*message*/) { return false; }
};

/// A process's clock against the network's.
struct ClockSkew {
    std::uint64_t offset_us = 0;
    std::int32_t drift_ppm = 0;
};

/// An endpoint whose process has a clock of its own and taps on its wire. Packets wait in it until
/// the process looks.
class WatchedTransport final : public Transport {
public:
    WatchedTransport(std::unique_ptr<Transport> inner, ClockSkew skew);

    /// Not owned. Each sees what those added before it have left.
    void add_outgoing(WireTap* tap) { outgoing_.push_back(tap); }
    void add_incoming(WireTap* tap) { incoming_.push_back(tap); }

    /// Takes what has arrived; true where packets wait for the process.
    bool fetch();
    /// The network's time at which this process's clock has reached `local_us`.
    std::uint64_t network_us(std::uint64_t local_us) const;

    SendResult send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) override;
    void receive(std::vector<Packet>& out) override;
    void wait_until(std::uint64_t /*deadline_us*/) override {}
    std::uint64_t clock_us() const override;
    std::uint32_t peer_count() const override { return inner_->peer_count(); }
    TransportStats stats() const override { return inner_->stats(); }

private:
    void change(Packet& packet) const;

    std::unique_ptr<Transport> inner_;
    ClockSkew skew_;
    std::vector<WireTap*> outgoing_;
    std::vector<WireTap*> incoming_;
    std::vector<Packet> waiting_;
    std::vector<std::byte> changed_; // scratch
};

} // namespace lockwind::swarm
