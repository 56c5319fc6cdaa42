#pragma once

#include "transport/sim/link_model.h"
#include "transport/sim/virtual_clock.h"
#include "transport/transport.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace lockwind {

/// Packets of all links since the network began. A broadcast is one packet a receiver.
struct NetworkStats {
    std::uint64_t lost = 0; // a reliable one only where it was given up
    std::uint64_t duplicated = 0;
    std::uint64_t reordered = 0; // arrives before one that was sent earlier on its link

    bool operator==(const NetworkStats&) const = default;
};

/// A match's peers in one process, joined by imperfect links in virtual time. The same seed and the
/// same calls give the same arrivals; what happens on one link does not depend on the traffic of
/// another. Like DDS it tells a lost peer by a lease, and bounds what waits for one.
class SimulatedNetwork {
public:
    /// A client out of reach for this long is lost: it is no longer counted, and the reliable
    /// packets that waited are gone.
    static constexpr std::uint64_t kLeaseUs = 2'000'000;
    /// Reliable bytes that may wait for a client out of reach before send() returns full.
    static constexpr std::size_t kBacklogSizeBytesMax = std::size_t{16} << 20U;

    /// `clock` outlives the network, the network outlives its endpoints. `conditions`: of every
    /// link, each direction.
    SimulatedNetwork(const VirtualClock& clock,
                     std::uint64_t seed,
                     const LinkConditions& conditions = {});
    SimulatedNetwork(const SimulatedNetwork&) = delete;
    SimulatedNetwork& operator=(const SimulatedNetwork&) = delete;
    ~SimulatedNetwork();

    /// A new endpoint; `address` is not in use. Gets nothing that was sent before. Destroying it
    /// tells the peers at once; what it has sent still arrives.
    std::unique_ptr<Transport> open(std::uint32_t address);

    /// Conditions of one direction from now on; what is under way is not touched.
    void set_conditions(std::uint32_t from, std::uint32_t to, const LinkConditions& conditions);
    /// Cuts or heals the link between the server and `client`, both directions. While it is cut
    /// best-effort packets are lost and reliable ones wait; what is under way still arrives.
    void set_link_up(std::uint32_t client, bool up);
    /// The same for one direction: `to` no longer hears `from`. The lease counts whichever
    /// direction was cut first.
    void set_direction_up(std::uint32_t from, std::uint32_t to, bool up);

    /// When the next packet arrives anywhere: where to advance the clock to. None: nothing is under
    /// way.
    std::optional<std::uint64_t> next_arrival_us() const;
    const NetworkStats& stats() const { return stats_; }

private:
    class Endpoint;
    struct Link;
    using LinkKey = std::pair<std::uint32_t, std::uint32_t>; // from, to

    Link& link(LinkKey key);
    void close(std::uint32_t address);
    SendResult
    send(std::uint32_t from, std::uint32_t to, Channel channel, std::span<const std::byte> bytes);
    void transmit(LinkKey key, Channel channel, std::span<const std::byte> bytes);
    void set_up(LinkKey key, bool up, bool lost);
    void heal(LinkKey key, bool lost);
    bool cut(LinkKey key) const;
    bool matched(std::uint32_t client) const;

    const VirtualClock& clock_;
    std::uint64_t seed_ = 0;
    LinkConditions conditions_;
    std::uint64_t sequence_ = 0; // of arrivals, to order equal times
    std::map<std::uint32_t, Endpoint*> endpoints_;
    std::map<LinkKey, std::unique_ptr<Link>> links_;
    std::map<LinkKey, std::uint64_t> cut_since_us_;
    NetworkStats stats_;
};

} // namespace lockwind
