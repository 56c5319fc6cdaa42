#pragma once

#include "lockwind/result.h"

#include <cstdint>
#include <string_view>

namespace lockwind {

inline constexpr std::uint32_t kPartsPerMillion = 1'000'000;
inline constexpr std::uint32_t kLinkDelayUsMax = 60'000'000; // of latency and jitter

/// One direction of a link. A packet takes latency_us +- jitter_us (uniform), so that jitter alone
/// may reorder what is not reliable. Chances are per packet, in parts per million.
struct LinkConditions {
    std::uint32_t latency_us = 0;
    std::uint32_t jitter_us = 0; // at most latency_us
    std::uint32_t loss_ppm = 0;
    std::uint32_t duplicate_ppm = 0;
    std::uint32_t reorder_ppm = 0; // held back by reorder_delay_us more
    std::uint32_t reorder_delay_us = 20'000;
    std::uint64_t bandwidth_bytes_per_s = 0; // 0: no limit

    bool operator==(const LinkConditions&) const = default;
};

/// Reads "latency=40ms,jitter=10ms,loss=2%,duplicate=1%,reorder=1%,bandwidth=500kB/s": any of the
/// keys, each at most once, in any order. Times in us, ms or s, chances in %, bandwidth in kB/s or
/// MB/s (powers of ten), whole or with a decimal point.
Result<LinkConditions> parse_link_conditions(std::string_view text);

} // namespace lockwind
