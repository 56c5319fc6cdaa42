#include "transport/sim/loopback_network.h"

#include "lockwind/assert.h"

#include <utility>
#include <vector>

namespace lockwind {

class LoopbackNetwork::Endpoint final : public Transport {
public:
    Endpoint(LoopbackNetwork& network, std::uint32_t address)
        : network_(network), address_(address) {}
    Endpoint(const Endpoint&) = delete;
    Endpoint& operator=(const Endpoint&) = delete;
    ~Endpoint() override { network_.endpoints_.erase(address_); }

    SendResult send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) override {
        LOCKWIND_ASSERT(bytes.size() <= kPayloadSizeBytesMax);
        for (const auto& [address, endpoint] : network_.endpoints_) {
            if (hears(address, to)) {
                endpoint->inbox_.push_back({address_, channel, {bytes.begin(), bytes.end()}});
            }
        }
        ++stats_.packets_out;
        stats_.bytes_out += bytes.size();
        return SendResult::sent;
    }

    void receive(std::vector<Packet>& out) override {
        for (Packet& packet : inbox_) {
            ++stats_.packets_in;
            stats_.bytes_in += packet.bytes.size();
            out.push_back(std::move(packet));
        }
        inbox_.clear();
    }

    void wait_until(std::uint64_t /*deadline_us*/) override {}
    std::uint64_t clock_us() const override { return network_.clock_.now_us(); }

    std::uint32_t peer_count() const override {
        if (address_ == kServerAddress) {
            return static_cast<std::uint32_t>(network_.endpoints_.size()) - 1;
        }
        return static_cast<std::uint32_t>(network_.endpoints_.count(kServerAddress));
    }

    TransportStats stats() const override { return stats_; }

private:
    /// Whether `address` gets what this endpoint sends to `to`: a client speaks to the server
    /// alone.
    bool hears(std::uint32_t address, std::uint32_t to) const {
        const bool across = (address_ == kServerAddress) != (address == kServerAddress);
        const bool all = to == kEveryAddress && address_ == kServerAddress;
        return across && (address == to || all);
    }

    LoopbackNetwork& network_;
    std::uint32_t address_;
    std::vector<Packet> inbox_;
    TransportStats stats_;
};

std::unique_ptr<Transport> LoopbackNetwork::open(std::uint32_t address) {
    LOCKWIND_ASSERT(address != kEveryAddress && endpoints_.count(address) == 0);
    auto endpoint = std::make_unique<Endpoint>(*this, address);
    endpoints_[address] = endpoint.get();
    return endpoint;
}

} // namespace lockwind
