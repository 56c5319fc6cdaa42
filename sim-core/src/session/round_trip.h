#pragma once

#include <cstdint>

namespace lockwind {

/// Smoothed round trip and its spread, as TCP keeps them (RFC 6298).
class RoundTrip {
public:
    void add(std::uint64_t sample_us) {
        if (smoothed_us_ == 0) {
            smoothed_us_ = sample_us;
            spread_us_ = sample_us / 2;
            return;
        }
        const std::uint64_t deviation_us =
            sample_us > smoothed_us_ ? sample_us - smoothed_us_ : smoothed_us_ - sample_us;
        spread_us_ = (3 * spread_us_ + deviation_us) / 4;
        smoothed_us_ = (7 * smoothed_us_ + sample_us) / 8;
    }

    /// What nearly all messages and their answers need; 0 before the first sample.
    std::uint64_t bound_us() const { return smoothed_us_ + 4 * spread_us_; }

private:
    std::uint64_t smoothed_us_ = 0;
    std::uint64_t spread_us_ = 0;
};

} // namespace lockwind
