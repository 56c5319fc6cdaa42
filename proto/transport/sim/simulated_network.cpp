#include "transport/sim/simulated_network.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <vector>

namespace lockwind {
namespace {

/// A seed for each link, so that links are independent of each other.
std::uint64_t link_seed(std::uint64_t seed, std::uint32_t from, std::uint32_t to) {
    const std::uint64_t key = std::uint64_t{from} << 32U | to;
    return seed ^ (key + 1) * 0x9e3779b97f4a7c15U;
}

} // namespace

struct SimulatedNetwork::Link {
    Link(const LinkConditions& conditions, std::uint64_t seed) : model(conditions, seed) {}

    LinkModel model;
    std::vector<std::vector<std::byte>> backlog; // reliable packets that wait for the link
    std::size_t backlog_size_bytes = 0;
    std::uint64_t newest_arrival_us = 0; // of all packets so far
};

class SimulatedNetwork::Endpoint final : public Transport {
public:
    Endpoint(SimulatedNetwork& network, std::uint32_t address)
        : network_(network), address_(address) {}
    Endpoint(const Endpoint&) = delete;
    Endpoint& operator=(const Endpoint&) = delete;
    ~Endpoint() override { network_.close(address_); }

    SendResult send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) override {
        LOCKWIND_ASSERT(bytes.size() <= kPayloadSizeBytesMax);
        const SendResult result = network_.send(address_, to, channel, bytes);
        if (result == SendResult::sent) {
            ++stats_.packets_out;
            stats_.bytes_out += bytes.size();
        }
        return result;
    }

    void receive(std::vector<Packet>& out) override {
        while (!inbox_.empty() && inbox_.begin()->first.first <= clock_us()) {
            Packet& packet = inbox_.begin()->second;
            ++stats_.packets_in;
            stats_.bytes_in += packet.bytes.size();
            out.push_back(std::move(packet));
            inbox_.erase(inbox_.begin());
        }
    }

    void wait_until(std::uint64_t /*deadline_us*/) override {}
    std::uint64_t clock_us() const override { return network_.clock_.now_us(); }

    std::uint32_t peer_count() const override {
        if (address_ != kServerAddress) {
            return network_.endpoints_.count(kServerAddress) > 0 && network_.matched(address_) ? 1
                                                                                               : 0;
        }
        const auto is_matched_client = [this](const auto& entry) {
            return entry.first != kServerAddress && network_.matched(entry.first);
        };
        return static_cast<std::uint32_t>(std::count_if(
            network_.endpoints_.begin(), network_.endpoints_.end(), is_matched_client));
    }

    TransportStats stats() const override { return stats_; }

    void arrive(std::uint64_t at_us, std::uint64_t sequence, Packet packet) {
        inbox_.emplace(std::pair{at_us, sequence}, std::move(packet));
    }

    std::optional<std::uint64_t> next_arrival_us() const {
        if (inbox_.empty()) {
            return std::nullopt;
        }
        return inbox_.begin()->first.first;
    }

private:
    SimulatedNetwork& network_;
    std::uint32_t address_;
    std::map<std::pair<std::uint64_t, std::uint64_t>, Packet> inbox_; // by (arrival, sequence)
    TransportStats stats_;
};

SimulatedNetwork::SimulatedNetwork(const VirtualClock& clock,
                                   std::uint64_t seed,
                                   const LinkConditions& conditions)
    : clock_(clock), seed_(seed), conditions_(conditions) {}

SimulatedNetwork::~SimulatedNetwork() = default;

std::unique_ptr<Transport> SimulatedNetwork::open(std::uint32_t address) {
    LOCKWIND_ASSERT(address != kEveryAddress && endpoints_.count(address) == 0);
    auto endpoint = std::make_unique<Endpoint>(*this, address);
    endpoints_[address] = endpoint.get();
    return endpoint;
}

void SimulatedNetwork::close(std::uint32_t address) {
    endpoints_.erase(address);
    // What waits for or from this endpoint is not for the next one at its address.
    for (auto& [key, link] : links_) {
        if (key.first == address || key.second == address) {
            link->backlog.clear();
            link->backlog_size_bytes = 0;
        }
    }
}

void SimulatedNetwork::set_conditions(std::uint32_t from,
                                      std::uint32_t to,
                                      const LinkConditions& conditions) {
    link({from, to}).model.set_conditions(conditions);
}

