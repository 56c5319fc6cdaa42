#include "tests/support/code_scenes.h"
#include "tests/support/dice.h"

#include "lockwind/ccd.h"

#include <cmath>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

Real real(double value) {
    return Real::from_raw(std::llround(std::ldexp(value, 32)));
}

double draw(testing::Dice& dice, double low, double high) {
    return low + (high - low) * static_cast<double>(dice.below(1000001)) / 1e6;
}

WorldDefinition free_space() {
    WorldDefinition scene;
    scene.settings.gravity = {};
    scene.settings.linear_speed_max = 1000;
    scene.settings.angular_speed_max = 200;
    return scene;
}

TEST(FastBodies, AreThoseThatMoveMoreThanHalfTheirSmallestSizeInATick) {
    WorldDefinition scene = free_space();
    scene.bodies.push_back(ground(1));
    const auto add = [&](BodyDefinition body, const Vec3& velocity, const Vec3& spin) {
        body.position = {0, 5, Real(body.id)};
        body.linear_velocity = velocity;
        body.angular_velocity = spin;
        scene.bodies.push_back(body);
    };
    const BodyDefinition rod = box(0, {}, {0.5, 0.05, 0.1}); // 0.1 m across, 0.512 m to its tip
    const auto with_id = [](BodyDefinition body, BodyId id) {
        body.id = id;
        return body;
    };
    // 60 Hz: a ball of 1 m may go 30 m/s, a rod of 0.1 m 3 m/s at its tip.
    add(sphere(30, {}, 0.5), {29.9, 0, 0}, {0, 100, 0});
    add(sphere(20, {}, 0.5), {0, -30.1, 0}, {});
    add(with_id(rod, 21), {0, 0, 2.9}, {});
    add(with_id(rod, 22), {0, 0, 3.1}, {});
    add(with_id(rod, 23), {}, {0, 0, 5.8});
    add(with_id(rod, 24), {}, {0, 0, 5.9});
    BodyDefinition moved = sphere(25, {}, 0.1);
    moved.mode = BodyMode::kinematic;
    add(moved, {100, 0, 0}, {});
    scene.bodies[2].collision_mode = CollisionMode::swept;
    const WorldPtr world = make_world(scene);
    const std::vector<FastBody> fast = world->fast_bodies();
    ASSERT_EQ(fast.size(), 3U);
    EXPECT_EQ(fast[0].body, 20U);
    EXPECT_EQ(fast[0].mode, CollisionMode::swept);
    EXPECT_NEAR(to_double(fast[0].way), 30.1 / 60, 1e-6);
    EXPECT_NEAR(to_double(fast[0].size), 1, 1e-6);
    EXPECT_EQ(fast[1].body, 22U);
    EXPECT_EQ(fast[1].mode, CollisionMode::discrete);
    EXPECT_NEAR(to_double(fast[1].size), 0.1, 1e-6);
    EXPECT_EQ(fast[2].body, 24U);
    EXPECT_NEAR(to_double(fast[2].way), 5.9 * std::sqrt(0.25 + 0.0025 + 0.01) / 60, 1e-5);
}

TEST(FastBodies, NoneWhereAllRest) {
    EXPECT_TRUE(make_world(busy_scene(20, 2))->fast_bodies().empty());
}

/// Shoots a ball or a cube of a size at a wall whose front is at x = 0. Whether it gets behind it.
bool passes(BodyDefinition bullet, double thickness, double speed, double start) {
    WorldDefinition scene = free_space();
    BodyDefinition wall = box(1, {real(thickness / 2), 0, 0}, {real(thickness / 2), 20, 20});
    wall.mode = BodyMode::fixed;
    scene.bodies.push_back(wall);
    bullet.position = {real(start), 0, 0};
    bullet.linear_velocity = {real(speed), 0, 0};
    scene.bodies.push_back(bullet);
    const WorldPtr world = make_world(scene);
    for (int tick = 0; tick < 30; ++tick) {
        step_idle(*world);
        if (to_double(world->body(bullet.id)->position.x) > thickness) {
            return true;
        }
    }
    return false;
}

