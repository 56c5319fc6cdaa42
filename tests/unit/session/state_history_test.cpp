#include "session/state_history.h"
#include "tests/support/counter_simulation.h"

#include <gtest/gtest.h>

namespace lockwind::testing {
namespace {

std::vector<std::byte> bytes_of(Tick tick) {
    return std::vector<std::byte>(3, static_cast<std::byte>(tick));
}

TEST(StateHistory, KeepsTheNewestCapacityStates) {
    StateHistory history(4);
    EXPECT_TRUE(history.empty());
    EXPECT_EQ(history.find(0), nullptr);
    for (Tick tick = 0; tick < 11; ++tick) {
        history.put(tick, 100 + tick, bytes_of(tick));
        EXPECT_EQ(history.newest_tick(), tick);
    }
    EXPECT_EQ(history.size(), 4U);
    EXPECT_EQ(history.oldest_tick(), 7U);
    EXPECT_EQ(history.find(6), nullptr);
    EXPECT_EQ(history.find(11), nullptr);
    for (Tick tick = 7; tick <= 10; ++tick) {
        ASSERT_NE(history.find(tick), nullptr);
        EXPECT_EQ(history.find(tick)->hash, 100 + tick);
        EXPECT_EQ(history.find(tick)->bytes, bytes_of(tick));
    }
}

TEST(StateHistory, FindsTheNewestAtOrBeforeATickThatWasNotSaved) {
    StateHistory history(8);
    for (const Tick tick : {4U, 8U, 12U}) {
        history.put(tick, tick, bytes_of(tick));
    }
    EXPECT_EQ(history.find(9), nullptr);
    ASSERT_NE(history.find_at_or_before(9), nullptr);
    EXPECT_EQ(history.find_at_or_before(9)->tick, 8U);
    EXPECT_EQ(history.find_at_or_before(8)->tick, 8U);
    EXPECT_EQ(history.find_at_or_before(100)->tick, 12U);
    EXPECT_EQ(history.find_at_or_before(3), nullptr);
}

TEST(StateHistory, DiscardsAtBothEndsAndGoesOn) {
    StateHistory history(4);
    for (Tick tick = 1; tick <= 6; ++tick) {
        history.put(tick, tick, bytes_of(tick));
    }
    history.discard_before(5);
    EXPECT_EQ(history.oldest_tick(), 5U);
    history.discard_after(5); // a rollback to 5
    EXPECT_EQ(history.newest_tick(), 5U);
    history.put(6, 66, bytes_of(6));
    EXPECT_EQ(history.find(6)->hash, 66U);
    history.discard_before(100);
    EXPECT_TRUE(history.empty());
    history.put(200, 1, bytes_of(200));
    EXPECT_EQ(history.oldest_tick(), 200U);
}

TEST(StateHistory, SavesWhatTheSimulationLoads) {
    CounterSimulation simulation(2);
    StateHistory history(3);
    std::vector<SlotInput> inputs(2);
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < 3; ++i) {
        history.save(simulation, simulation.state_hash());
        hashes.push_back(simulation.state_hash());
        inputs[0].bytes[0] = static_cast<std::uint8_t>(i + 1);
        ASSERT_TRUE(simulation.advance(inputs).ok());
    }
    for (const Tick tick : {2U, 0U, 1U}) {
        ASSERT_TRUE(simulation.load(history.find(tick)->bytes).ok());
        EXPECT_EQ(simulation.tick(), tick);
        EXPECT_EQ(simulation.state_hash(), hashes[static_cast<std::size_t>(tick)]);
        EXPECT_EQ(history.find(tick)->hash, hashes[static_cast<std::size_t>(tick)]);
    }
}

} // namespace
} // namespace lockwind::testing
