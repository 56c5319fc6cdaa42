#include "tests/support/code_scenes.h"

#include "lockwind/hash_tree.h"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <string>

namespace lockwind::test {
namespace {

std::string refusal(const WorldDefinition& definition) {
    const Result<WorldPtr> world = World::create(definition);
    return world ? "" : world.error().message;
}

TEST(WorldCreate, StartsAtTickZeroWithTheScenesBodies) {
    const WorldDefinition scene = busy_scene(10, 2);
    const WorldPtr world = make_world(scene);
    EXPECT_EQ(world->tick(), 0U);
    EXPECT_EQ(world->slot_count(), 2U);
    EXPECT_EQ(world->body_count(), scene.bodies.size());
    EXPECT_TRUE(world->events().empty());
    const std::optional<BodyView> pod = world->pod(1);
    ASSERT_TRUE(pod.has_value());
    EXPECT_EQ(pod->id, 11U);
    EXPECT_EQ(pod->position, scene.bodies.back().position);
    EXPECT_TRUE(world->check().ok());
}

TEST(WorldCreate, BodiesReadBackAsTheyWereDefined) {
    WorldDefinition scene;
    BodyDefinition body = capsule(77, {1, 2, 3}, 0.25, 0.5);
    body.linear_velocity = {1, -2, 3};
    body.mass = 4;
    scene.bodies.push_back(body);
    const WorldPtr world = make_world(scene);
    const std::optional<BodyView> view = world->body(77);
    ASSERT_TRUE(view.has_value());
    EXPECT_EQ(view->mode, BodyMode::dynamic);
    EXPECT_EQ(view->shape.type, ShapeType::capsule);
    EXPECT_EQ(view->shape.radius, Real(0.25));
    EXPECT_EQ(view->shape.half_height, Real(0.5));
    EXPECT_EQ(view->position, body.position);
    EXPECT_EQ(view->linear_velocity, body.linear_velocity);
    EXPECT_NEAR(to_double(view->mass), 4.0, 1e-9);
    EXPECT_FALSE(world->body(78).has_value());
}

TEST(WorldCreate, OrderOfTheDefinitionDoesNotMatter) {
    const WorldDefinition scene = busy_scene(30, 2);
    WorldDefinition reversed = scene;
    std::reverse(reversed.bodies.begin(), reversed.bodies.end());
    const WorldPtr a = make_world(scene);
    const WorldPtr b = make_world(reversed);
    for (int tick = 0; tick < 30; ++tick) {
        ASSERT_EQ(a->state_hash(), b->state_hash()) << tick;
        step_busy(*a);
        step_busy(*b);
    }
    for (BodyRow row = 1; row < a->body_count(); ++row) {
        EXPECT_LT(a->body_at(row - 1).id, a->body_at(row).id);
    }
}

TEST(WorldCreate, AnotherSeedIsAnotherState) {
    WorldDefinition scene = busy_scene(5, 0);
    const std::uint64_t first = make_world(scene)->state_hash();
    scene.settings.seed = 2;
    EXPECT_NE(make_world(scene)->state_hash(), first);
}

struct Case {
    const char* expected; // must be part of the message
    std::function<void(WorldDefinition&)> spoil;
};

TEST(WorldCreate, RefusalsNameWhatIsWrong) {
    constexpr std::uint32_t kHalf = 1U << 31U; // and a number that is allowed: what no Real holds
    const Case cases[] = {
        {"tick_rate_hz is 9; it must be within 10 .. 240",
         [](auto& s) { s.settings.tick_rate_hz = 9; }},
        {"tick_rate_hz", [](auto& s) { s.settings.tick_rate_hz = 241; }},
        {"tick_rate_hz is 2147483708", [](auto& s) { s.settings.tick_rate_hz = kHalf + 60; }},
        {"substeps is 0; it must be within 1 .. 16", [](auto& s) { s.settings.substeps = 0; }},
        {"substeps is 2147483652", [](auto& s) { s.settings.substeps = kHalf + 4; }},
        {"simplified_substeps is 2147483650",
         [](auto& s) { s.settings.level_of_detail.simplified_substeps = kHalf + 2; }},
        {"gravity.y", [](auto& s) { s.settings.gravity.y = -1001; }},
        {"linear_speed_max", [](auto& s) { s.settings.linear_speed_max = 0; }},
        {"angular_speed_max", [](auto& s) { s.settings.angular_speed_max = 1001; }},
        {"bounds is 16001.0; it must be", [](auto& s) { s.settings.bounds = 16001; }},
        {"bounds_policy", [](auto& s) { s.settings.bounds_policy = static_cast<BoundsPolicy>(3); }},
        {"body_capacity of 3 is too small", [](auto& s) { s.settings.body_capacity = 3; }},
        {"body_capacity and joint_capacity must be at most",
         [](auto& s) { s.settings.body_capacity = 2000000; }},
        {"body 100: id is used twice", [](auto& s) { s.bodies[6].id = 100; }},
        {"body 100: position lies outside", [](auto& s) { s.bodies[5].position.x = 101; }},
        {"body 100", [](auto& s) { s.bodies[5].shape.half_extents.x = 0; }},
        {"body 0", [](auto& s) { s.bodies[5].id = 0; }},
        {"pod of slot 0: body 9 is no dynamic body", [](auto& s) { s.pods[0].body = 9; }},
        {"pod of slot 0: body 1 is no dynamic body", [](auto& s) { s.pods[0].body = 1; }},
        {"pod of slot 1: body 10 is also the pod of slot 0", [](auto& s) { s.pods[1].body = 10; }},
        {"pod of slot 1: speed_max is 0.0; it must be within 1.0 .. 400.0 m/s",
         [](auto& s) { s.pods[1].speed_max = 0; }},
        {"thrust_acceleration", [](auto& s) { s.pods[1].thrust_acceleration = -1; }},
        {"turn_rate", [](auto& s) { s.pods[1].turn_rate = 51; }},
        {"jump_speed", [](auto& s) { s.pods[1].jump_speed = 101; }},
        {"ball_speed", [](auto& s) { s.pods[1].ball_speed = 1001; }},
        {"ball_cooldown_ticks", [](auto& s) { s.pods[1].ball_cooldown_ticks = 0; }},
        {"ball_lifetime_ticks", [](auto& s) { s.pods[1].ball_lifetime_ticks = 0; }},
        {"ball_cooldown_ticks", [](auto& s) { s.pods[1].ball_cooldown_ticks = kHalf + 15; }},
        {"ball_lifetime_ticks", [](auto& s) { s.pods[1].ball_lifetime_ticks = kHalf + 600; }},
        {"pod of slot 1: ball", [](auto& s) { s.pods[1].ball_radius = 0; }},
        {"at most 256 can play", [](auto& s) { s.pods.resize(257); }},
    };
    for (const Case& test : cases) {
        WorldDefinition scene = busy_scene(5, 2);
        ASSERT_EQ(refusal(scene), "");
        test.spoil(scene);
        EXPECT_NE(refusal(scene).find(test.expected), std::string::npos)
            << "wanted: " << test.expected << "\ngot: " << refusal(scene);
    }
}

TEST(WorldCreate, AnEmptySceneSteps) {
    const WorldPtr world = make_world({});
    step_idle(*world, 3);
    EXPECT_EQ(world->tick(), 3U);
    EXPECT_EQ(world->body_count(), 0U);
}

} // namespace
} // namespace lockwind::test
