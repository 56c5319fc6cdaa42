#include "tests/support/code_scenes.h"

#include "lockwind/hash_tree.h"

#include <cstring>
#include <gtest/gtest.h>
#include <vector>

namespace lockwind::test {
namespace {

constexpr int kTicks = 240;

/// With bodies of all collision modes that fly at a wall and each other.
WorldDefinition fast_scene() {
    WorldDefinition scene = busy_scene(60, 4);
    add_bullets(scene, 30000, {0, 12, 0});
    return scene;
}

/// Hashes of state(0) .. state(kTicks) of a straight run.
const std::vector<std::uint64_t>& straight_chain() {
    static const std::vector<std::uint64_t> states = [] {
        const WorldPtr world = make_world(fast_scene());
        std::vector<std::uint64_t> chain{world->state_hash()};
        for (int tick = 0; tick < kTicks; ++tick) {
            step_busy(*world);
            chain.push_back(world->state_hash());
        }
        return chain;
    }();
    return states;
}

TEST(Determinism, TheStraightRunIsNotVacuous) {
    const WorldPtr world = make_world(fast_scene());
    for (int tick = 0; tick < kTicks; ++tick) {
        step_busy(*world);
    }
    const WorldCounts counts = world->counts();
    EXPECT_GT(counts.contacts, 100U);
    EXPECT_GT(counts.created_total, 30U);
    EXPECT_GT(counts.destroyed_total, 5U);
    EXPECT_GT(counts.events_total, 500U);
}

TEST(Determinism, TheSameDefinitionAndInputsGiveTheSameChain) {
    const WorldPtr world = make_world(fast_scene());
    for (int tick = 0; tick < kTicks; ++tick) {
        ASSERT_EQ(world->state_hash(), straight_chain()[static_cast<std::size_t>(tick)]) << tick;
        step_busy(*world);
    }
    EXPECT_EQ(world->state_hash(), straight_chain().back());
}

TEST(Determinism, OneBitOfInputIsAnotherChain) {
    const WorldPtr world = make_world(fast_scene());
    std::vector<SlotInput> inputs = busy_inputs(1, 4);
    inputs[2].bytes[0] ^= 1;
    ASSERT_TRUE(world->step(inputs).ok());
    EXPECT_NE(world->state_hash(), straight_chain()[1]);
}

TEST(Determinism, WhereAnInputCameFromDoesNotMatter) {
    const WorldPtr world = make_world(fast_scene());
    std::vector<SlotInput> inputs = busy_inputs(1, 4);
    inputs[1].status = InputStatus::substituted;
    inputs[2].status = InputStatus::predicted;
    ASSERT_TRUE(world->step(inputs).ok());
    EXPECT_EQ(world->state_hash(), straight_chain()[1]);
}

TEST(Determinism, LoadingIntoAFreshWorldContinuesTheChain) {
    const WorldPtr world = make_world(fast_scene());
    std::vector<std::byte> bytes;
    for (int tick = 0; tick < kTicks; ++tick) {
        if (random_below(9, 1, world->tick(), 20) == 0) {
            world->save(bytes);
            const WorldPtr fresh = make_world(fast_scene());
            ASSERT_TRUE(fresh->load(bytes).ok());
            for (Tick next = world->tick(); next < world->tick() + 10 && next < kTicks; ++next) {
                ASSERT_EQ(fresh->state_hash(), straight_chain()[static_cast<std::size_t>(next)])
                    << next;
                step_busy(*fresh);
            }
        }
        step_busy(*world);
    }
}

/// Runs ahead with inputs that never come, back, and on: across shots, hits and despawns.
TEST(Determinism, RollingBackMispredictionsLeavesNoTrace) {
    const WorldPtr world = make_world(fast_scene());
    std::vector<std::byte> bytes;
    std::uint64_t created_rolled_back = 0;
    std::uint64_t destroyed_rolled_back = 0;
    for (int tick = 0; tick < kTicks; ++tick) {
        world->save(bytes);
        const std::uint32_t ahead = random_below(5, 1, world->tick(), 9);
        const WorldCounts before = world->counts();
        for (std::uint32_t step = 0; step < ahead; ++step) {
            ASSERT_TRUE(world->step(busy_inputs(world->tick() + 1, 4, 77)).ok());
        }
        created_rolled_back += world->counts().created_total - before.created_total;
        destroyed_rolled_back += world->counts().destroyed_total - before.destroyed_total;
        ASSERT_TRUE(world->load(bytes).ok());
        ASSERT_EQ(world->state_hash(), straight_chain()[static_cast<std::size_t>(tick)]) << tick;
        step_busy(*world);
    }
    EXPECT_EQ(world->state_hash(), straight_chain().back());
    EXPECT_GT(created_rolled_back, 20U);
    EXPECT_GT(destroyed_rolled_back, 5U);
}

TEST(Determinism, DroppingCachesChangesNoBit) {
    const WorldPtr world = make_world(fast_scene());
    for (int tick = 0; tick < kTicks; ++tick) {
        if (random_below(11, 1, world->tick(), 3) == 0) {
            world->drop_derived();
        }
        step_busy(*world);
        ASSERT_EQ(world->state_hash(), straight_chain()[static_cast<std::size_t>(world->tick())])
            << tick;
    }
}

TEST(Determinism, ReadingChangesNoBit) {
    const WorldPtr world = make_world(fast_scene());
    for (int tick = 0; tick < 60; ++tick) {
        static_cast<void>(world->hash_tree());
        static_cast<void>(world->counts());
        static_cast<void>(world->ray_cast({0, 1, -20}, {0, 1, 20}));
        for (BodyRow row = 0; row < world->body_count(); ++row) {
            static_cast<void>(world->body_at(row));
        }
        step_busy(*world);
        ASSERT_EQ(world->state_hash(), straight_chain()[static_cast<std::size_t>(world->tick())]);
    }
}

} // namespace
} // namespace lockwind::test
