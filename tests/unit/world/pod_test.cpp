#include "tests/support/code_scenes.h"

#include "lockwind/hash_tree.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

constexpr BodyId kPod = 10;

/// One pod at rest on the ground, looking along +z.
WorldDefinition pod_scene() {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    add_pod(scene, kPod, {0, 0.3, 0});
    scene.bodies.back().friction = 0;
    return scene;
}

void drive(World& world, const PlayerInput& input, int ticks = 1) {
    std::vector<PlayerInput> players(world.slot_count());
    players[0] = input;
    const std::vector<SlotInput> inputs = inputs_of(players);
    for (int tick = 0; tick < ticks; ++tick) {
        const Status status = world.step(inputs);
        ASSERT_TRUE(status.ok()) << status.error().message;
    }
}

TEST(Pod, ThrustAcceleratesAlongItsOwnForward) {
    WorldDefinition scene = pod_scene();
    scene.pods[0].thrust_acceleration = 6;
    scene.pods[0].speed_max = 400;
    const WorldPtr world = make_world(scene);
    drive(*world, {32767, 0, 0}, 30);
    const BodyView pod = *world->pod(0);
    // dv = a (1 - v / v_max) dt: v = v_max (1 - exp(-a t / v_max)).
    const double expected = 400 * (1 - std::exp(-6 * 0.5 / 400));
    EXPECT_NEAR(to_double(pod.linear_velocity.z), expected, 0.01);
    EXPECT_NEAR(to_double(pod.linear_velocity.x), 0, 1e-3);
    drive(*world, {-32767, 0, 0}, 60);
    EXPECT_LT(to_double(world->pod(0)->linear_velocity.z), -2.5);
}

TEST(Pod, HalfAStickGivesHalfTheThrust) {
    WorldDefinition scene = pod_scene();
    scene.pods[0].speed_max = 400;
    const WorldPtr full = make_world(scene);
    const WorldPtr half = make_world(scene);
    drive(*full, {32766, 0, 0}, 1);
    drive(*half, {16383, 0, 0}, 1);
    EXPECT_NEAR(to_double(full->pod(0)->linear_velocity.z),
                2 * to_double(half->pod(0)->linear_velocity.z),
                1e-4);
}

TEST(Pod, ThrustFadesOutAtTopSpeed) {
    const WorldPtr world = make_world(pod_scene());
    double fastest = 0;
    for (int tick = 0; tick < 600; ++tick) {
        drive(*world, {32767, 0, 0});
        fastest = std::max(fastest, to_double(world->pod(0)->linear_velocity.z));
    }
    EXPECT_GT(fastest, 11.5);
    EXPECT_LE(fastest, 12.001);
}

TEST(Pod, TurnsRightOnAPositiveStick) {
    const WorldPtr world = make_world(pod_scene());
    drive(*world, {0, 32767, 0}, 60);
    EXPECT_NEAR(to_double(world->pod(0)->angular_velocity.y), -3.0, 0.05);
    drive(*world, {0, 0, 0}, 60);
    EXPECT_NEAR(to_double(world->pod(0)->angular_velocity.y), 0, 0.01);
    // Half a turn to the right from +z leads to -x.
    const WorldPtr quarter = make_world(pod_scene());
    drive(*quarter, {0, 32767, 0}, 36);
    drive(*quarter, {32767, 0, 0}, 30);
    EXPECT_LT(to_double(quarter->pod(0)->linear_velocity.x), -3.0);
}

TEST(Pod, JumpsOnceAPressAndOnlyFromTheGround) {
    WorldDefinition scene = pod_scene();
    const WorldPtr world = make_world(scene);
    drive(*world, {}, 30);
    drive(*world, {0, 0, PlayerInput::kJump});
    EXPECT_NEAR(to_double(world->pod(0)->linear_velocity.y), 5.0 - 9.81 / 60, 0.02);
    drive(*world, {}, 1);
    const double rising = to_double(world->pod(0)->linear_velocity.y);
    drive(*world, {0, 0, PlayerInput::kJump});
    EXPECT_LT(to_double(world->pod(0)->linear_velocity.y), rising)
        << "nothing to jump off in the air";
    // Held down through the landing, it does not jump again.
    drive(*world, {0, 0, PlayerInput::kJump}, 120);
    EXPECT_NEAR(to_double(world->pod(0)->linear_velocity.y), 0, 0.05);
    drive(*world, {}, 1);
    drive(*world, {0, 0, PlayerInput::kJump});
    EXPECT_GT(to_double(world->pod(0)->linear_velocity.y), 4.0);
}

