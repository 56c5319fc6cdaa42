#include "tests/support/code_scenes.h"

#include "lockwind/hash_tree.h"

#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

constexpr double kUlp = 1e-5; // of a stored velocity: 2^-20 m/s, and rounding on the way

WorldDefinition weightless() {
    WorldDefinition scene;
    scene.settings.gravity = {0, 0, 0};
    return scene;
}

void expect_near(const Vec3& actual, double x, double y, double z, double tolerance) {
    EXPECT_NEAR(to_double(actual.x), x, tolerance);
    EXPECT_NEAR(to_double(actual.y), y, tolerance);
    EXPECT_NEAR(to_double(actual.z), z, tolerance);
}

TEST(WorldImpulse, ChangesVelocityByItsShareOfTheMass) {
    WorldDefinition scene = weightless();
    BodyDefinition body = sphere(1, {3, 4, 5}, 0.5);
    body.mass = 4;
    scene.bodies.push_back(body);
    const WorldPtr world = make_world(scene);
    ASSERT_TRUE(world->apply_impulse(1, {8, -2, 1}, {3, 4, 5}));
    expect_near(world->body(1)->linear_velocity, 2, -0.5, 0.25, kUlp);
    expect_near(world->body(1)->angular_velocity, 0, 0, 0, kUlp);
    ASSERT_TRUE(world->apply_force(1, {0, 240, 0}, {3, 4, 5}));
    expect_near(world->body(1)->linear_velocity, 2, 0.5, 0.25, kUlp);
}

TEST(WorldImpulse, TurnsASphereByArmTimesImpulseOverInertia) {
    WorldDefinition scene = weightless();
    BodyDefinition body = sphere(1, {0, 0, 0}, 0.5);
    body.mass = 2;
    scene.bodies.push_back(body);
    const WorldPtr world = make_world(scene);
    // I = 2/5 m r^2 = 0.2; r x J = (0.5, 0, 0) x (0, 0.3, 0) = (0, 0, 0.15).
    ASSERT_TRUE(world->apply_impulse(1, {0, 0.3, 0}, {0.5, 0, 0}));
    expect_near(world->body(1)->angular_velocity, 0, 0, 0.75, 1e-4);
}

TEST(WorldImpulse, TurnsATiltedBoxByItsWorldInertia) {
    WorldDefinition scene = weightless();
    BodyDefinition body = box(1, {1, 2, 3}, {0.5, 1, 0.25});
    body.mass = 12;
    // A quarter turn about z: local x is world y, local y is world -x.
    body.orientation = {0, 0, 0.70710678118, 0.70710678118};
    scene.bodies.push_back(body);
    const WorldPtr world = make_world(scene);
    // Local I = m/3 (hy^2 + hz^2, ...) = (4.25, 1.25, 5); in the world (1.25, 4.25, 5).
    ASSERT_TRUE(world->apply_torque(1, {60, 0, 0}));
    expect_near(world->body(1)->angular_velocity, 1 / 1.25, 0, 0, 1e-4);
    ASSERT_TRUE(world->apply_torque(1, {-60, 60, 0}));
    expect_near(world->body(1)->angular_velocity, 0, 1 / 4.25, 0, 1e-4);
    ASSERT_TRUE(world->apply_torque(1, {0, -60, 60}));
    expect_near(world->body(1)->angular_velocity, 0, 0, 1 / 5.0, 1e-4);
}

TEST(WorldImpulse, TurnsTheRightWayFromAnyPoint) {
    const Real far[] = {70000, 3e8, Real::highest()};
    for (const Real distance : far) {
        WorldDefinition scene = weightless();
        scene.bodies.push_back(sphere(1, {-20, 0, 0}, 0.5));
        scene.bodies.push_back(sphere(2, {20, 0, 0}, 0.5));
        const WorldPtr world = make_world(scene);
        ASSERT_TRUE(world->apply_impulse(1, {0, 0.001, 0}, {distance, 0, 0}));
        ASSERT_TRUE(world->apply_force(2, {0, 0.06, 0}, {-distance, 0, 0}));
        EXPECT_GT(world->body(1)->angular_velocity.z, Real(0)) << to_double(distance);
        EXPECT_LT(world->body(2)->angular_velocity.z, Real(0)) << to_double(distance);
    }
}

