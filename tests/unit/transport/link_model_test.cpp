#include "transport/sim/link_model.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace lockwind {
namespace {

constexpr std::uint64_t kIntervalUs = 16'667;
constexpr std::uint64_t kPackets = 20'000;

struct Outcome {
    std::uint64_t lost = 0;
    std::uint64_t doubled = 0;
    std::uint64_t overtaken = 0; // arrived before a packet sent earlier
    std::uint64_t delay_us_min = ~std::uint64_t{0};
    std::uint64_t delay_us_max = 0;
    std::uint64_t delay_us_sum = 0;
    std::vector<std::uint64_t> arrivals_us;
};

/// kPackets packets of 100 bytes, kIntervalUs apart.
Outcome run(const LinkConditions& conditions, Channel channel, std::uint64_t seed = 1) {
    LinkModel model(conditions, seed);
    Outcome result;
    std::uint64_t newest_us = 0;
    for (std::uint64_t i = 0; i < kPackets; ++i) {
        const std::uint64_t now_us = i * kIntervalUs;
        const Arrivals arrivals = model.schedule(now_us, channel, 100);
        result.lost += arrivals.count == 0 ? 1 : 0;
        result.doubled += arrivals.count == 2 ? 1 : 0;
        for (const std::uint64_t at_us : arrivals.times()) {
            result.overtaken += at_us < newest_us ? 1 : 0;
            newest_us = std::max(newest_us, at_us);
            result.delay_us_min = std::min(result.delay_us_min, at_us - now_us);
            result.delay_us_max = std::max(result.delay_us_max, at_us - now_us);
            result.delay_us_sum += at_us - now_us;
            result.arrivals_us.push_back(at_us);
        }
    }
    return result;
}

LinkConditions wan() {
    LinkConditions conditions;
    conditions.latency_us = 80'000;
    conditions.jitter_us = 20'000;
    conditions.loss_ppm = 50'000;
    conditions.duplicate_ppm = 10'000;
    conditions.reorder_ppm = 10'000;
    return conditions;
}

/// Within 5 standard deviations of a binomial count of kPackets trials.
void expect_rate(std::uint64_t count, std::uint32_t ppm) {
    const double p = ppm / 1e6;
    const double mean = static_cast<double>(kPackets) * p;
    const double deviation = 5 * std::sqrt(mean * (1 - p));
    EXPECT_NEAR(static_cast<double>(count), mean, deviation);
}

TEST(LinkModel, IsPerfectByDefault) {
    for (const Channel channel : {Channel::best_effort, Channel::reliable}) {
        const Outcome result = run({}, channel);
        EXPECT_EQ(result.arrivals_us.size(), kPackets);
        EXPECT_EQ(result.delay_us_max, 0U);
    }
}

TEST(LinkModel, RepeatsItselfFromItsSeed) {
    for (const Channel channel : {Channel::best_effort, Channel::reliable}) {
        EXPECT_EQ(run(wan(), channel, 7).arrivals_us, run(wan(), channel, 7).arrivals_us);
        EXPECT_NE(run(wan(), channel, 7).arrivals_us, run(wan(), channel, 8).arrivals_us);
    }
}

TEST(LinkModel, LosesAndDoublesAtTheRatesSet) {
    LinkConditions conditions = wan();
    for (const std::uint32_t ppm : {1'000U, 20'000U, 50'000U, 300'000U}) {
        conditions.loss_ppm = ppm;
        conditions.duplicate_ppm = 0;
        expect_rate(run(conditions, Channel::best_effort).lost, ppm);
        conditions.loss_ppm = 0;
        conditions.duplicate_ppm = ppm;
        expect_rate(run(conditions, Channel::best_effort).doubled, ppm);
    }
    conditions.loss_ppm = 1'000'000;
    EXPECT_EQ(run(conditions, Channel::best_effort).lost, kPackets);
    EXPECT_EQ(run(conditions, Channel::reliable).lost, kPackets);
}

TEST(LinkModel, DelaysWithinLatencyAndJitter) {
    LinkConditions conditions;
    conditions.latency_us = 80'000;
    conditions.jitter_us = 20'000;
    const Outcome result = run(conditions, Channel::best_effort);
    EXPECT_GE(result.delay_us_min, 60'000U);
    EXPECT_LT(result.delay_us_min, 60'100U);
    EXPECT_LE(result.delay_us_max, 100'000U);
    EXPECT_GT(result.delay_us_max, 99'900U);
    EXPECT_NEAR(static_cast<double>(result.delay_us_sum) / kPackets, 80'000, 500);
}

TEST(LinkModel, ReordersByTheDelaySet) {
    LinkConditions conditions;
    conditions.latency_us = 40'000;
    conditions.reorder_ppm = 30'000;
    const Outcome result = run(conditions, Channel::best_effort);
    EXPECT_EQ(result.delay_us_max, 60'000U);
    // A packet held back is overtaken by its successor unless that one is held back too.
    EXPECT_GT(result.overtaken, kPackets * 2 / 100);
    EXPECT_LT(result.overtaken, kPackets * 4 / 100);
}

TEST(LinkModel, KeepsReliablePacketsWholeAndInOrder) {
    const Outcome result = run(wan(), Channel::reliable);
    EXPECT_EQ(result.lost, 0U);
    EXPECT_EQ(result.doubled, 0U);
    EXPECT_EQ(result.overtaken, 0U);
    EXPECT_EQ(result.arrivals_us.size(), kPackets);
    // One lost try costs a round trip of 160 ms and the retransmission delay.
    EXPECT_GT(result.delay_us_max, 60'000 + 160'000 + LinkModel::kRetransmissionDelayUs);
}

TEST(LinkModel, ChangesNoOtherDrawWithAChance) {
    LinkConditions with_loss = wan();
    with_loss.duplicate_ppm = 0;
    LinkConditions without_loss = with_loss;
    without_loss.loss_ppm = 0;
    const std::vector<std::uint64_t> some = run(with_loss, Channel::best_effort).arrivals_us;
    std::vector<std::uint64_t> all = run(without_loss, Channel::best_effort).arrivals_us;
    ASSERT_LT(some.size(), all.size());
    auto place = all.begin();
    for (const std::uint64_t at_us : some) {
        place = std::find(place, all.end(), at_us);
        ASSERT_NE(place, all.end()) << "the packets that are not lost arrive when they did";
    }
}

TEST(LinkModel, SpacesPacketsByTheBandwidth) {
    LinkConditions conditions;
    conditions.latency_us = 1'000;
    conditions.bandwidth_bytes_per_s = 100'000;
    LinkModel model(conditions, 1);
    // 1,000 bytes take 10 ms on the wire.
    EXPECT_EQ(model.schedule(0, Channel::best_effort, 1'000).at_us[0], 11'000U);
    EXPECT_EQ(model.schedule(0, Channel::reliable, 1'000).at_us[0], 21'000U);
    EXPECT_EQ(model.schedule(5'000, Channel::best_effort, 1'000).at_us[0], 31'000U);
    EXPECT_EQ(model.schedule(100'000, Channel::best_effort, 1'000).at_us[0], 111'000U);
}

TEST(LinkModel, LosesBestEffortPacketsBehindALongQueue) {
    LinkConditions conditions;
    conditions.bandwidth_bytes_per_s = 100'000;
    LinkModel model(conditions, 1);
    std::uint32_t arrived = 0;
    for (int i = 0; i < 100; ++i) {
        arrived += model.schedule(0, Channel::best_effort, 1'000).count;
    }
    EXPECT_EQ(arrived, 51U) << "500 ms of queue and the packet that ends it";
    EXPECT_EQ(model.schedule(0, Channel::reliable, 1'000).at_us[0], 520'000U);
}

} // namespace
} // namespace lockwind
