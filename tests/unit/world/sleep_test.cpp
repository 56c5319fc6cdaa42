#include "tests/support/code_scenes.h"
#include "world/state.h"

#include "lockwind/world.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <iostream>
#include <vector>

namespace lockwind::test {
namespace {

std::size_t count(const World& world, EventType type) {
    const auto events = world.events();
    return static_cast<std::size_t>(std::count_if(
        events.begin(), events.end(), [type](const Event& event) { return event.type == type; }));
}

bool is_asleep(const World& world, BodyId id) {
    return world.body(id)->asleep;
}

/// Unit boxes one upon another on the ground (body 1), from the lowest: bodies `first` and so on.
void add_stack(WorldDefinition& scene, BodyId first, int boxes, Real x) {
    for (int index = 0; index < boxes; ++index) {
        scene.bodies.push_back(box(
            first + static_cast<BodyId>(index), {x, Real(index) + Real(0.5), 0}, {0.5, 0.5, 0.5}));
    }
}

WorldDefinition stack_scene(int boxes) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    add_stack(scene, 2, boxes, 0);
    return scene;
}

std::vector<std::byte> bytes_of(World& world, std::uint32_t section) {
    const auto bytes = world.section_bytes(section);
    return {bytes.begin(), bytes.end()};
}

TEST(Sleep, AStackSleepsAsOneAfterHalfASecondAndStaysAsItIs) {
    const WorldPtr world = make_world(stack_scene(20));
    std::size_t fell_asleep = 0;
    int ticks = 0;
    while (fell_asleep == 0 && ticks < 180) {
        step_idle(*world);
        ++ticks;
        fell_asleep = count(*world, EventType::fell_asleep);
    }
    std::cout << "asleep after " << ticks << " ticks\n";
    EXPECT_EQ(fell_asleep, 20U); // all in the same tick
    EXPECT_GE(ticks, 30);
    EXPECT_EQ(world->counts().awake, 0U);
    const std::vector<std::byte> bodies = bytes_of(*world, section::kBody);
    const std::vector<std::byte> pairs = bytes_of(*world, section::kPair);
    const std::vector<std::byte> manifolds = bytes_of(*world, section::kManifold);
    step_idle(*world, 600);
    EXPECT_EQ(bytes_of(*world, section::kBody), bodies);
    EXPECT_EQ(bytes_of(*world, section::kPair), pairs);
    EXPECT_EQ(bytes_of(*world, section::kManifold), manifolds);
    EXPECT_EQ(world->counts().awake, 0U);
}

TEST(Sleep, APyramidSleepsWithinThreeSeconds) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    BodyId id = 2;
    for (int row = 0; row < 20; ++row) {
        for (int place = 0; place < 20 - row; ++place) {
            const Real x = Real(place) + Real(row) / Real(2);
            scene.bodies.push_back(box(id++, {x, Real(row) + Real(0.5), 0}, {0.5, 0.5, 0.5}));
        }
    }
    ASSERT_EQ(scene.bodies.size(), 211U);
    const WorldPtr world = make_world(scene);
    const int ticks = ticks_till_asleep(*world, 180);
    std::cout << "asleep after " << ticks << " ticks\n";
    EXPECT_GT(ticks, 0);
}

TEST(Sleep, NobodySleepsWhereItIsSwitchedOff) {
    WorldDefinition scene = stack_scene(3);
    scene.settings.sleep_seconds = 0;
    const WorldPtr world = make_world(scene);
    EXPECT_EQ(ticks_till_asleep(*world, 300), 0);
    EXPECT_EQ(world->counts().awake, 3U);
}

