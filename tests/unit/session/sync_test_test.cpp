#include "session/sync_test.h"
#include "tests/support/counter_simulation.h"

#include <gtest/gtest.h>

namespace lockwind::testing {
namespace {

std::vector<SlotInput> inputs_of(Tick tick) {
    std::vector<SlotInput> inputs(3);
    for (std::size_t slot = 0; slot < inputs.size(); ++slot) {
        inputs[slot].status = InputStatus::confirmed;
        inputs[slot].bytes[0] = static_cast<std::uint8_t>(tick * 7 + slot);
    }
    return inputs;
}

TEST(SyncTest, PassesASimulationThatRollsBack) {
    for (const std::uint32_t distance : {1U, 2U, 8U}) {
        CounterSimulation simulation(3);
        CounterSimulation straight(3);
        SyncTestSession session(simulation, distance);
        for (Tick tick = 1; tick <= 50; ++tick) {
            const auto result = session.advance(inputs_of(tick));
            ASSERT_TRUE(result.ok());
            ASSERT_FALSE(result.value().has_value());
            ASSERT_TRUE(straight.advance(inputs_of(tick)).ok());
            EXPECT_EQ(simulation.tick(), tick);
            EXPECT_EQ(simulation.state_hash(), straight.state_hash());
        }
        EXPECT_EQ(session.ticks_advanced(), 50U);
        // `distance` ticks again each tick, fewer at the beginning.
        EXPECT_EQ(session.ticks_resimulated(), 50 * distance - distance * (distance - 1) / 2);
    }
}

TEST(SyncTest, FindsAFieldThatSaveOmits) {
    for (const std::uint32_t distance : {1U, 2U, 8U}) {
        CounterSimulation simulation(3, CounterDefect::save_omits_a_field);
        SyncTestSession session(simulation, distance);
        Tick tick = 0;
        while (!session.mismatch() && tick < 1000) {
            ++tick;
            ASSERT_TRUE(session.advance(inputs_of(tick)).ok());
        }
        ASSERT_TRUE(session.mismatch().has_value());
        const SyncMismatch& mismatch = *session.mismatch();
        EXPECT_LE(mismatch.tick, tick);
        EXPECT_LT(mismatch.rolled_back_to, mismatch.tick);
        EXPECT_GE(mismatch.rolled_back_to + distance, mismatch.tick);
        EXPECT_NE(mismatch.hash, mismatch.resimulated_hash);
        // The forgotten field shows first in the last slot's total: section 1 of those hashed.
        EXPECT_EQ(mismatch.section, 1U);
        EXPECT_EQ(mismatch.section_name, "total");
        EXPECT_EQ(mismatch.page, 0U);
    }
}

TEST(SyncTest, FindsAStateThatLoadDoesNotRestore) {
    /// Loads everything but the last slot's total.
    class Forgetful final : public Simulation {
    public:
        std::uint32_t slot_count() const override { return inner_.slot_count(); }
        std::uint32_t input_size_bytes() const override { return inner_.input_size_bytes(); }
        Tick tick() const override { return inner_.tick(); }
        Status advance(std::span<const SlotInput> inputs) override {
            return inner_.advance(inputs);
        }
        std::uint64_t state_hash() const override { return inner_.state_hash(); }
        HashTree hash_tree() const override { return inner_.hash_tree(); }
        void save(std::vector<std::byte>& out) const override { inner_.save(out); }
        Status load(std::span<const std::byte> bytes) override {
            std::vector<std::byte> present;
            inner_.save(present);
            std::vector<std::byte> mixed(bytes.begin(), bytes.end());
            std::copy(present.end() - 8, present.end(), mixed.end() - 8);
            return inner_.load(mixed);
        }
        StateSchema schema() const override { return inner_.schema(); }
        std::span<const std::string_view> phases() const override { return inner_.phases(); }
        void observe(PhaseObserver* observer) override { inner_.observe(observer); }
        bool corrupt(std::string_view field) override { return inner_.corrupt(field); }

    private:
        CounterSimulation inner_{3};
    };
    Forgetful simulation;
    SyncTestSession session(simulation, 4);
    const auto result = session.advance(inputs_of(1));
    ASSERT_TRUE(result.ok());
    ASSERT_TRUE(result.value().has_value());
    EXPECT_EQ(result.value()->tick, 0U); // right after the load
    EXPECT_EQ(result.value()->rolled_back_to, 0U);
    EXPECT_EQ(result.value()->section_name, "total");
}

TEST(SyncTest, HandsOnTheSimulationsOwnError) {
    CounterSimulation simulation(3);
    simulation.fail_at(3);
    SyncTestSession session(simulation, 2);
    EXPECT_TRUE(session.advance(inputs_of(1)).ok());
    EXPECT_TRUE(session.advance(inputs_of(2)).ok());
    const auto result = session.advance(inputs_of(3));
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().message, "counter: planted failure");
    EXPECT_FALSE(session.mismatch().has_value());
}

TEST(HashTreeDifference, NamesTheFirstSectionAndPage) {
    HashTree a;
    a.sections = {1, 2, 3};
    a.pages = {{1}, {5, 6, 7}, {9}};
    HashTree b = a;
    EXPECT_EQ(first_difference(a, b).section, kNoIndex);
    b.sections[1] = 22;
    b.pages[1][2] = 77;
    b.sections[2] = 33;
    EXPECT_EQ(first_difference(a, b).section, 1U);
    EXPECT_EQ(first_difference(a, b).page, 2U);
    b = a;
    b.sections[2] = 33;
    b.pages[2].push_back(10); // one page more
    EXPECT_EQ(first_difference(a, b).section, 2U);
    EXPECT_EQ(first_difference(a, b).page, 1U);
    b = a;
    b.sections.push_back(4); // one section more
    EXPECT_EQ(first_difference(a, b).section, 3U);
    EXPECT_EQ(first_difference(a, b).page, kNoIndex);
}

} // namespace
} // namespace lockwind::testing
