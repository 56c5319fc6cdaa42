#pragma once

#include "transport/sim/virtual_clock.h"
#include "transport/transport.h"

#include <cstdint>
#include <map>
#include <memory>

namespace lockwind {

/// A match's peers in one process, joined by a perfect wire: what is sent has arrived, in order.
class LoopbackNetwork {
public:
    /// `clock` outlives the network, the network outlives its endpoints.
    explicit LoopbackNetwork(const VirtualClock& clock) : clock_(clock) {}
    LoopbackNetwork(const LoopbackNetwork&) = delete;
    LoopbackNetwork& operator=(const LoopbackNetwork&) = delete;

    /// A new endpoint; `address` is not in use.
    std::unique_ptr<Transport> open(std::uint32_t address);

private:
    class Endpoint;

    const VirtualClock& clock_;
    std::map<std::uint32_t, Endpoint*> endpoints_;
};

} // namespace lockwind
