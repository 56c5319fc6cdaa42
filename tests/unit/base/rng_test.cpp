#include "lockwind/rng.h"

#include <array>
#include <bit>
#include <cstdint>
#include <gtest/gtest.h>
#include <set>

namespace lockwind {
namespace {

TEST(Rng, MixesLikePublishedSplitMix64) {
    // First outputs of SplitMix64 from seed 1234567 (Rosetta Code, "Pseudo-random
    // numbers/Splitmix64").
    constexpr std::array<std::uint64_t, 5> kPublished{6457827717110365317U,
                                                      3203168211198807973U,
                                                      9817491932198370423U,
                                                      4593380528125082431U,
                                                      16408922859458223821U};
    for (std::size_t step = 0; step < kPublished.size(); ++step) {
        EXPECT_EQ(split_mix(1234567U + (step + 1) * kSplitMixGamma), kPublished[step]);
    }
}

TEST(Rng, DrawsNeverChange) {
    EXPECT_EQ(random_u64(1, 1, 0),
              split_mix(split_mix(split_mix(1 + kSplitMixGamma) ^ 1) + kSplitMixGamma));
    static_assert(random_u64(1, 2, 3) == random_u64(1, 2, 3));
}

TEST(Rng, EveryArgumentMatters) {
    std::set<std::uint64_t> seen;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        for (std::uint64_t id = 0; id < 10; ++id) {
            for (std::uint64_t counter = 0; counter < 10; ++counter) {
                seen.insert(random_u64(seed, id, counter));
            }
        }
    }
    EXPECT_EQ(seen.size(), 1000U);
}

TEST(Rng, NeighbouringDrawsDifferInHalfTheirBits) {
    std::uint64_t seed_bits = 0;
    std::uint64_t id_bits = 0;
    std::uint64_t counter_bits = 0;
    constexpr std::uint64_t kDraws = 10000;
    for (std::uint64_t n = 0; n < kDraws; ++n) {
        const std::uint64_t draw = random_u64(5, 7, n);
        seed_bits += static_cast<unsigned>(std::popcount(draw ^ random_u64(4, 7, n)));
        id_bits += static_cast<unsigned>(std::popcount(draw ^ random_u64(5, 6, n)));
        counter_bits += static_cast<unsigned>(std::popcount(draw ^ random_u64(5, 7, n + 1)));
    }
    // Mean 32, standard deviation 4 / sqrt(10,000) = 0.04: five of them.
    for (const std::uint64_t bits : {seed_bits, id_bits, counter_bits}) {
        EXPECT_NEAR(static_cast<double>(bits) / kDraws, 32.0, 0.2);
    }
}

TEST(Rng, FillsARangeEvenly) {
    std::array<int, 10> counts{};
    for (std::uint64_t n = 0; n < 100000; ++n) {
        ++counts[random_below(3, 9, n, 10)];
    }
    // Binomial: mean 10,000, standard deviation 95.
    for (const int count : counts) {
        EXPECT_NEAR(count, 10000, 475);
    }
}

TEST(Rng, StaysBelowItsBound) {
    for (std::uint64_t n = 0; n < 1000; ++n) {
        EXPECT_EQ(random_below(1, 1, n, 1), 0U);
        EXPECT_LT(random_below(1, 1, n, 3), 3U);
    }
}

TEST(Rng, UnitDrawsLieInTheirHalfOpenRange) {
    constexpr std::int64_t kOne = std::int64_t{1} << 32U;
    std::int64_t sum = 0;
    for (std::uint64_t n = 0; n < 10000; ++n) {
        const std::int64_t unit = random_unit(1, 2, n).raw();
        EXPECT_GE(unit, 0);
        EXPECT_LT(unit, kOne);
        const std::int64_t symmetric = random_symmetric(1, 2, n).raw();
        EXPECT_GE(symmetric, -kOne);
        EXPECT_LT(symmetric, kOne);
        sum += symmetric / 10000;
    }
    // Standard deviation of the mean: 1 / sqrt(3 x 10,000).
    EXPECT_NEAR(static_cast<double>(sum) / static_cast<double>(kOne), 0.0, 0.03);
}

} // namespace
} // namespace lockwind
