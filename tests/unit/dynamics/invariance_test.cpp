#include "tests/unit/dynamics/dynamics_bench.h"

#include "lockwind/overflow.h"

#include <random>

namespace lockwind {
namespace {

/// A heap of every shape on a floor and a plane, about `centre_x`. `ids` counts on from bench's
/// rows.
void add_heap(DynamicsBench& bench, double centre_x, int seed) {
    std::mt19937 random(static_cast<std::uint32_t>(seed));
    const auto turn = [&] { return real(std::ldexp(static_cast<double>(random()), -31) - 1); };
    BodyDefinition floor = box(20, 1, 20, vec(centre_x, -1, 0));
    bench.add(fixed(floor));
    for (int index = 0; index < 48; ++index) {
        const Vec3 position = vec(centre_x + (index % 4 - 1.5) * 0.9,
                                  0.8 + index / 16 * 0.9,
                                  (index / 4 % 4 - 1.5) * 0.9);
        BodyDefinition body;
        if (index % 3 == 0) {
            body = ball(0.4, position);
        } else if (index % 3 == 1) {
            body = box(0.3, 0.4, 0.5, position);
        } else {
            body = ball(0.25, position);
            body.shape.type = ShapeType::capsule;
            body.shape.half_height = 0.3;
        }
        body.orientation = {turn(), turn(), turn(), real(1.5)};
        body.restitution = index % 5 == 0 ? real(0.6) : 0;
        body.mass = 1 + index % 7;
        bench.add(body);
    }
    BodyDefinition sweeper = box(3, 0.2, 0.2, vec(centre_x, 0.3, 0));
    sweeper.mode = BodyMode::kinematic;
    sweeper.angular_velocity = vec(0, 1, 0);
    bench.add(sweeper);
}

void expect_same_course(const BodyMotion& a, const BodyMotion& b, std::int64_t shift_x) {
    EXPECT_EQ(a.position[0], b.position[0] - (shift_x << 32));
    EXPECT_EQ(a.position[1], b.position[1]);
    EXPECT_EQ(a.position[2], b.position[2]);
    EXPECT_TRUE(std::equal(a.orientation, a.orientation + 4, b.orientation));
    EXPECT_TRUE(std::equal(a.linear_velocity, a.linear_velocity + 3, b.linear_velocity));
    EXPECT_TRUE(std::equal(a.angular_velocity, a.angular_velocity + 3, b.angular_velocity));
    EXPECT_TRUE(std::equal(a.motion_sum, a.motion_sum + 2, b.motion_sum));
}

TEST(Invariance, MovingTheSceneTenKilometresChangesNoBit) {
    DynamicsBench here;
    DynamicsBench there;
    add_heap(here, 0, 1);
    add_heap(there, 10000, 1);
    here.run(240);
    there.run(240);
    ASSERT_GT(here.state().manifold_count, 40U);
    for (BodyRow row = 0; row < here.state().motion_count; ++row) {
        expect_same_course(here.motion(row), there.motion(row), 10000);
    }
    EXPECT_EQ(std::memcmp(here.state().manifolds.data(),
                          there.state().manifolds.data(),
                          here.state().manifolds.size() * sizeof(Manifold)),
              0);
}

TEST(Invariance, FarGroupsMoveAsIfAlone) {
    DynamicsBench together;
    DynamicsBench first;
    DynamicsBench second;
    add_heap(together, 0, 1);
    add_heap(together, 500, 2);
    add_heap(first, 0, 1);
    add_heap(second, 500, 2);
    together.run(240);
    first.run(240);
    second.run(240);
    const std::uint32_t count = first.state().motion_count;
    for (BodyRow row = 0; row < count; ++row) {
        expect_same_course(first.motion(row), together.motion(row), 0);
        expect_same_course(second.motion(row), together.motion(count + row), 0);
    }
}

TEST(Invariance, RestoredTablesRunOnToTheSameBits) {
    DynamicsBench original;
    add_heap(original, 0, 3);
    original.run(97);
    for (int trial = 0; trial < 3; ++trial) {
        const DynamicsState saved = original.state();
        original.run(40);
        DynamicsBench restored;
        restored.state() = saved;
        restored.run(40);
        ASSERT_TRUE(same_bits(original.state(), restored.state()));
        // Back in time in the same object, whose scratch is of another tick.
        restored.state() = saved;
        restored.run(40);
        ASSERT_TRUE(same_bits(original.state(), restored.state()));
    }
}

TEST(Invariance, DroppingDerivedDataChangesNoBit) {
    DynamicsBench kept;
    DynamicsBench dropped;
    add_heap(kept, 0, 4);
    add_heap(dropped, 0, 4);
    std::mt19937 random(9);
    for (int tick = 0; tick < 120; ++tick) {
        if (random() % 3 == 0) {
            dropped.drop_derived();
        }
        if (random() % 10 == 0) {
            dropped.renew();
        }
        kept.step();
        dropped.step();
    }
    EXPECT_TRUE(same_bits(kept.state(), dropped.state()));
}

TEST(Invariance, DroppingEverythingBetweenPhasesChangesNoBit) {
    DynamicsBench kept;
    DynamicsBench dropped;
    add_heap(kept, 0, 4);
    add_heap(dropped, 0, 4);
    for (int tick = 1; tick <= 60; ++tick) {
        kept.step();
        ++dropped.state().tick;
        ASSERT_EQ(dropped.dynamics().broad_phase(dropped.tables()), StepFault::none);
        dropped.renew();
        dropped.drop_derived();
        ASSERT_EQ(dropped.dynamics().narrow_phase(dropped.tables()), StepFault::none);
        dropped.dynamics().wake(dropped.tables());
        dropped.renew();
        dropped.dynamics().solve(dropped.tables());
        dropped.drop_derived();
        dropped.dynamics().restitution(dropped.tables());
        dropped.dynamics().sleep(dropped.tables());
    }
    EXPECT_TRUE(same_bits(kept.state(), dropped.state()));
}

/// Reverses the live slots and leaves a hole in front of them.
void shuffle_slots(DynamicsState& state) {
    const std::vector<Manifold> old = state.manifolds;
    const std::vector<ContactImpulse> borne = state.impulses;
    const std::uint32_t count = state.manifold_count;
    std::fill(state.manifolds.begin(), state.manifolds.end(), Manifold{});
    std::fill(state.impulses.begin(), state.impulses.end(), ContactImpulse{});
    const auto moved_to = [&](std::uint32_t slot) { return 5 + count - 1 - slot; };
    for (std::uint32_t slot = 0; slot < count; ++slot) {
        state.manifolds[moved_to(slot)] = old[slot];
        state.impulses[moved_to(slot)] = borne[slot];
    }
    for (Pair& pair : state.pairs) {
        if (pair.point_count != 0) {
            pair.manifold = moved_to(pair.manifold);
        }
    }
    state.manifold_count = 5 + count;
    state.impulse_count = 5 + count;
}

TEST(Invariance, PlacesOfManifoldsDoNotMatter) {
    DynamicsBench plain;
    add_heap(plain, 0, 5);
    plain.run(60);
    DynamicsBench shuffled;
    shuffled.state() = plain.state();
    shuffle_slots(shuffled.state());
    plain.run(120);
    shuffled.run(120);
    for (BodyRow row = 0; row < plain.state().motion_count; ++row) {
        expect_same_course(plain.motion(row), shuffled.motion(row), 0);
    }
    ASSERT_EQ(plain.state().pair_count, shuffled.state().pair_count);
    for (std::uint32_t index = 0; index < plain.state().pair_count; ++index) {
        const Pair& a = plain.state().pairs[index];
        const Pair& b = shuffled.state().pairs[index];
        ASSERT_EQ(a.point_count, b.point_count);
        if (a.point_count != 0) {
            EXPECT_EQ(std::memcmp(&plain.state().manifolds[a.manifold],
                                  &shuffled.state().manifolds[b.manifold],
                                  sizeof(Manifold)),
                      0);
            EXPECT_EQ(std::memcmp(&plain.state().impulses[a.manifold],
                                  &shuffled.state().impulses[b.manifold],
                                  sizeof(ContactImpulse)),
                      0);
        }
    }
}

/// Deterministic scenes at every rate that settings allow.
TEST(Invariance, EveryRateKeepsAHeapWhole) {
    for (const std::uint32_t rate : {10U, 60U, 240U}) {
        for (const std::uint32_t substeps : {1U, 4U, 16U}) {
            WorldSettings settings;
            settings.tick_rate_hz = rate;
            settings.substeps = substeps;
            DynamicsBench bench(settings);
            add_heap(bench, 0, 6);
            bench.run(static_cast<int>(3 * rate));
            for (BodyRow row = 0; row < bench.state().motion_count; ++row) {
                EXPECT_GT(bench.position(row, 1), -1.5) << rate << " x " << substeps;
                EXPECT_LT(bench.speed(row), 20) << rate << " x " << substeps;
            }
        }
    }
}

void check_tables(DynamicsBench& bench) {
    const DynamicsState& state = bench.state();
    std::vector<int> owners(state.manifolds.size());
    for (std::uint32_t index = 0; index < state.pair_count; ++index) {
        const Pair& pair = state.pairs[index];
        ASSERT_LT(pair.row_a, pair.row_b);
        ASSERT_LT(pair.row_b, state.motion_count);
        ASSERT_EQ(pair.point_count == 0, pair.manifold == kNoIndex);
        if (pair.point_count != 0) {
            const Manifold& manifold = state.manifolds[pair.manifold];
            ++owners[pair.manifold];
            ASSERT_EQ(manifold.point_count, pair.point_count);
            ASSERT_EQ(manifold.row_a, pair.row_a);
            ASSERT_EQ(manifold.row_b, pair.row_b);
        }
    }
    ASSERT_EQ(state.impulse_count, state.manifold_count);
    const Manifold dead{};
    const ContactImpulse none_borne{};
    for (std::size_t slot = 0; slot < state.manifolds.size(); ++slot) {
        const Manifold& manifold = state.manifolds[slot];
        ASSERT_EQ(owners[slot], manifold.point_count != 0 ? 1 : 0);
        if (manifold.point_count == 0) {
            ASSERT_EQ(std::memcmp(&manifold, &dead, sizeof dead), 0);
            ASSERT_EQ(std::memcmp(&state.impulses[slot], &none_borne, sizeof none_borne), 0);
        }
    }
    if (state.manifold_count > 0) {
        EXPECT_NE(state.manifolds[state.manifold_count - 1].point_count, 0);
    }
    for (std::uint32_t index = state.pair_count; index < state.pairs.size(); ++index) {
        const Pair none{};
        ASSERT_EQ(std::memcmp(&state.pairs[index], &none, sizeof none), 0);
    }
}

TEST(Tables, StayWholeInEveryTick) {
    DynamicsBench bench;
    add_heap(bench, 0, 7);
    for (int tick = 0; tick < 120; ++tick) {
        bench.step();
        check_tables(bench);
    }
}

TEST(Tables, RemovingRowsDropsTheirPairsAndRenumbersTheRest) {
    DynamicsBench bench;
    add_heap(bench, 0, 8);
    bench.run(90);
    DynamicsState& state = bench.state();
    const std::uint32_t count = state.motion_count;
    std::vector<BodyRow> new_row(count);
    std::uint32_t kept = 0;
    for (BodyRow row = 0; row < count; ++row) {
        const bool stays = row % 5 != 2;
        new_row[row] = stays ? kept : kNoIndex;
        if (stays) {
            state.motion[kept] = state.motion[row];
            state.properties[kept++] = state.properties[row];
        }
    }
    const std::uint32_t before = state.manifold_count;
    remap_rows(bench.tables(), new_row);
    bench.tables().motion.set_count(kept);
    bench.tables().kinds.set_count(kept);
    check_tables(bench);
    EXPECT_LE(state.manifold_count, before);
    EXPECT_GT(state.manifold_count, 0U);
    for (std::uint32_t index = 1; index < state.pair_count; ++index) {
        const Pair& last = state.pairs[index - 1];
        const Pair& pair = state.pairs[index];
        EXPECT_TRUE(last.row_a < pair.row_a ||
                    (last.row_a == pair.row_a && last.row_b < pair.row_b));
    }
    bench.run(60);
    check_tables(bench);
}

TEST(Tables, FullManifoldTableIsToldAndLeavesThemWhole) {
    WorldSettings settings;
    settings.manifold_capacity = 20;
    DynamicsBench bench(settings, 64);
    add_heap(bench, 0, 9);
    StepFault fault = StepFault::none;
    for (std::uint32_t tick = 1; tick < 200 && fault == StepFault::none; ++tick) {
        ASSERT_EQ(bench.dynamics().broad_phase(bench.tables()), StepFault::none);
        fault = bench.dynamics().narrow_phase(bench.tables());
        bench.dynamics().solve(bench.tables());
        check_tables(bench);
    }
    EXPECT_EQ(fault, StepFault::manifolds_full);
    EXPECT_EQ(bench.state().manifold_count, 20U);
}

TEST(Tables, LowestFreeManifoldIsTakenFirst) {
    DynamicsBench bench({}, 16);
    bench.add(ground());
    for (int index = 0; index < 4; ++index) {
        bench.add(ball(0.5, vec(3 * index, 0.5, 0)));
    }
    bench.step();
    ASSERT_EQ(bench.state().manifold_count, 4U);
    bench.motion(2).linear_velocity[1] = 5 << 20;
    while (bench.state().pairs[1].point_count != 0) {
        bench.step();
    }
    EXPECT_EQ(bench.state().manifold_count, 4U);
    EXPECT_EQ(bench.state().manifolds[1].point_count, 0);
    bench.add(ball(0.5, vec(12, 0.5, 0)));
    bench.step();
    EXPECT_EQ(bench.state().pairs[4].manifold, 1U);
}

/// A single flipped bit anywhere, before any phase, never leads outside the tables.
TEST(Tables, DamageIsContained) {
    if (kChecked) {
        GTEST_SKIP() << "damage overflows, and this build traps that";
    }
    DynamicsBench healthy({}, 64);
    add_heap(healthy, 0, 10);
    healthy.run(60);
    std::mt19937 random(17);
    for (int trial = 0; trial < 400; ++trial) {
        DynamicsBench bench({}, 64);
        bench.state() = healthy.state();
        const auto flip = [&](auto& rows, std::uint32_t count) {
            auto* bytes = reinterpret_cast<std::uint8_t*>(rows.data());
            const std::size_t place = random() % (count * sizeof(rows[0]));
            bytes[place] = static_cast<std::uint8_t>(bytes[place] ^ (1U << random() % 8));
        };
        DynamicsState& state = bench.state();
        const std::uint32_t phase = random() % 4;
        const auto damage = [&](std::uint32_t now) {
            if (now != phase) {
                return;
            }
            switch (random() % 4) {
            case 0:
                flip(state.motion, state.motion_count);
                break;
            case 1:
                flip(state.properties, state.properties_count);
                break;
            case 2:
                flip(state.pairs, state.pair_count);
                break;
            default:
                flip(state.manifolds, state.manifold_count);
                break;
            }
        };
        for (int tick = 0; tick < 3; ++tick) {
            ++state.tick;
            damage(0);
            static_cast<void>(bench.dynamics().broad_phase(bench.tables()));
            damage(1);
            static_cast<void>(bench.dynamics().narrow_phase(bench.tables()));
            damage(2);
            bench.dynamics().solve(bench.tables());
            damage(3);
            bench.dynamics().restitution(bench.tables());
        }
        EXPECT_LE(state.manifold_count, state.manifolds.size());
    }
}

} // namespace
} // namespace lockwind
