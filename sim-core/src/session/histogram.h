#pragma once

#include <array>
#include <cstdint>

namespace lockwind {

/// Quantiles of any number of values in fixed memory: 32 buckets an octave, so a quantile is at
/// most 3.2 % above the true value (HdrHistogram's scheme). Values of any unit.
class Histogram {
public:
    void add(std::uint64_t value);
    std::uint64_t count() const { return count_; }
    std::uint64_t max() const { return max_; } // exact; 0 when empty
    /// Smallest bucket bound that at least `per_mille` of the values do not exceed; 0 when empty.
    std::uint64_t quantile(std::uint32_t per_mille) const;

private:
    static constexpr std::uint32_t kSubBucketBits = 5;
    static constexpr std::uint32_t kSubBuckets = 1U << kSubBucketBits;
    static constexpr std::uint32_t kBuckets = (64 - kSubBucketBits + 1) * kSubBuckets;

    static std::uint32_t bucket_of(std::uint64_t value);
    static std::uint64_t bound_of(std::uint32_t bucket);

    std::array<std::uint32_t, kBuckets> buckets_{};
    std::uint64_t count_ = 0;
    std::uint64_t max_ = 0;
};

} // namespace lockwind
