#pragma once

#include "transport/sim/link_conditions.h"
#include "transport/transport.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace lockwind {

/// When a packet arrives: never (count 0), once, or twice.
struct Arrivals {
    std::uint32_t count = 0;
    std::array<std::uint64_t, 2> at_us{};
};

/// One direction of a link: turns the sending of packets into arrivals. Deterministic: the n-th
/// packet's fate depends on the seed, n, the conditions and the times of sending.
class LinkModel {
public:
    LinkModel(const LinkConditions& conditions, std::uint64_t seed);

    void set_conditions(const LinkConditions& conditions);
    const LinkConditions& conditions() const { return conditions_; }

    /// A packet of `size_bytes` sent at `now_us`. Reliable: each lost try costs a retransmission
    /// delay and arrivals keep the order of sending; given up after kReliableTriesMax tries.
    Arrivals schedule(std::uint64_t now_us, Channel channel, std::size_t size_bytes);

    static constexpr std::uint32_t kReliableTriesMax = 32;
    /// A lost reliable packet is noticed by the next heartbeat: a round trip and this.
    static constexpr std::uint64_t kRetransmissionDelayUs = 10'000;

private:
    enum class Draw : std::uint64_t;
    std::uint64_t draw(Draw purpose, std::uint64_t try_index = 0) const;
    bool chance(Draw purpose, std::uint32_t ppm, std::uint64_t try_index = 0) const;
    std::uint64_t delay_us(Draw purpose) const;
    std::uint64_t departure_us(std::uint64_t now_us, std::size_t size_bytes);

    LinkConditions conditions_;
    std::uint64_t seed_ = 0;
    std::uint64_t packet_ = 0;              // number of the packet being scheduled, from 1
    std::uint64_t wire_free_us_ = 0;        // when the last bit of the packets before has left
    std::uint64_t reliable_arrival_us_ = 0; // of the last reliable packet
};

} // namespace lockwind