/// What stands on a lift that is steered goes with it, without a new contact.
TEST(WorldVelocity, SteersAKinematicBodyAndEndsNoContact) {
    WorldDefinition scene;
    BodyDefinition lift = box(1, {0, 0, 0}, {2, 0.5, 2});
    lift.mode = BodyMode::kinematic;
    scene.bodies.push_back(lift);
    scene.bodies.push_back(box(2, {0, 1, 0}, {0.5, 0.5, 0.5}));
    const WorldPtr world = make_world(scene);
    const auto has_contact_event = [&] {
        const auto events = world->events();
        return std::any_of(events.begin(), events.end(), [](const Event& event) {
            return event.type == EventType::contact_begin || event.type == EventType::contact_end;
        });
    };
    step_idle(*world, 120);
    ASSERT_TRUE(world->body(2)->asleep);
    ASSERT_TRUE(world->set_velocity(1, {0, 1.5, 0}, {0, 1, 0}));
    for (int tick = 0; tick < 60; ++tick) {
        step_idle(*world);
        EXPECT_FALSE(has_contact_event()) << tick;
    }
    expect_near(world->body(1)->position, 0, 1.5, 0, 1e-4);
    expect_near(world->body(2)->position, 0, 2.5, 0, 0.01);
    expect_near(world->body(2)->angular_velocity, 0, 1, 0, 0.05);
    ASSERT_TRUE(world->set_velocity(1, {}, {}));
    step_idle(*world, 120);
    expect_near(world->body(1)->position, 0, 1.5, 0, 1e-4);
    EXPECT_TRUE(world->body(2)->asleep);
}

TEST(WorldVelocity, IsHeldToTheLimitsAndOfNoFixedBody) {
    WorldDefinition scene = weightless();
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(sphere(2, {0, 5, 0}, 0.5));
    const WorldPtr world = make_world(scene);
    EXPECT_FALSE(world->set_velocity(1, {1, 0, 0}, {}));
    EXPECT_FALSE(world->set_velocity(3, {1, 0, 0}, {}));
    ASSERT_TRUE(world->set_velocity(2, {1, 2, 3}, {4, 5, 6}));
    expect_near(world->body(2)->linear_velocity, 1, 2, 3, 1e-5);
    expect_near(world->body(2)->angular_velocity, 4, 5, 6, 1e-4);
    const Real huge = Real::highest();
    ASSERT_TRUE(world->set_velocity(2, {Real::lowest(), 0, 0}, {0, 0, huge}));
    expect_near(
        world->body(2)->linear_velocity, -to_double(scene.settings.linear_speed_max), 0, 0, 1e-5);
    EXPECT_TRUE(world->check().ok());
    step_idle(*world, 3);
    EXPECT_TRUE(world->check().ok());
}

TEST(WorldImpulse, MovesNothingButDynamicBodies) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    BodyDefinition platform = box(2, {0, 5, 0}, {1, 1, 1});
    platform.mode = BodyMode::kinematic;
    scene.bodies.push_back(platform);
    const WorldPtr world = make_world(scene);
    const std::uint64_t hash = world->state_hash();
    for (const BodyId id : {1U, 2U, 3U}) {
        EXPECT_FALSE(world->apply_impulse(id, {1, 1, 1}, {}));
        EXPECT_FALSE(world->apply_force(id, {1, 1, 1}, {}));
        EXPECT_FALSE(world->apply_torque(id, {1, 1, 1}));
    }
    EXPECT_EQ(world->state_hash(), hash);
}

TEST(WorldImpulse, AnyForceLeavesAStateThatCanBeStepped) {
    WorldDefinition scene = busy_scene(10, 1);
    const WorldPtr world = make_world(scene);
    const Real huge = Real::highest();
    const Real lowest = Real::lowest();
    for (const Vec3& vector : {Vec3{huge, huge, huge},
                               Vec3{-huge, huge, 1},
                               Vec3{1, 1, -huge},
                               Vec3{lowest, lowest, lowest}}) {
        EXPECT_TRUE(world->apply_impulse(100, vector, {30000, -30000, 30000}));
        EXPECT_TRUE(world->apply_impulse(102, {1, 1, 1}, {vector.x, vector.z, Real::lowest()}));
        EXPECT_TRUE(world->apply_force(103, vector, vector));
        EXPECT_TRUE(world->apply_torque(101, vector));
        EXPECT_TRUE(world->check().ok()) << world->check().error().message;
        step_idle(*world, 3);
        EXPECT_TRUE(world->check().ok());
    }
}

TEST(WorldBodies, CanBeCreatedAndDestroyedBetweenTicks) {
    const WorldPtr world = make_world(busy_scene(10, 1));
    const std::uint64_t start = world->state_hash();
    ASSERT_TRUE(world->create_body(sphere(105000, {0, 20, 0}, 0.5)).ok());
    EXPECT_TRUE(world->body(105000).has_value());
    EXPECT_NE(world->state_hash(), start);
    EXPECT_TRUE(world->destroy_body(105000));
    EXPECT_FALSE(world->destroy_body(105000));
    EXPECT_EQ(world->state_hash(), start);
    EXPECT_TRUE(world->destroy_body(100));
    step_idle(*world, 30);
    EXPECT_TRUE(world->check().ok());
}