TEST(Sleep, TheSpeedAndTheTimeAreTheSettings) {
    // A sphere that rolls at 0.2 m/s, without anything to slow it.
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(sphere(2, {0, 0.5, 0}, 0.5));
    scene.bodies[1].linear_velocity.x = 0.2;
    scene.bodies[1].angular_velocity.z = -0.4;
    EXPECT_EQ(ticks_till_asleep(*make_world(scene), 300), 0);
    scene.settings.sleep_speed = 0.25;
    scene.settings.sleep_seconds = 2;
    const int ticks = ticks_till_asleep(*make_world(scene), 300);
    EXPECT_GE(ticks, 120);
    EXPECT_LE(ticks, 125);
}

TEST(Sleep, OnlyTheIslandThatRestsSleeps) {
    WorldDefinition scene = stack_scene(3);
    scene.bodies.push_back(sphere(50, {20, 0.5, 0}, 0.5));
    scene.bodies.back().linear_velocity.x = 1;
    scene.bodies.back().angular_velocity.z = -2;
    const WorldPtr world = make_world(scene);
    step_idle(*world, 120);
    EXPECT_EQ(world->counts().awake, 1U);
    EXPECT_FALSE(is_asleep(*world, 50));
    EXPECT_TRUE(is_asleep(*world, 2));
    EXPECT_GT(to_double(world->body(50)->position.x), 21.5); // and the other one moves on
}

TEST(Sleep, ATouchWakesTheWholeIslandInItsTick) {
    WorldDefinition scene = stack_scene(4);
    add_stack(scene, 20, 4, 10); // another one that nothing touches
    const WorldPtr world = make_world(scene);
    ASSERT_GT(ticks_till_asleep(*world, 180), 0);
    ASSERT_TRUE(world->create_body(sphere(60, {0, 6, 0}, 0.5)).ok());
    std::size_t woke = 0;
    for (int tick = 0; tick < 120 && woke == 0; ++tick) {
        step_idle(*world);
        woke = count(*world, EventType::woke);
    }
    EXPECT_EQ(woke, 4U);
    EXPECT_FALSE(is_asleep(*world, 2));
    EXPECT_FALSE(is_asleep(*world, 5));
    EXPECT_TRUE(is_asleep(*world, 20));
    EXPECT_TRUE(is_asleep(*world, 23));
    EXPECT_GT(ticks_till_asleep(*world, 600), 0); // and all come to rest again
}

TEST(Sleep, AnImpulseWakesAndMoves) {
    const WorldPtr world = make_world(stack_scene(1));
    ASSERT_GT(ticks_till_asleep(*world, 180), 0);
    const double mass = to_double(world->body(2)->mass);
    ASSERT_TRUE(world->apply_impulse(2,
                                     {Real::from_raw(std::llround(std::ldexp(3 * mass, 32))), 0, 0},
                                     world->body(2)->position));
    step_idle(*world, 10);
    EXPECT_FALSE(is_asleep(*world, 2));
    EXPECT_GT(to_double(world->body(2)->position.x), 0.1);
}

TEST(Sleep, WhatStoodOnABodyThatGoesFalls) {
    const WorldPtr world = make_world(stack_scene(3));
    ASSERT_GT(ticks_till_asleep(*world, 180), 0);
    ASSERT_TRUE(world->destroy_body(2));
    step_idle(*world, 60);
    EXPECT_NEAR(to_double(world->body(3)->position.y), 0.5, 0.05);
    EXPECT_NEAR(to_double(world->body(4)->position.y), 1.5, 0.05);
}

TEST(Sleep, AFixedBodyThatComesWakesWhatItTouchesAlone) {
    WorldDefinition scene = stack_scene(2);
    add_stack(scene, 10, 1, 5);
    BodyDefinition wall = box(20, {0, 1, 30}, {0.5, 1, 0.5});
    wall.mode = BodyMode::fixed;
    scene.bodies.push_back(wall);
    const WorldPtr world = make_world(scene);
    const auto comes = [&](BodyDefinition body, const Vec3& place, bool is_new) {
        ASSERT_GT(ticks_till_asleep(*world, 300), 0);
        body.position = place;
        ASSERT_TRUE((is_new ? world->create_body(body) : world->redefine_body(body)).ok());
        step_idle(*world);
        EXPECT_EQ(count(*world, EventType::woke), 2U); // the stack, and not the box beside it
        step_idle(*world, 120);
        EXPECT_GT(std::abs(to_double(world->body(2)->position.x)), 0.1);
    };
    comes(wall, {-0.8, 1, 0}, false);
    BodyDefinition step = wall;
    step.id = 21;
    comes(step, world->body(2)->position + Vec3{0.8, 0.5, 0}, true);
}

