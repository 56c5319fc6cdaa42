#include "session/conduct.h"
#include "session/confirmed_history.h"
#include "session/hash_ledger.h"
#include "session/histogram.h"
#include "session/input_buffer.h"
#include "session/match_config.h"
#include "session/request.h"
#include "session/round_trip.h"
#include "session/tick_clock.h"
#include "session/violation.h"

#include <gtest/gtest.h>
#include <set>
#include <string_view>
#include <vector>

namespace lockwind::testing {
namespace {

std::vector<SlotInput> inputs_from(std::uint8_t first, std::size_t count) {
    std::vector<SlotInput> inputs(count);
    for (std::size_t i = 0; i < count; ++i) {
        inputs[i].bytes[0] = static_cast<std::uint8_t>(first + i);
    }
    return inputs;
}

TEST(InputBuffer, RefusesTickOlderThanWindow) {
    InputBuffer buffer(1);
    ViolationCounts violations;
    const Tick confirmed = 1000;
    buffer.receive(confirmed - kInputWindowTicks, inputs_from(1, 1), confirmed, violations);
    EXPECT_EQ(violations.of(Violation::input_too_old), 1U);
    EXPECT_EQ(buffer.find(confirmed - kInputWindowTicks), nullptr);
    buffer.receive(confirmed - kInputWindowTicks + 1, inputs_from(1, 1), confirmed, violations);
    EXPECT_EQ(violations.total(), 1U);
}

TEST(InputBuffer, RefusesTickBeyondWindow) {
    InputBuffer buffer(1);
    ViolationCounts violations;
    buffer.receive(1000 + kInputWindowTicks, inputs_from(7, 2), 1000, violations);
    EXPECT_EQ(violations.of(Violation::input_too_new), 1U);
    ASSERT_NE(buffer.find(1000 + kInputWindowTicks), nullptr);
    EXPECT_EQ(buffer.find(1000 + kInputWindowTicks)->bytes[0], 7U);
    EXPECT_EQ(buffer.find(1000 + kInputWindowTicks + 1), nullptr);
}

TEST(InputBuffer, HoldsAWholeWindowAheadAndBehindWithoutCollision) {
    InputBuffer buffer(1);
    ViolationCounts violations;
    Tick confirmed = 500;
    buffer.receive(confirmed + 1, inputs_from(0, kInputWindowTicks), confirmed, violations);
    EXPECT_EQ(buffer.contiguous_tick(confirmed), confirmed + kInputWindowTicks);
    confirmed += kInputWindowTicks;
    buffer.receive(confirmed + 1, inputs_from(100, kInputWindowTicks), confirmed, violations);
    for (Tick tick = 501; tick <= 500 + kInputWindowTicks; ++tick) {
        ASSERT_NE(buffer.find(tick), nullptr);
        EXPECT_EQ(buffer.find(tick)->bytes[0], static_cast<std::uint8_t>(tick - 501));
    }
    EXPECT_EQ(violations.total(), 0U);
}

TEST(InputBuffer, ReportsHowFarInputsAreWithoutAGap) {
    InputBuffer buffer(1);
    ViolationCounts violations;
    buffer.receive(12, inputs_from(1, 2), 9, violations);
    EXPECT_EQ(buffer.contiguous_tick(9), 9U);
    buffer.receive(10, inputs_from(5, 2), 9, violations);
    EXPECT_EQ(buffer.contiguous_tick(9), 13U);
    EXPECT_EQ(buffer.contiguous_tick(20), 20U); // what is confirmed is no longer wanted
}

TEST(InputBuffer, CountsEachLateInputOnce) {
    InputBuffer buffer(1);
    ViolationCounts violations;
    buffer.count_late_after(90);
    EXPECT_EQ(buffer.receive(95, inputs_from(1, 3), 100, violations), 3U);
    EXPECT_EQ(buffer.receive(95, inputs_from(1, 3), 100, violations), 0U);
    EXPECT_EQ(buffer.receive(88, inputs_from(1, 4), 100, violations), 1U); // 91 only
    EXPECT_EQ(violations.total(), 0U);
}

TEST(InputBuffer, ForgetsTheFormerHoldersInputs) {
    InputBuffer buffer(1);
    ViolationCounts violations;
    buffer.count_late_after(0);
    buffer.receive(5, inputs_from(1, 3), 4, violations);
    buffer.reset();
    EXPECT_EQ(buffer.find(5), nullptr);
    EXPECT_EQ(buffer.receive(3, inputs_from(9, 1), 4, violations), 0U);
    EXPECT_EQ(violations.total(), 0U);
}

TEST(ConfirmedHistory, FillsMessagesFromAnyTickItKeeps) {
    ConfirmedHistory history(10);
    EXPECT_EQ(history.oldest_tick(), 11U);
    EXPECT_TRUE(history.find(10).empty());
    for (std::uint8_t i = 0; i < 20; ++i) {
        history.push(inputs_from(i, 2));
    }
    history.discard_before(15);
    EXPECT_EQ(history.oldest_tick(), 15U);
    EXPECT_EQ(history.newest_tick(), 30U);
    EXPECT_TRUE(history.find(14).empty());
    Confirmation confirmation;
    history.fill(confirmation, 28, 100);
    EXPECT_EQ(confirmation.first_tick, 28U);
    EXPECT_EQ(confirmation.confirmed_tick, 30U);
    ASSERT_EQ(confirmation.ticks.size(), 3U);
    EXPECT_EQ(confirmation.ticks[2].inputs[1].bytes[0], 20U);
    Confirmation piece;
    history.fill(piece, 15, 4);
    ASSERT_EQ(piece.ticks.size(), 4U);
    EXPECT_EQ(piece.ticks[0].inputs[0].bytes[0], 4U);
    Confirmation none;
    history.fill(none, 31, 4);
    EXPECT_TRUE(none.ticks.empty());
}

TEST(HashLedger, AgreesUpToTheFirstGapAndNoFurther) {
    MatchConfig config;
    HashLedger ledger(config);
    ViolationCounts violations;
    for (Tick tick = 1; tick <= 10; ++tick) {
        ledger.record(tick, 100 + tick);
    }
    HashReport report;
    report.entries = {{2, 102}, {3, 103}, {5, 105}};
    HashLedger::Verdict verdict = ledger.verify(report, 2, 20, violations);
    EXPECT_EQ(verdict.agreed_tick, 3U);
    EXPECT_EQ(verdict.agreed_count, 1U);
    EXPECT_FALSE(verdict.mismatch.has_value());
    report.entries = {{10, 110}, {11, 111}, {12, 112}}; // 11 is confirmed, but not stepped here yet
    verdict = ledger.verify(report, 9, 20, violations);
    EXPECT_EQ(verdict.agreed_tick, 10U);
    EXPECT_FALSE(verdict.mismatch.has_value());
    EXPECT_EQ(violations.total(), 0U);
}

TEST(HashLedger, FindsTheFirstMismatch) {
    MatchConfig config;
    config.hash_interval_ticks = 5;
    config.ticks = 12;
    HashLedger ledger(config);
    ViolationCounts violations;
    ledger.record(5, 1);
    ledger.record(10, 2);
    ledger.record(12, 3);
    HashReport report;
    report.entries = {{5, 1}, {10, 9}, {12, 9}};
    const HashLedger::Verdict verdict = ledger.verify(report, 0, 12, violations);
    ASSERT_TRUE(verdict.mismatch.has_value());
    EXPECT_EQ(verdict.agreed_tick, 5U);
    EXPECT_EQ(verdict.mismatch->tick, 10U);
    EXPECT_EQ(verdict.mismatch->own_hash, 2U);
    EXPECT_EQ(verdict.mismatch->reported_hash, 9U);
    report.entries = {{7, 1}};
    ledger.verify(report, 5, 12, violations);
    EXPECT_EQ(violations.of(Violation::hash_malformed), 1U);
}

TEST(MatchConfig, NamesTheFieldThatIsOutOfRange) {
    MatchConfig good;
    good.mode = "lockstep";
    EXPECT_TRUE(check(good).ok());
    const auto message_of = [&](auto change) {
        MatchConfig config = good;
        change(config);
        const Status status = check(config);
        return status ? std::string() : status.error().message;
    };
    EXPECT_EQ(message_of([](MatchConfig& c) { c.players = 65; }),
              "match config: players is 65; allowed are 1 to 64");
    EXPECT_EQ(message_of([](MatchConfig& c) { c.hash_interval_ticks = 0; }),
              "match config: hash_interval_ticks is 0; allowed are 1 to 60");
    EXPECT_EQ(message_of([](MatchConfig& c) { c.input_delay_ticks = 31; }),
              "match config: input_delay_ticks is 31; allowed are 0 to 30");
    EXPECT_EQ(message_of([](MatchConfig& c) { c.tick_rate_hz = 1001; }),
              "match config: tick_rate_hz is 1001; allowed are 1 to 1000");
    EXPECT_NE(message_of([](MatchConfig& c) { c.ticks = ~Tick{0}; }).find("ticks is"),
              std::string::npos);
    EXPECT_NE(message_of([](MatchConfig& c) { c.mode = "rollback"; }).find("\"rollback\""),
              std::string::npos);
}

TEST(MatchConfig, HashesAreDueAtTheIntervalAndOnTheLastTick) {
    MatchConfig config;
    config.hash_interval_ticks = 4;
    config.ticks = 10;
    std::vector<Tick> due;
    for (Tick tick = next_hash_tick(config, 0); tick <= 10; tick = next_hash_tick(config, tick)) {
        EXPECT_TRUE(hash_due(config, tick));
        due.push_back(tick);
    }
    EXPECT_EQ(due, (std::vector<Tick>{4, 8, 10}));
    EXPECT_FALSE(hash_due(config, 9));
    config.ticks = 0;
    EXPECT_EQ(next_hash_tick(config, 8), 12U);
    EXPECT_FALSE(hash_due(config, 10));
}

TEST(TickClock, DoesNotDriftOverAWeek) {
    TickClock clock(60);
    clock.start(500);
    EXPECT_EQ(clock.due_us(1), 500U + 16'666U);
    EXPECT_EQ(clock.due_us(3), 500U + 50'000U);
    const Tick week = Tick{60} * 60 * 60 * 24 * 7;
    EXPECT_EQ(clock.due_us(week), 500U + 604'800'000'000U);
    clock.rebase(1'000);
    EXPECT_EQ(clock.due_us(week), 1500U + 604'800'000'000U);
}

TEST(Histogram, IsExactForSmallValuesAndWithin32PerMilleAbove) {
    Histogram small;
    EXPECT_EQ(small.quantile(500), 0U);
    for (std::uint64_t value = 0; value < 32; ++value) {
        small.add(value);
    }
    EXPECT_EQ(small.count(), 32U);
    EXPECT_EQ(small.max(), 31U);
    EXPECT_EQ(small.quantile(500), 15U);
    EXPECT_EQ(small.quantile(1000), 31U);
    EXPECT_EQ(small.quantile(0), 0U);
    std::uint64_t checked = 0;
    for (unsigned shift = 5; shift < 64; ++shift) {
        for (const std::uint64_t step : {0U, 1U, 2U, 3U}) {
            const std::uint64_t value = (std::uint64_t{1} << shift) + (step << (shift - 2U));
            Histogram histogram;
            histogram.add(value);
            histogram.add(~std::uint64_t{0}); // so that max() does not hide the bucket's bound
            const std::uint64_t median = histogram.quantile(500);
            EXPECT_GE(median, value);
            EXPECT_LE(median - value, value / 31);
            ++checked;
        }
    }
    EXPECT_EQ(checked, 59U * 4U);
}

TEST(RoundTrip, FollowsTheDelayAndItsSpread) {
    RoundTrip round_trip;
    EXPECT_EQ(round_trip.bound_us(), 0U);
    for (int i = 0; i < 100; ++i) {
        round_trip.add(100'000);
    }
    EXPECT_GE(round_trip.bound_us(), 100'000U);
    EXPECT_LE(round_trip.bound_us(), 101'000U); // steady: no spread is left
    for (int i = 0; i < 100; ++i) {
        round_trip.add(i % 2 == 0 ? 80'000 : 120'000);
    }
    EXPECT_GE(round_trip.bound_us(), 120'000U);
    EXPECT_LE(round_trip.bound_us(), 220'000U);
}

TEST(SessionNames, AreDistinct) {
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < kViolationCount; ++i) {
        names.insert(to_string(static_cast<Violation>(i)));
    }
    EXPECT_EQ(names.size(), kViolationCount);
    names.clear();
    for (int i = 0; i <= static_cast<int>(SessionEventKind::ended); ++i) {
        names.insert(to_string(static_cast<SessionEventKind>(i)));
    }
    EXPECT_EQ(names.size(), static_cast<std::size_t>(SessionEventKind::ended) + 1);
    EXPECT_EQ(names.count("unknown"), 0U);
    EXPECT_EQ(to_string(EndReason::desync), "desync");
    EXPECT_EQ(to_string(RefuseReason::match_full), "match_full");
}

TEST(Messages, TravelAsMessagesHeaderStates) {
    EXPECT_EQ(delivery_of(InputBatch{}), Delivery::best_effort);
    EXPECT_EQ(delivery_of(Confirmation{}), Delivery::best_effort);
    EXPECT_EQ(delivery_of(HashReport{}), Delivery::reliable);
    EXPECT_EQ(delivery_of(Chunk{}), Delivery::reliable);
    EXPECT_EQ(delivery_of(Hello{}), Delivery::reliable);
    EXPECT_EQ(delivery_of(End{}), Delivery::reliable);
}

TEST(TokenBucket, LetsTheRateAndItsBurstThroughAndNoMore) {
    TokenBucket bucket(100, 50);
    const auto taken = [&](int count, std::uint64_t now_us) {
        int result = 0;
        for (int i = 0; i < count; ++i) {
            result += bucket.take(now_us) ? 1 : 0;
        }
        return result;
    };
    EXPECT_EQ(taken(200, 1'000'000), 50);
    EXPECT_EQ(taken(10, 1'009'999), 0); // one each 10 ms
    EXPECT_EQ(taken(10, 1'010'000), 1);
    EXPECT_EQ(taken(10, 1'040'000), 3);
    EXPECT_EQ(taken(200, UINT64_MAX), 50);
}

} // namespace
} // namespace lockwind::testing