/// The thinnest that a world takes is 2 cm.
TEST(WallThickness, OfItOrMoreStopsEveryShotAndLessDoesNot) {
    testing::Dice dice(1);
    int passed_thinner = 0;
    for (int shot = 0; shot < 2000; ++shot) {
        const double half = draw(dice, 0.05, 0.5);
        const double speed = draw(dice, 20, 400);
        const BodyDefinition bullet = shot % 2 == 0
                                          ? sphere(2, {}, real(half))
                                          : box(2, {}, {real(half), real(half), real(half)});
        const double least =
            to_double(wall_thickness_min(CollisionMode::discrete, real(2 * half), real(speed), 60));
        const double start = -half - 0.1 - draw(dice, 0, speed / 60);
        EXPECT_FALSE(passes(bullet, std::max(least, 0.02), speed, start))
            << half << " " << speed << " " << start;
        // Just out of the contact's reach, it gets furthest.
        passed_thinner +=
            least > 0.08 && passes(bullet, least - 0.06, speed, -half - 0.021) ? 1 : 0;
        for (const CollisionMode mode :
             {CollisionMode::swept, CollisionMode::continuous, CollisionMode::speculative}) {
            BodyDefinition careful = bullet;
            careful.collision_mode = mode;
            EXPECT_EQ(wall_thickness_min(mode, real(2 * half), real(speed), 60), Real(0));
            EXPECT_FALSE(passes(careful, 0.02, speed, start)) << half << " " << speed;
        }
    }
    EXPECT_GT(passed_thinner, 1000);
}

TEST(WallThickness, FollowsSpeedSizeAndTickRate) {
    const auto least = [](double size, double speed, std::uint32_t rate) {
        return to_double(
            wall_thickness_min(CollisionMode::discrete, real(size), real(speed), rate));
    };
    EXPECT_NEAR(least(0, 1000, 60), 2 * 1000 / 60.0, 1e-6);
    EXPECT_NEAR(least(0.5, 1000, 60), 2 * 1000 / 60.0 - 0.5, 1e-6);
    EXPECT_NEAR(least(0.5, 1000, 240), 2 * 1000 / 240.0 - 0.5, 1e-6);
    EXPECT_EQ(least(0.5, 15, 60), 0); // exactly half its size in a tick
}

/// A ball without bounce at 100 m/s against a wall 3 m off: told once that it touches, once that it
/// hit; what a speculative one foresees is told by nobody, seen by nobody and not in the state.
TEST(CollisionModes, TellATouchWhenThereIsOne) {
    for (std::uint32_t mode = 0; mode < 4; ++mode) {
        WorldDefinition scene = free_space();
        BodyDefinition wall = box(1, {0.5, 0, 0}, {0.5, 5, 5});
        wall.mode = BodyMode::fixed;
        scene.bodies = {wall, sphere(2, {-3.1, 0, 0}, 0.1)};
        scene.bodies[1].linear_velocity.x = 100;
        scene.bodies[1].collision_mode = static_cast<CollisionMode>(mode);
        const WorldPtr world = make_world(scene);
        int begins = 0;
        int hits = 0;
        for (int tick = 1; tick <= 10; ++tick) {
            step_idle(*world);
            const double gap = -0.1 - to_double(world->body(2)->position.x);
            for (const Event& event : world->events()) {
                begins += event.type == EventType::contact_begin ? 1 : 0;
                hits += event.type == EventType::hit ? 1 : 0;
            }
            ASSERT_TRUE(world->check().ok()) << tick;
            if (gap > 0.02) {
                EXPECT_EQ(begins + hits, 0) << tick;
                EXPECT_TRUE(world->contacts().empty());
                EXPECT_EQ(world->counts().manifolds, 0U);
            }
        }
        EXPECT_EQ(begins, 1) << mode;
        EXPECT_EQ(hits, 1) << mode;
    }
}

TEST(CollisionModes, AnUnknownOneIsRefused) {
    WorldDefinition scene = free_space();
    scene.bodies = {sphere(7, {}, 0.1)};
    scene.bodies[0].collision_mode = static_cast<CollisionMode>(4);
    const Result<WorldPtr> world = World::create(scene);
    ASSERT_FALSE(world.ok());
    EXPECT_EQ(world.error().message, "body 7: collision_mode is unknown");
}

} // namespace
} // namespace lockwind::test