TEST(WorldBodies, RefusalsLeaveTheWorldAsItWas) {
    WorldDefinition scene = busy_scene(10, 1);
    scene.settings.body_capacity = static_cast<std::uint32_t>(scene.bodies.size());
    const WorldPtr world = make_world(scene);
    const std::uint64_t start = world->state_hash();
    EXPECT_FALSE(world->create_body(sphere(100, {0, 5, 0}, 0.5)).ok()) << "id in use";
    EXPECT_FALSE(world->create_body(sphere(0, {0, 5, 0}, 0.5)).ok());
    EXPECT_FALSE(world->create_body(sphere(5000, {0, 500, 0}, 0.5)).ok()) << "outside";
    EXPECT_FALSE(world->create_body(sphere(5000, {0, 5, 0}, 0)).ok());
    const Status full = world->create_body(sphere(5000, {0, 5, 0}, 0.5));
    ASSERT_FALSE(full.ok());
    EXPECT_NE(full.error().message.find("body_capacity"), std::string::npos);
    EXPECT_EQ(world->state_hash(), start);
}

TEST(WorldBodies, APodsIdNeverComesBack) {
    const WorldPtr world = make_world(busy_scene(5, 1));
    ASSERT_TRUE(world->destroy_body(10));
    EXPECT_FALSE(world->pod(0).has_value());
    EXPECT_FALSE(world->create_body(sphere(10, {0, 5, 0}, 0.5)).ok());
    for (int tick = 0; tick < 60; ++tick) {
        step_busy(*world); // input for a pod that is gone does nothing
    }
    EXPECT_EQ(world->counts().created_total, 0U);
}

WorldDefinition ray_scene() {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(sphere(2, {0, 2, 10}, 1));
    scene.bodies.push_back(box(3, {0, 2, 20}, {1, 1, 1}));
    scene.bodies.push_back(capsule(4, {0, 2, 30}, 0.5, 1));
    return scene;
}

TEST(WorldRayCast, FindsTheNearestBody) {
    const WorldPtr world = make_world(ray_scene());
    const std::optional<RayHit> hit = world->ray_cast({0, 2, 0}, {0, 2, 40});
    ASSERT_TRUE(hit.has_value());
    EXPECT_EQ(hit->body, 2U);
    EXPECT_NEAR(to_double(hit->fraction), 9.0 / 40, 1e-6);
    expect_near(hit->point, 0, 2, 9, 1e-5);
    expect_near(hit->normal, 0, 0, -1, 1e-5);
    const std::optional<RayHit> back = world->ray_cast({0, 2, 40}, {0, 2, 0});
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(back->body, 4U);
    expect_near(back->point, 0, 2, 30.5, 1e-5);
    expect_near(back->normal, 0, 0, 1, 1e-5);
}

TEST(WorldRayCast, HitsEachShape) {
    const WorldPtr world = make_world(ray_scene());
    EXPECT_EQ(world->ray_cast({3, 5, 3}, {3, -5, 3})->body, 1U);
    expect_near(world->ray_cast({3, 5, 3}, {3, -5, 3})->normal, 0, 1, 0, 1e-6);
    const std::optional<RayHit> on_box = world->ray_cast({0.5, 9, 20.25}, {0.5, 0, 20.25});
    ASSERT_TRUE(on_box.has_value());
    EXPECT_EQ(on_box->body, 3U);
    EXPECT_NEAR(to_double(on_box->fraction), 6.0 / 9, 1e-6);
}

TEST(WorldRayCast, MissesWhatIsBesideOrBehind) {
    const WorldPtr world = make_world(ray_scene());
    EXPECT_FALSE(world->ray_cast({0, 2, 0}, {0, 2, 8.9}).has_value());
    EXPECT_FALSE(world->ray_cast({0, 3.01, 0}, {0, 3.01, 25}).has_value() &&
                 world->ray_cast({0, 3.01, 0}, {0, 3.01, 25})->body == 2);
    EXPECT_FALSE(world->ray_cast({50, 2, 0}, {50, 2, 40}).has_value());
}

TEST(WorldRayCast, TiesGoToTheLowerId) {
    for (const bool swap : {false, true}) {
        WorldDefinition scene;
        scene.bodies.push_back(box(swap ? 9 : 4, {0, 0, 5}, {1, 1, 1}));
        scene.bodies.push_back(box(swap ? 4 : 9, {1.5, 0, 5}, {1, 1, 1}));
        const WorldPtr world = make_world(scene);
        const std::optional<RayHit> hit = world->ray_cast({0.75, 0, 0}, {0.75, 0, 10});
        ASSERT_TRUE(hit.has_value());
        EXPECT_EQ(hit->body, 4U);
    }
}

TEST(WorldRayCast, ChangesNothing) {
    const WorldPtr world = make_world(ray_scene());
    const std::uint64_t hash = world->state_hash();
    static_cast<void>(world->ray_cast({0, 2, 0}, {0, 2, 40}));
    EXPECT_EQ(world->state_hash(), hash);
}

} // namespace
} // namespace lockwind::test
