#pragma once

#include "transport/sim/link_conditions.h"
#include "transport/transport.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lockwind {

/// When a packet arrives: never (count 0), once, or twice.
struct Arrivals {
    std::uint32_t count = 0;
    std::array<std::uint64_t, 2> at_us{};

    std::span<const std::uint64_t> times() const { return {at_us.data(), count}; }
};

/// One direction of a link: turns the sending of packets into arrivals. Deterministic: what happens
/// to the n-th packet depends on the seed, n, the conditions, and when the packets so far were
/// sent.
class LinkModel {
public:
    LinkModel(const LinkConditions& conditions, std::uint64_t seed);

    /// From the next packet on. jitter_us is at most latency_us.
    void set_conditions(const LinkConditions& conditions);
    const LinkConditions& conditions() const { return conditions_; }

    /// A packet of `size_bytes` sent at `now_us`, which never goes back. Reliable: each lost try
    /// costs a retransmission delay, arrivals keep the order of sending, none is doubled; given up
    /// after kReliableTriesMax lost tries.
    Arrivals schedule(std::uint64_t now_us, Channel channel, std::size_t size_bytes);

    static constexpr std::uint32_t kReliableTriesMax = 32;
    /// A lost reliable packet is asked for again after a round trip and this.
    static constexpr std::uint64_t kRetransmissionDelayUs = 10'000;
    /// Where bandwidth is limited, best-effort packets that would wait longer are lost.
    static constexpr std::uint64_t kQueueUsMax = 500'000;

private:
    /// Draws are a hash of (seed, packet, purpose, try), so that changing one chance changes no
    /// other draw.
    enum class Draw : std::uint64_t { loss, delay, reorder, duplicate, duplicate_delay };

    std::uint64_t draw(Draw purpose, std::uint64_t try_index = 0) const;
    bool chance(Draw purpose, std::uint32_t ppm, std::uint64_t try_index = 0) const;
    std::uint64_t delay_us(Draw purpose) const;
    std::uint64_t departure_us(std::uint64_t now_us, std::size_t size_bytes);
    Arrivals schedule_reliable(std::uint64_t sent_us);

    LinkConditions conditions_;
    std::uint64_t seed_ = 0;
    std::uint64_t packet_ = 0;              // number of the one being scheduled, from 1
    std::uint64_t wire_free_us_ = 0;        // when the packets so far have left
    std::uint64_t reliable_arrival_us_ = 0; // of the last reliable packet
};

} // namespace lockwind
