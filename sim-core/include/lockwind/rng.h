#pragma once

#include "lockwind/vector.h"

#include <cstdint>

namespace lockwind {

/// Counter-based random numbers: draw `counter` of stream (seed, id) is a pure function of the
/// three, so that who draws, and when, never disturbs another's draws. The counter is the caller's
/// state.
///
/// A stream is a SplitMix64 sequence (Steele, Lea, Flood: "Fast splittable pseudorandom number
/// generators", OOPSLA 2014) whose start is the seed and id mixed by the same finaliser.
inline constexpr std::uint64_t kSplitMixGamma = 0x9e3779b97f4a7c15U;

constexpr std::uint64_t split_mix(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
}

constexpr std::uint64_t random_u64(std::uint64_t seed, std::uint64_t id, std::uint64_t counter) {
    const std::uint64_t start = split_mix(split_mix(seed + kSplitMixGamma) ^ id);
    return split_mix(start + (counter + 1) * kSplitMixGamma);
}

constexpr std::uint32_t random_u32(std::uint64_t seed, std::uint64_t id, std::uint64_t counter) {
    return static_cast<std::uint32_t>(random_u64(seed, id, counter) >> 32U);
}

/// 0 .. bound - 1; a value's probability is off by less than 2^-32. bound > 0.
constexpr std::uint32_t
random_below(std::uint64_t seed, std::uint64_t id, std::uint64_t counter, std::uint32_t bound) {
    return static_cast<std::uint32_t>(
        (static_cast<std::uint64_t>(random_u32(seed, id, counter)) * bound) >> 32U);
}

/// Uniform in [0, 1), in steps of 2^-32.
constexpr Real random_unit(std::uint64_t seed, std::uint64_t id, std::uint64_t counter) {
    return Real::from_raw(random_u32(seed, id, counter));
}

/// Uniform in [-1, 1), in steps of 2^-31.
constexpr Real random_symmetric(std::uint64_t seed, std::uint64_t id, std::uint64_t counter) {
    constexpr std::int64_t kOne = std::int64_t{1} << 32U;
    return Real::from_raw(static_cast<std::int64_t>(random_u32(seed, id, counter)) * 2 - kOne);
}

} // namespace lockwind