TEST(Sleep, AMovingPlatformKeepsItsLoadAwake) {
    WorldDefinition scene;
    BodyDefinition platform = box(1, {0, 0, 0}, {5, 0.5, 5});
    platform.mode = BodyMode::kinematic;
    platform.linear_velocity.y = 0.03; // slower than the sleep speed
    scene.bodies.push_back(platform);
    add_stack(scene, 2, 2, 0);
    for (BodyDefinition& body : scene.bodies) {
        body.position.y = body.position.y + Real(0.5);
    }
    scene.bodies[0].position.y = 0;
    const WorldPtr world = make_world(scene);
    EXPECT_EQ(ticks_till_asleep(*world, 240), 0);
    EXPECT_NEAR(to_double(world->body(2)->position.y), 1 + 0.03 * 4, 0.02);
    scene.bodies[0].linear_velocity.y = 0;
    EXPECT_GT(ticks_till_asleep(*make_world(scene), 180), 0);
}

TEST(Sleep, ABodyThatMayNotSleepKeepsItsIslandAwake) {
    WorldDefinition scene = stack_scene(3);
    add_stack(scene, 20, 3, 10);
    scene.bodies[3].can_sleep = false; // the top of the first stack
    const WorldPtr world = make_world(scene);
    step_idle(*world, 300);
    EXPECT_EQ(world->counts().awake, 3U);
    EXPECT_TRUE(is_asleep(*world, 21));
}

TEST(Sleep, ASleepingWorldIsSavedLoadedAndWokenToTheSameBits) {
    const WorldPtr world = make_world(stack_scene(5));
    ASSERT_GT(ticks_till_asleep(*world, 180), 0);
    std::vector<std::byte> bytes;
    world->save(bytes);
    const WorldPtr other = make_world(stack_scene(5));
    ASSERT_TRUE(other->load(bytes).ok());
    EXPECT_EQ(other->counts().awake, 0U);
    for (World* each : {world.get(), other.get()}) {
        ASSERT_TRUE(each->create_body(sphere(60, {0.3, 7, 0}, 0.5)).ok());
    }
    bool woke = false;
    for (int tick = 0; tick < 240; ++tick) {
        step_idle(*world);
        step_idle(*other);
        ASSERT_EQ(world->state_hash(), other->state_hash()) << tick;
        woke = woke || count(*world, EventType::woke) > 0;
    }
    EXPECT_TRUE(woke);
}

TEST(Sleep, RowsMoveWithTheirSleep) {
    // A body between others goes while some sleep and one does not.
    WorldDefinition scene = stack_scene(1);
    add_stack(scene, 10, 2, 10);
    scene.bodies.push_back(sphere(50, {-20, 0.5, 0}, 0.5));
    scene.bodies.back().linear_velocity.x = -1;
    scene.bodies.back().angular_velocity.z = 2;
    const WorldPtr world = make_world(scene);
    step_idle(*world, 120);
    ASSERT_EQ(world->counts().awake, 1U);
    ASSERT_TRUE(world->destroy_body(2));
    step_idle(*world);
    EXPECT_TRUE(is_asleep(*world, 10));
    EXPECT_TRUE(is_asleep(*world, 11));
    EXPECT_FALSE(is_asleep(*world, 50));
}

} // namespace
} // namespace lockwind::test