TEST(Pod, DoesNotJumpOffAWall) {
    WorldDefinition scene = pod_scene();
    scene.settings.gravity = {0, 0, 0};
    scene.bodies.erase(scene.bodies.begin());
    BodyDefinition wall = box(2, {0, 0.3, 1.2}, {2, 2, 0.5});
    wall.mode = BodyMode::fixed;
    scene.bodies.push_back(wall);
    const WorldPtr world = make_world(scene);
    drive(*world, {32767, 0, 0}, 10);
    ASSERT_GT(world->counts().manifolds, 0U);
    drive(*world, {32767, 0, PlayerInput::kJump});
    EXPECT_NEAR(to_double(world->pod(0)->linear_velocity.y), 0, 0.1);
}

/// The world's y of the pod's own y axis.
double uprightness(const World& world) {
    return to_double(rotate(world.pod(0)->orientation, Vec3{0, 1, 0}).y);
}

TEST(Pod, RightsItselfFromAnyTilt) {
    const RealQuat tilts[] = {
        {0, 0, 0.6, 0.8}, {1, 0, 0, 0}, {0, 0, 1, 0}, {0.7, 0, 0.7, 0}, {0.9, 0.1, 0.3, 0.1}};
    for (const RealQuat& tilt : tilts) {
        WorldDefinition scene = pod_scene();
        scene.bodies[1].position = {0, 5, 0};
        scene.bodies[1].orientation = tilt;
        scene.bodies[1].angular_velocity = {2, 1, -3};
        const WorldPtr world = make_world(scene);
        drive(*world, {}, 240);
        EXPECT_GT(uprightness(*world), 0.999);
        const Vec3 spin = world->pod(0)->angular_velocity;
        EXPECT_LT(to_double(length(spin)), 0.1);
    }
}

/// Shoots away from everything.
WorldDefinition shooting_scene() {
    WorldDefinition scene = pod_scene();
    scene.settings.gravity = {0, 0, 0};
    scene.bodies.erase(scene.bodies.begin());
    return scene;
}

TEST(Pod, ShootsABallAheadAtItsSpeedPlusTheBalls) {
    WorldDefinition scene = shooting_scene();
    scene.bodies[0].linear_velocity = {1, 2, 3};
    const WorldPtr world = make_world(scene);
    drive(*world, {0, 0, PlayerInput::kShoot});
    ASSERT_EQ(world->body_count(), 2U);
    const BodyView ball = world->body_at(1);
    EXPECT_EQ(ball.id, (kPod << 32U) + 1);
    ASSERT_EQ(world->events().size(), 1U);
    EXPECT_EQ(world->events()[0], (Event{EventType::created, ball.id, kPod, 0}));
    const Vec3 relative = ball.linear_velocity - Vec3{1, 2, 3};
    EXPECT_NEAR(to_double(length(relative)), 20.0, 1e-3);
    EXPECT_GT(to_double(relative.z), 19.9);
    EXPECT_NEAR(to_double(ball.shape.radius), 0.2, 1e-6);
    const double distance = to_double(length(ball.position - world->pod(0)->position));
    const double reach = std::sqrt(0.5 * 0.5 + 0.3 * 0.3 + 0.7 * 0.7) + 0.2 + 0.05;
    EXPECT_NEAR(distance, reach, 1e-4);
    // The pod is not touched by its own shot.
    EXPECT_EQ(world->counts().contacts, 0U);
}

TEST(Pod, ShotsSpreadByTheSeed) {
    WorldDefinition scene = shooting_scene();
    const WorldPtr world = make_world(scene);
    drive(*world, {0, 0, PlayerInput::kShoot}, 11);
    ASSERT_EQ(world->body_count(), 3U);
    const Vec3 first = world->body_at(1).linear_velocity;
    EXPECT_NE(first, world->body_at(2).linear_velocity);
    scene.settings.seed = 2;
    const WorldPtr other = make_world(scene);
    drive(*other, {0, 0, PlayerInput::kShoot});
    EXPECT_NE(other->body_at(1).linear_velocity, first);
}

