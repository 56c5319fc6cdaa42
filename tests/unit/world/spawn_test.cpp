#include "base/arena.h"
#include "systems/spawn.h"
#include "world/state.h"

#include "lockwind/rng.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <map>
#include <vector>

namespace lockwind::test {
namespace {

constexpr BodyId kKinds = 7; // of records

constexpr std::array<std::uint32_t, section::kCount> kCapacities{
    1, 1, 32, 32, 32, 32, 200, 200, 8, 4, 200};

struct Tables {
    StateArena arena{kWorldSections, kCapacities};
    DynamicsTables dynamics{arena.table<BodyMotion>(section::kBody),
                            arena.table<BodyProperties>(section::kBodyKind),
                            arena.table<BodyLife>(section::kBodyLife),
                            arena.table<BodySleep>(section::kBodySleep),
                            arena.table<Pair>(section::kPair),
                            arena.table<Manifold>(section::kManifold),
                            arena.table<ContactImpulse>(section::kContactImpulse),
                            arena.table<Joint>(section::kJoint)};

    void add(BodyId id) {
        const std::uint32_t row = dynamics.motion.count();
        dynamics.motion.set_count(row + 1);
        dynamics.lives.set_count(row + 1);
        dynamics.sleep.set_count(row + 1);
        dynamics.motion[row].id = id;
        BodyProperties properties{};
        properties.friction = static_cast<std::int32_t>(1 + id % kKinds);
        dynamics.lives[row] = {kind_of(properties), static_cast<std::uint32_t>(id), 0};
    }
    std::uint32_t kind_of(const BodyProperties& properties) {
        std::uint32_t kind = 0;
        while (kind < dynamics.kinds.count() &&
               dynamics.kinds[kind].friction != properties.friction) {
            ++kind;
        }
        if (kind == dynamics.kinds.count()) {
            dynamics.kinds.set_count(kind + 1);
            dynamics.kinds[kind] = properties;
        }
        return kind;
    }
    void pair(BodyRow a, BodyRow b) {
        const std::uint32_t row = dynamics.pairs.count();
        dynamics.pairs.set_count(row + 1);
        dynamics.pairs[row] = Pair{a, b, 0, kNoIndex, 0, 0, {0, 0}};
    }
};

BodyRecord record(BodyId id) {
    BodyRecord body{};
    body.motion.id = id;
    body.properties.friction = static_cast<std::int32_t>(1 + id % kKinds);
    body.life.spawn_count = static_cast<std::uint32_t>(id);
    return body;
}

TEST(Spawner, FindsRowsById) {
    Tables tables;
    for (const BodyId id : {3U, 7U, 20U}) {
        tables.add(id);
    }
    EXPECT_EQ(row_of(tables.dynamics.motion, 3), 0U);
    EXPECT_EQ(row_of(tables.dynamics.motion, 20), 2U);
    EXPECT_EQ(row_of(tables.dynamics.motion, 8), kNoIndex);
    EXPECT_EQ(row_of(tables.dynamics.motion, 21), kNoIndex);
}

TEST(Spawner, IdsNameTheirSpawner) {
    EXPECT_EQ(spawned_id(7, 3), 0x700000003U);
    EXPECT_EQ(spawner_of(spawned_id(7, 3)), 7U);
    EXPECT_EQ(spawner_of(0xffffffffU), 0U);
}

/// Random merges against a sorted map.
TEST(Spawner, MergesLikeASortedMap) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Tables tables;
        Spawner spawner(32, 16);
        std::map<BodyId, bool> model;
        std::uint64_t draw = 0;
        const auto below = [&](std::uint32_t bound) {
            return random_below(seed, 1, draw++, bound);
        };
        for (BodyId id = 1; id <= 60; ++id) {
            if (below(4) == 0 && model.size() < 16) {
                model[id] = true;
                tables.add(id);
            }
        }
        std::vector<BodyId> gone;
        for (BodyRow row = 0; row < tables.dynamics.motion.count(); ++row) {
            if (below(3) == 0) {
                const BodyId id = tables.dynamics.motion[row].id;
                gone.push_back(id);
                EXPECT_TRUE(spawner.destroy(row));
                EXPECT_FALSE(spawner.destroy(row));
            }
        }
        for (const BodyId id : gone) {
            model.erase(id);
        }
        for (int count = 0; count < 12; ++count) {
            const BodyId id = 1 + below(80);
            const bool returns = std::find(gone.begin(), gone.end(), id) != gone.end();
            if (model.count(id) == 0 || (returns && model.count(id) == 0)) {
                model[id] = true;
                spawner.create(record(id));
            }
        }
        ASSERT_EQ(spawner.apply(tables.dynamics), StepFault::none);
        ASSERT_EQ(tables.dynamics.motion.count(), model.size());
        ASSERT_EQ(tables.dynamics.properties.count(), model.size());
        BodyRow row = 0;
        for (const auto& [id, lives] : model) {
            EXPECT_EQ(tables.dynamics.motion[row].id, id) << "seed " << seed;
            const BodyLife& life = tables.dynamics.lives[row];
            EXPECT_EQ(life.spawn_count, id) << "seed " << seed;
            ASSERT_LT(life.body_kind, tables.dynamics.kinds.count());
            EXPECT_EQ(tables.dynamics.properties[row].friction,
                      static_cast<std::int32_t>(1 + id % kKinds));
            ++row;
        }
        // As many as there are different bodies, in the lowest rows.
        BodyKinds fresh(32);
        EXPECT_TRUE(fresh.read(tables.dynamics.kinds, tables.dynamics.lives));
        EXPECT_LE(tables.dynamics.kinds.count(), kKinds);
        EXPECT_TRUE(spawner.created().empty());
    }
}

