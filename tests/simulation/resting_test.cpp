#include "tests/simulation/measures.h"
#include "world/state.h"

#include <cstring>
#include <gtest/gtest.h>
#include <iostream>

// Piles that sleep, and what a touch does to them.
namespace lockwind::test {
namespace {

/// A tower of boxes beside a heap of balls and capsules that have fallen onto each other, in a
/// trough of four walls about x; bodies `first` + 0 .. 27.
void add_pile(WorldDefinition& scene, BodyId first, double x) {
    for (BodyId wall = 0; wall < 4; ++wall) {
        const double side = wall % 2 == 0 ? -1 : 1;
        const bool along_x = wall < 2;
        BodyDefinition body = box(first + wall,
                                  along_x ? vec(x, 0.5, side * 2.5) : vec(x + side * 2.5, 0.5, 0),
                                  along_x ? Vec3{2.5, 0.5, 0.2} : Vec3{0.2, 0.5, 2.5});
        body.mode = BodyMode::fixed;
        scene.bodies.push_back(body);
    }
    for (BodyId index = 0; index < 24; ++index) {
        const BodyId id = first + 4 + index;
        const Vec3 place = vec(x + static_cast<double>(index % 3) * 1.1 - 1.1,
                               0.6 + static_cast<double>(index / 6) * 0.9,
                               static_cast<double>(index / 3 % 2) * 1.2 - 0.6);
        switch (index % 3) {
        case 0:
            scene.bodies.push_back(box(id, place, {0.4, 0.3, 0.5}));
            break;
        case 1:
            scene.bodies.push_back(sphere(id, place, 0.4));
            break;
        default:
            scene.bodies.push_back(capsule(id, place, 0.3, 0.3));
        }
        scene.bodies.back().friction = 0.6;
    }
}

constexpr BodyId kPileIds = 100;

WorldDefinition piles(int count) {
    WorldDefinition scene;
    scene.settings.body_capacity = 1000;
    scene.bodies.push_back(ground(1));
    for (int pile = 0; pile < count; ++pile) {
        add_pile(scene, kPileIds * static_cast<BodyId>(pile + 1), pile * 12.0);
    }
    return scene;
}

bool is_pile_asleep(const World& world, int pile) {
    const BodyId first = kPileIds * static_cast<BodyId>(pile + 1) + 4;
    for (BodyId id = first; id < first + 24; ++id) {
        if (!world.body(id)->asleep) {
            return false;
        }
    }
    return true;
}

/// A feather: 1 g, let fall from just above the highest body of a pile, so that it comes at less
/// than 1 m/s.
BodyDefinition feather(const World& world, BodyId id, int pile) {
    const BodyId first = kPileIds * static_cast<BodyId>(pile + 1) + 4;
    Vector top;
    for (BodyId each = first; each < first + 24; ++each) {
        const Vector place = vector_of(world.body(each)->position);
        top = place.y > top.y ? place : top;
    }
    BodyDefinition body = sphere(id, vec(top + Vector{0, 0.65, 0}), 0.1);
    body.mass = 0.001;
    return body;
}

TEST(Resting, APileThatALightTouchWakesDoesNotJump) {
    const WorldPtr world = make_world(piles(1));
    const int ticks = ticks_till_asleep(*world, 1200);
    ASSERT_GT(ticks, 0);
    const std::vector<Vector> before = places_of(*world);
    const double potential = energy(*world);
    ASSERT_TRUE(world->create_body(feather(*world, 5000, 0)).ok());
    const double lightly = 0.001 * kGravity * 5;
    bool has_woken = false;
    double most = 0;
    double moved = 0;
    for (int tick = 0; tick < 300; ++tick) {
        step_idle(*world);
        has_woken = has_woken || !is_pile_asleep(*world, 0);
        most = std::max(most, kinetic_energy(*world));
        std::vector<Vector> now = places_of(*world);
        for (std::size_t row = 0; row < before.size(); ++row) {
            moved = std::max(moved, length(now[row] - before[row]));
        }
    }
    std::cout << "asleep after " << ticks << " ticks; woken, it moves " << moved * 1000
              << " mm, with at most " << most << " J of " << potential << " J\n";
    EXPECT_TRUE(has_woken);
    EXPECT_LT(moved, 0.003);
    EXPECT_LT(most, lightly + 1e-7 * potential);
}

TEST(Resting, TwelvePilesSleepAndWakeEachForItself) {
    constexpr int kPiles = 12;
    const WorldPtr world = make_world(piles(kPiles));
    const int ticks = ticks_till_asleep(*world, 1800);
    ASSERT_GT(ticks, 0);
    std::cout << "all asleep after " << ticks << " ticks\n";
    for (const int touched : {3, 0, 11, 7}) {
        std::vector<BodyMotion> before(world->body_count());
        const auto bytes = world->section_bytes(section::kBody);
        std::memcpy(before.data(), bytes.data(), bytes.size());
        ASSERT_TRUE(
            world->create_body(feather(*world, 5000 + static_cast<BodyId>(touched), touched)).ok());
        int woken = 0;
        for (int tick = 0; tick < 90; ++tick) {
            step_idle(*world);
            for (int pile = 0; pile < kPiles; ++pile) {
                const bool asleep = is_pile_asleep(*world, pile);
                woken += pile == touched && !asleep ? 1 : 0;
                ASSERT_TRUE(pile == touched || asleep) << "pile " << pile << " woke too";
            }
        }
        EXPECT_GT(woken, 0) << "pile " << touched;
        const auto* after =
            reinterpret_cast<const BodyMotion*>(world->section_bytes(section::kBody).data());
        const BodyId first = kPileIds * static_cast<BodyId>(touched + 1);
        for (std::size_t row = 0; row < before.size(); ++row) {
            const bool is_touched = before[row].id >= first && before[row].id < first + kPileIds;
            const bool is_feather = before[row].id >= 5000;
            ASSERT_TRUE(is_touched || is_feather ||
                        std::memcmp(&before[row], &after[row], sizeof(BodyMotion)) == 0)
                << "body " << before[row].id << " of a sleeping pile changed";
        }
        ASSERT_GT(ticks_till_asleep(*world, 1800), 0);
    }
}

} // namespace
} // namespace lockwind::test