void SimulatedNetwork::set_link_up(std::uint32_t client, bool up) {
    const bool lost = !matched(client); // asked before the first direction changes it
    set_up({kServerAddress, client}, up, lost);
    set_up({client, kServerAddress}, up, lost);
}

void SimulatedNetwork::set_direction_up(std::uint32_t from, std::uint32_t to, bool up) {
    set_up({from, to}, up, !matched(std::max(from, to)));
}

void SimulatedNetwork::set_up(LinkKey key, bool up, bool lost) {
    if (!up) {
        cut_since_us_.emplace(key, clock_.now_us());
    } else if (cut_since_us_.erase(key) > 0) {
        heal(key, lost);
    }
}

void SimulatedNetwork::heal(LinkKey key, bool lost) {
    Link& healed = link(key);
    const std::vector<std::vector<std::byte>> backlog = std::exchange(healed.backlog, {});
    healed.backlog_size_bytes = 0;
    if (lost) {
        stats_.lost += backlog.size();
        return;
    }
    for (const std::vector<std::byte>& bytes : backlog) {
        transmit(key, Channel::reliable, bytes);
    }
}

std::optional<std::uint64_t> SimulatedNetwork::next_arrival_us() const {
    std::optional<std::uint64_t> next;
    for (const auto& [address, endpoint] : endpoints_) {
        const std::optional<std::uint64_t> arrival = endpoint->next_arrival_us();
        if (arrival && (!next || *arrival < *next)) {
            next = arrival;
        }
    }
    return next;
}

SimulatedNetwork::Link& SimulatedNetwork::link(LinkKey key) {
    std::unique_ptr<Link>& found = links_[key];
    if (!found) {
        found = std::make_unique<Link>(conditions_, link_seed(seed_, key.first, key.second));
    }
    return *found;
}

bool SimulatedNetwork::cut(LinkKey key) const {
    return cut_since_us_.count(key) > 0;
}

bool SimulatedNetwork::matched(std::uint32_t client) const {
    const auto lost = [this](LinkKey key) {
        const auto since = cut_since_us_.find(key);
        return since != cut_since_us_.end() && clock_.now_us() - since->second >= kLeaseUs;
    };
    return !lost({kServerAddress, client}) && !lost({client, kServerAddress});
}

SendResult SimulatedNetwork::send(std::uint32_t from,
                                  std::uint32_t to,
                                  Channel channel,
                                  std::span<const std::byte> bytes) {
    std::vector<LinkKey> keys;
    for (const auto& [address, endpoint] : endpoints_) {
        const bool across = (from == kServerAddress) != (address == kServerAddress);
        const bool all = to == kEveryAddress && from == kServerAddress;
        if (across && (address == to || all)) {
            keys.emplace_back(from, address);
        }
    }
    // One writer serves all receivers: where it is full for one, nothing is written.
    const bool full = channel == Channel::reliable &&
                      std::any_of(keys.begin(), keys.end(), [&](const LinkKey& key) {
                          return link(key).backlog_size_bytes + bytes.size() > kBacklogSizeBytesMax;
                      });
    if (full) {
        return SendResult::full;
    }
    for (const LinkKey& key : keys) {
        if (!cut(key)) {
            transmit(key, channel, bytes);
        } else if (channel == Channel::reliable && matched(std::max(key.first, key.second))) {
            Link& waiting = link(key);
            waiting.backlog.emplace_back(bytes.begin(), bytes.end());
            waiting.backlog_size_bytes += bytes.size();
        } else {
            ++stats_.lost;
        }
    }
    return SendResult::sent;
}

void SimulatedNetwork::transmit(LinkKey key, Channel channel, std::span<const std::byte> bytes) {
    Link& used = link(key);
    const Arrivals arrivals = used.model.schedule(clock_.now_us(), channel, bytes.size());
    const auto receiver = endpoints_.find(key.second);
    if (receiver == endpoints_.end()) {
        return;
    }
    stats_.lost += arrivals.count == 0 ? 1 : 0;
    stats_.duplicated += arrivals.count > 1 ? 1 : 0;
    for (const std::uint64_t at_us : arrivals.times()) {
        stats_.reordered += at_us < used.newest_arrival_us ? 1 : 0;
        used.newest_arrival_us = std::max(used.newest_arrival_us, at_us);
        Packet packet{key.first, channel, {bytes.begin(), bytes.end()}};
        receiver->second->arrive(at_us, ++sequence_, std::move(packet));
    }
}

} // namespace lockwind