TEST(Spawner, RenumbersThePairsOfThoseThatStay) {
    Tables tables;
    for (const BodyId id : {10U, 20U, 30U, 40U}) {
        tables.add(id);
    }
    tables.pair(0, 1);
    tables.pair(0, 3);
    tables.pair(1, 2);
    tables.pair(2, 3);
    Spawner spawner(32, 4);
    spawner.destroy(1);
    spawner.create(record(5));
    spawner.create(record(35));
    ASSERT_EQ(spawner.apply(tables.dynamics), StepFault::none);
    // Now 5, 10, 30, 35, 40.
    ASSERT_EQ(tables.dynamics.pairs.count(), 2U);
    EXPECT_EQ(tables.dynamics.pairs[0].row_a, 1U);
    EXPECT_EQ(tables.dynamics.pairs[0].row_b, 4U);
    EXPECT_EQ(tables.dynamics.pairs[1].row_a, 2U);
    EXPECT_EQ(tables.dynamics.pairs[1].row_b, 4U);
}

TEST(Spawner, LeavesTheTablesWholeWhereTheyAreFull) {
    Tables tables;
    for (BodyId id = 1; id <= 31; ++id) {
        tables.add(id);
    }
    Spawner spawner(32, 4);
    spawner.create(record(50));
    spawner.create(record(51));
    EXPECT_EQ(spawner.apply(tables.dynamics), StepFault::bodies_full);
    EXPECT_EQ(tables.dynamics.motion.count(), 31U);
    EXPECT_TRUE(spawner.created().empty());
    spawner.create(record(50));
    spawner.create(record(51));
    spawner.destroy(0);
    EXPECT_EQ(spawner.apply(tables.dynamics), StepFault::none);
    EXPECT_EQ(tables.dynamics.motion.count(), 32U);
}

TEST(Spawner, PutsABodyBackUnderItsOwnId) {
    Tables tables;
    for (const BodyId id : {1U, 2U, 3U}) {
        tables.add(id);
    }
    tables.pair(0, 1);
    tables.pair(0, 2);
    Spawner spawner(32, 4);
    spawner.destroy(1);
    spawner.create(record(2));
    ASSERT_EQ(spawner.apply(tables.dynamics), StepFault::none);
    EXPECT_EQ(tables.dynamics.motion.count(), 3U);
    ASSERT_EQ(tables.dynamics.pairs.count(), 1U) << "what it met at its old place is forgotten";
    EXPECT_EQ(tables.dynamics.pairs[0].row_b, 2U);
}

} // namespace
} // namespace lockwind::test
