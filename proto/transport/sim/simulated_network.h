#pragma once

#include "transport/sim/link_model.h"
#include "transport/sim/virtual_clock.h"
#include "transport/transport.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace lockwind {

/// A match's peers in one process, joined by imperfect links in virtual time. The same seed and the
/// same calls give the same arrivals; what happens on one link does not depend on the traffic of
/// another.
class SimulatedNetwork {
public:
    /// A peer out of reach for longer is lost: it is no longer counted, and reliable packets that
    /// waited for it are gone.
    static constexpr std::uint64_t kLeaseUs = 2'000'000;

    /// `clock` outlives the network, the network outlives its endpoints. `conditions`: of every
    /// link, each direction.
    SimulatedNetwork(const VirtualClock& clock,
                     std::uint64_t seed,
                     const LinkConditions& conditions = {});
    SimulatedNetwork(const SimulatedNetwork&) = delete;
    SimulatedNetwork& operator=(const SimulatedNetwork&) = delete;
    ~SimulatedNetwork();

    /// A new endpoint; `address` is not in use. Gets nothing that was sent before.
    std::unique_ptr<Transport> open(std::uint32_t address);

    /// Conditions of one direction from now on; what is under way is not touched.
    void set_conditions(std::uint32_t from, std::uint32_t to, const LinkConditions& conditions);
    /// Cuts or heals the link between the server and a client, both directions. While it is cut
    /// best-effort packets are lost and reliable ones wait; what is under way still arrives.
    void set_link_up(std::uint32_t client, bool up);

    /// When the next packet arrives anywhere: where to advance the clock to. None: nothing is under
    /// way.
    std::optional<std::uint64_t> next_arrival_us() const;

private:
    class Endpoint;
    struct Link;

    Link& link(std::uint32_t from, std::uint32_t to);
    void deliver(Link& link,
                 std::uint32_t from,
                 std::uint32_t to,
                 Channel channel,
                 std::span<const std::byte> bytes);
    void release_backlog(Link& link, std::uint32_t from, std::uint32_t to, bool keep);
    bool reachable(std::uint32_t client) const;

    const VirtualClock& clock_;
    std::uint64_t seed_ = 0;
    LinkConditions conditions_;
    std::uint64_t sequence_ = 0; // of arrivals, to order equal times
    std::map<std::uint32_t, Endpoint*> endpoints_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::unique_ptr<Link>> links_;
    std::map<std::uint32_t, std::uint64_t> cut_since_us_; // by client
};

} // namespace lockwind
