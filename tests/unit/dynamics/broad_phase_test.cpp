#include "dynamics/bounds_grid.h"
#include "tests/unit/dynamics/dynamics_bench.h"

#include <random>
#include <set>
#include <utility>

namespace lockwind {
namespace {

using Rows = std::pair<BodyRow, BodyRow>;

std::vector<Rows> rows_of_pairs(DynamicsBench& bench) {
    std::vector<Rows> rows;
    for (const Pair& pair : bench.tables().pairs.rows()) {
        rows.emplace_back(pair.row_a, pair.row_b);
    }
    return rows;
}

/// All overlapping fat bounds with at least one dynamic body, in (row_a, row_b) order.
std::vector<Rows> pairs_by_brute_force(DynamicsBench& bench) {
    std::vector<Rows> rows;
    const auto bounds_of = [&](BodyRow row) {
        const std::int32_t* fat = bench.motion(row).fat_bounds;
        return Bounds{{fat[0], fat[1], fat[2]}, {fat[3], fat[4], fat[5]}};
    };
    const auto is_dynamic = [&](BodyRow row) {
        return bench.properties(row).mode == static_cast<std::uint8_t>(BodyMode::dynamic);
    };
    const std::uint32_t count = bench.state().motion_count;
    for (BodyRow a = 0; a < count; ++a) {
        for (BodyRow b = a + 1; b < count; ++b) {
            if ((is_dynamic(a) || is_dynamic(b)) && overlaps(bounds_of(a), bounds_of(b))) {
                rows.emplace_back(a, b);
            }
        }
    }
    return rows;
}

void fill_with_everything(DynamicsBench& bench) {
    std::mt19937 random(5);
    const auto place = [&](double range) {
        return std::ldexp(static_cast<double>(random()), -32) * 2 * range - range;
    };
    for (int index = 0; index < 120; ++index) {
        const Vec3 position = vec(place(6), 3 + place(3), place(6));
        BodyDefinition body = index % 3 == 0 ? ball(0.3, position) : cube(0.3, position);
        if (index % 10 == 0) {
            body = fixed(cube(0.5, position));
        } else if (index % 10 == 1) {
            body.mode = BodyMode::kinematic;
            body.linear_velocity = vec(place(3), 0, place(3));
        } else {
            body.linear_velocity = vec(place(8), place(8), place(8));
        }
        bench.add(body);
    }
    bench.add(fixed(box(40, 1, 40, vec(0, -1, 0))));
    bench.add(ground());
}

TEST(BroadPhase, PairsAreThoseOfBruteForceAtEveryTick) {
    DynamicsBench bench;
    fill_with_everything(bench);
    std::set<Rows> seen;
    for (int tick = 0; tick < 120; ++tick) {
        bench.step();
        const std::vector<Rows> rows = rows_of_pairs(bench);
        ASSERT_EQ(rows, pairs_by_brute_force(bench)) << "tick " << tick;
        const DynamicsState before = bench.state();
        ASSERT_TRUE(bench.dynamics().derive_pairs(bench.tables()));
        ASSERT_TRUE(same_bits(bench.state(), before)) << "tick " << tick;
        seen.insert(rows.begin(), rows.end());
    }
    EXPECT_GT(seen.size(), rows_of_pairs(bench).size()) << "no pair ever went";
}

TEST(BroadPhase, TightBoundsStayInsideFatOnes) {
    DynamicsBench bench;
    const BodyRow row = bench.add(ball(0.5, vec(1.25, 2, -3)));
    for (int tick = 0; tick < 60; ++tick) {
        ASSERT_EQ(bench.dynamics().broad_phase(bench.tables()), StepFault::none);
        for (int axis = 0; axis < 3; ++axis) {
            const double low = std::ldexp(bench.motion(row).fat_bounds[axis], -16);
            const double high = std::ldexp(bench.motion(row).fat_bounds[3 + axis], -16);
            EXPECT_LE(low, bench.position(row, axis) - 0.5);
            EXPECT_GE(high, bench.position(row, axis) + 0.5);
            EXPECT_LE(high - low, 1 + 2 * (0.05 + 0.5) + 0.001);
        }
        bench.step();
    }
}

TEST(BroadPhase, BodiesAtRestKeepTheirBounds) {
    DynamicsBench bench;
    bench.add(ground());
    const BodyRow row = bench.add(cube(0.5, vec(0, 0.5, 0)));
    bench.run(60);
    const BodyMotion before = bench.motion(row);
    bench.run(60);
    EXPECT_TRUE(std::equal(before.fat_bounds, before.fat_bounds + 6, bench.motion(row).fat_bounds));
}

TEST(BroadPhase, FullPairTableIsToldBeforeAnythingChanges) {
    DynamicsBench bench({}, 64);
    for (int index = 0; index < 64; ++index) {
        bench.add(ball(0.5, vec(0.001 * index, 0, 0)));
    }
    // 64 x 63 / 2 pairs do not fit 16 x 64.
    const DynamicsState before = bench.state();
    EXPECT_EQ(bench.dynamics().broad_phase(bench.tables()), StepFault::pairs_full);
    EXPECT_TRUE(same_bits(before, bench.state()));
}

TEST(BroadPhase, PairsThatPartInFlightEndTheirContact) {
    WorldSettings settings;
    settings.gravity = vec(0, 0, 0);
    DynamicsBench bench(settings);
    const BodyRow a = bench.add(ball(0.5, vec(0, 0, 0)));
    const BodyRow b = bench.add(ball(0.5, vec(1.0, 0, 0)));
    bench.step();
    ASSERT_EQ(bench.dynamics().contact_changes().size(), 1U);
    EXPECT_TRUE(bench.dynamics().contact_changes()[0].begin);
    // Farther in one tick than the bounds are fat: the pair itself goes.
    bench.motion(b).position[0] += std::int64_t{5} << 32;
    bench.step();
    ASSERT_EQ(bench.dynamics().contact_changes().size(), 1U);
    const ContactChange end = bench.dynamics().contact_changes()[0];
    EXPECT_EQ(end.row_a, a);
    EXPECT_EQ(end.row_b, b);
    EXPECT_FALSE(end.begin);
    EXPECT_EQ(bench.state().pair_count, 0U);
    EXPECT_EQ(bench.state().manifold_count, 0U);
}

} // namespace
} // namespace lockwind