TEST(Pod, HeldTriggerShootsOnceACooldown) {
    const WorldPtr world = make_world(shooting_scene());
    std::vector<Tick> shots;
    for (int tick = 0; tick < 45; ++tick) {
        drive(*world, {0, 0, PlayerInput::kShoot});
        if (!world->events().empty()) {
            shots.push_back(world->tick());
        }
    }
    EXPECT_EQ(shots, (std::vector<Tick>{1, 11, 21, 31, 41}));
}

TEST(Pod, BallsVanishAfterTheirLifetime) {
    WorldDefinition scene = shooting_scene();
    scene.pods[0].ball_lifetime_ticks = 30;
    const WorldPtr world = make_world(scene);
    drive(*world, {0, 0, PlayerInput::kShoot});
    drive(*world, {}, 29);
    EXPECT_EQ(world->body_count(), 2U);
    drive(*world, {});
    EXPECT_EQ(world->body_count(), 1U);
    EXPECT_EQ(world->events()[0], (Event{EventType::destroyed, (kPod << 32U) + 1, 0, 0}));
}

TEST(Pod, IdsOfBallsAreNeverReused) {
    WorldDefinition scene = shooting_scene();
    scene.pods[0].ball_lifetime_ticks = 5;
    const WorldPtr world = make_world(scene);
    BodyId last = 0;
    for (int tick = 0; tick < 100; ++tick) {
        drive(*world, {0, 0, PlayerInput::kShoot});
        for (const Event& event : world->events()) {
            if (event.type == EventType::created) {
                EXPECT_GT(event.a, last);
                last = event.a;
            }
        }
    }
    EXPECT_EQ(last, (kPod << 32U) + 10);
}

TEST(Pod, ScoresWhenItsBallHitsAnotherPod) {
    WorldDefinition scene = shooting_scene();
    add_pod(scene, 20, {0, 0.3, 4});
    const WorldPtr world = make_world(scene);
    std::vector<Event> events;
    for (int tick = 0; tick < 30; ++tick) {
        drive(*world, {0, 0, tick == 0 ? PlayerInput::kShoot : std::uint16_t{0}});
        events.insert(events.end(), world->events().begin(), world->events().end());
    }
    EXPECT_EQ(world->score(0), 1U);
    EXPECT_EQ(world->score(1), 0U);
    EXPECT_EQ(world->body_count(), 2U) << "the ball is spent";
    EXPECT_EQ(std::count(events.begin(), events.end(), Event{EventType::score, 10, 20, 1}), 1);
    EXPECT_EQ(std::count(events.begin(),
                         events.end(),
                         Event{EventType::destroyed, (kPod << 32U) + 1, 0, 0}),
              1);
}

TEST(Pod, DoesNotScoreOnItself) {
    WorldDefinition scene = shooting_scene();
    scene.pods[0].ball_speed = 5;
    const WorldPtr world = make_world(scene);
    drive(*world, {0, 0, PlayerInput::kShoot});
    world->apply_impulse(kPod, {0, 0, 60000}, world->pod(0)->position); // it overtakes its ball
    drive(*world, {}, 30);
    EXPECT_EQ(world->score(0), 0U);
    EXPECT_EQ(world->body_count(), 2U);
}

TEST(Pod, ReturnsToItsStartWhenItLeavesTheBounds) {
    WorldDefinition scene = pod_scene();
    scene.settings.bounds = 20;
    const WorldPtr world = make_world(scene);
    drive(*world, {0, 0, PlayerInput::kShoot}, 3);
    const Vec3 start = scene.bodies[1].position;
    world->apply_impulse(kPod, {0, 1000000, 0}, world->pod(0)->position);
    bool returned = false;
    for (int tick = 0; tick < 60 && !returned; ++tick) {
        drive(*world, {});
        for (const Event& event : world->events()) {
            returned = returned || event == Event{EventType::respawned, kPod, 0, 0};
        }
    }
    ASSERT_TRUE(returned);
    EXPECT_EQ(world->pod(0)->position, start);
    EXPECT_EQ(world->pod(0)->linear_velocity, Vec3{});
    drive(*world, {}, 10); // the cooldown passes
    drive(*world, {0, 0, PlayerInput::kShoot});
    EXPECT_TRUE(world->body((kPod << 32U) + 2).has_value()) << "its count of balls goes on";
}

} // namespace
} // namespace lockwind::test
