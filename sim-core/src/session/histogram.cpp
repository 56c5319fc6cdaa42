#include "session/histogram.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <bit>

namespace lockwind {

// Below kSubBuckets a value is its own bucket. Above, the top kSubBucketBits + 1 bits are kept:
// `shift` counts the dropped ones, and each shift has kSubBuckets buckets of width 2^shift.
std::uint32_t Histogram::bucket_of(std::uint64_t value) {
    if (value < kSubBuckets) {
        return static_cast<std::uint32_t>(value);
    }
    const auto shift = static_cast<std::uint32_t>(std::bit_width(value)) - kSubBucketBits - 1;
    return shift * kSubBuckets + static_cast<std::uint32_t>(value >> shift);
}

std::uint64_t Histogram::bound_of(std::uint32_t bucket) {
    if (bucket < kSubBuckets) {
        return bucket;
    }
    const std::uint32_t shift = bucket / kSubBuckets - 1;
    const std::uint64_t top = bucket - shift * kSubBuckets;
    return (top << shift) + ((std::uint64_t{1} << shift) - 1);
}

void Histogram::add(std::uint64_t value) {
    ++buckets_[bucket_of(value)];
    ++count_;
    max_ = std::max(max_, value);
}

std::uint64_t Histogram::quantile(std::uint32_t per_mille) const {
    LOCKWIND_ASSERT(per_mille <= 1000);
    const std::uint64_t wanted = std::max<std::uint64_t>(1, (count_ * per_mille + 999) / 1000);
    std::uint64_t seen = 0;
    for (std::uint32_t bucket = 0; bucket < kBuckets; ++bucket) {
        seen += buckets_[bucket];
        if (seen >= wanted) {
            return std::min(bound_of(bucket), max_);
        }
    }
    return max_;
}

} // namespace lockwind
