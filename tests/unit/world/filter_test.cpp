#include "tests/support/code_scenes.h"

#include "lockwind/world.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

/// Events of the type in which the body takes part, so far in this run.
std::size_t count(const World& world, EventType type, BodyId body) {
    const auto events = world.events();
    return static_cast<std::size_t>(
        std::count_if(events.begin(), events.end(), [&](const Event& event) {
            return event.type == type && (event.a == body || event.b == body);
        }));
}

/// A ball that falls from 4 m through or onto a slab whose top is at 2.5 m.
WorldDefinition slab_scene() {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(box(2, {0, 2, 0}, {2, 0.5, 2}));
    scene.bodies[1].mode = BodyMode::fixed;
    scene.bodies.push_back(sphere(3, {0, 4, 0}, 0.5));
    return scene;
}

double rest_height(const WorldDefinition& scene) {
    const WorldPtr world = make_world(scene);
    step_idle(*world, 240);
    return to_double(world->body(3)->position.y);
}

TEST(Layers, ABodyPassesThroughWhatItsMaskLeavesOut) {
    WorldDefinition scene = slab_scene();
    EXPECT_NEAR(rest_height(scene), 3.0, 0.02);
    scene.bodies[1].layer = 5;
    EXPECT_NEAR(rest_height(scene), 3.0, 0.02);
    scene.bodies[2].mask = ~(1U << 5U);
    EXPECT_NEAR(rest_height(scene), 0.5, 0.02);
}

TEST(Layers, OneSideOfTheMatrixIsEnough) {
    WorldDefinition scene = slab_scene();
    scene.bodies[1].layer = 5;
    scene.bodies[2].layer = 9;
    EXPECT_NEAR(rest_height(scene), 3.0, 0.02);
    scene.settings.layer_masks[5] = ~(1U << 9U);
    EXPECT_NEAR(rest_height(scene), 0.5, 0.02);
    scene.settings.layer_masks[5] = kAllLayers;
    scene.settings.layer_masks[9] = ~(1U << 5U);
    EXPECT_NEAR(rest_height(scene), 0.5, 0.02);
}

TEST(Layers, BodiesOfALayerMayIgnoreEachOther) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    for (BodyId id = 2; id < 6; ++id) {
        scene.bodies.push_back(
            box(id, {0, Real(static_cast<std::uint32_t>(id)), 0}, {0.5, 0.5, 0.5}));
        scene.bodies.back().layer = 1;
    }
    scene.settings.layer_masks[1] = ~(1U << 1U);
    const WorldPtr world = make_world(scene);
    step_idle(*world, 240);
    for (BodyId id = 2; id < 6; ++id) {
        EXPECT_NEAR(to_double(world->body(id)->position.y), 0.5, 0.02) << id;
    }
    EXPECT_EQ(world->counts().pairs, 4U); // with the ground alone
}

TEST(Layers, ALayerOutOfRangeIsRefused) {
    WorldDefinition scene = slab_scene();
    scene.bodies[2].layer = 32;
    const auto world = World::create(scene);
    ASSERT_FALSE(world.ok());
    EXPECT_EQ(world.error().message, "body 3: layer is out of range; it must be within 0 .. 31");
}

TEST(Sensor, TellsWhatOverlapsItAndStopsNothing) {
    WorldDefinition scene = slab_scene();
    scene.bodies[1].sensor = true;
    const WorldPtr world = make_world(scene);
    std::size_t begins = 0;
    std::size_t ends = 0;
    std::size_t others = 0;
    double began_at = 0;
    double ended_at = 0;
    for (int tick = 0; tick < 240; ++tick) {
        step_idle(*world);
        const double height = to_double(world->body(3)->position.y);
        if (count(*world, EventType::sensor_begin, 2) > 0) {
            ++begins;
            began_at = height;
        }
        if (count(*world, EventType::sensor_end, 2) > 0) {
            ++ends;
            ended_at = height;
        }
        others += count(*world, EventType::contact_begin, 2) + count(*world, EventType::hit, 2);
    }
    EXPECT_EQ(begins, 1U);
    EXPECT_EQ(ends, 1U);
    EXPECT_EQ(others, 0U);
    // The ball's lowest point meets the top, its highest leaves the bottom, within a tick's fall.
    EXPECT_NEAR(began_at, 3.0, 0.15);
    EXPECT_NEAR(ended_at, 1.0, 0.2);
    EXPECT_NEAR(to_double(world->body(3)->position.y), 0.5, 0.02);
}

TEST(Sensor, ADynamicOneFallsThroughEverythingAndIsNotSeenByOthers) {
    WorldDefinition scene = slab_scene();
    scene.bodies[2].sensor = true;
    scene.settings.bounds = 100;
    const WorldPtr world = make_world(scene);
    step_idle(*world, 90);
    EXPECT_LT(to_double(world->body(3)->position.y), -3);
}

TEST(Sensor, NeitherWakesNorJoinsIslands) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(box(2, {0, 0.5, 0}, {0.5, 0.5, 0.5}));
    const WorldPtr world = make_world(scene);
    step_idle(*world, 120);
    ASSERT_EQ(world->counts().awake, 0U);
    BodyDefinition probe = sphere(9, {0, 1, 0}, 0.5);
    probe.sensor = true;
    ASSERT_TRUE(world->create_body(probe).ok());
    std::size_t seen = 0;
    for (int tick = 0; tick < 20; ++tick) {
        step_idle(*world);
        seen += count(*world, EventType::sensor_begin, 9);
        EXPECT_TRUE(world->body(2)->asleep);
    }
    EXPECT_GE(seen, 2U); // the ground and the box
}

} // namespace
} // namespace lockwind::test
