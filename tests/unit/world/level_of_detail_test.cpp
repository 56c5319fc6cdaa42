#include "dynamics/body.h"
#include "tests/support/code_scenes.h"
#include "world/state.h"

#include "lockwind/world.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <map>
#include <vector>

namespace lockwind::test {
namespace {

constexpr BodyId kPod = 2;

/// Pods that glide over the ground (body 1) at a velocity, and nothing else yet.
WorldDefinition pod_scene(Real full_within, Real simplified_within, const Vec3& velocity) {
    WorldDefinition scene;
    scene.settings.level_of_detail = {true, full_within, simplified_within, 2};
    scene.bodies.push_back(ground(1));
    add_pod(scene, kPod, {0, 0.3, 0});
    scene.bodies.back().friction = 0;
    scene.bodies.back().linear_velocity = velocity;
    return scene;
}

/// Three boxes on the ground, one upon another, that never sleep.
void add_stack(WorldDefinition& scene, BodyId first, const Vec3& place) {
    for (int index = 0; index < 3; ++index) {
        const Vec3 up{0, Real(index) + Real(0.5), 0};
        scene.bodies.push_back(
            box(first + static_cast<BodyId>(index), place + up, {0.5, 0.5, 0.5}));
        scene.bodies.back().can_sleep = false;
    }
}

/// A chain of bars from a post, along z, that swings.
void add_chain(WorldDefinition& scene, BodyId first, const Vec3& place) {
    BodyDefinition post = box(first, place, {0.1, 0.1, 0.1});
    post.mode = BodyMode::fixed;
    scene.bodies.push_back(post);
    for (BodyId link = 1; link <= 6; ++link) {
        const Vec3 along{0, 0, Real(static_cast<std::int64_t>(link))};
        scene.bodies.push_back(box(first + link, place + along, {0.05, 0.05, 0.4}));
        JointDefinition joint;
        joint.id = first + link;
        joint.body_a = first + link - 1;
        joint.body_b = first + link;
        joint.anchor_a = {0, 0, 0.5};
        joint.anchor_b = {0, 0, -0.5};
        scene.joints.push_back(joint);
    }
}

BodyLevel level_of(const World& world, BodyId id) {
    return world.body(id)->level;
}

/// What moves of a body.
struct Motion {
    Vec3 position;
    RealQuat orientation;
    Vec3 linear_velocity;
    Vec3 angular_velocity;
    bool operator==(const Motion&) const = default;
};

Motion motion_of(const World& world, BodyId id) {
    const BodyView body = *world.body(id);
    return {body.position, body.orientation, body.linear_velocity, body.angular_velocity};
}

template <class Row>
Row* rows(World& world, std::uint32_t section) {
    return reinterpret_cast<Row*>(world.section_bytes(section).data());
}

/// m from the pod's centre to the surface of a ball of radius 2.
double gap(const World& world, BodyId ball) {
    const Vec3 apart = world.body(ball)->position - world.body(kPod)->position;
    return to_double(length(apart)) - 2;
}

TEST(LevelOfDetail, ABallGoesDownATenthBeyondWhereItComesUp) {
    WorldDefinition scene = pod_scene(40, 80, {60, 0, 0});
    scene.bodies.push_back(sphere(10, {150, 2, 4}, 2));
    scene.bodies.back().can_sleep = false;
    scene.bodies.push_back(sphere(11, {0, 2, 30}, 2));
    scene.bodies.back().can_sleep = false;
    const WorldPtr world = make_world(scene);
    std::vector<std::vector<double>> changes(2);
    std::vector<BodyLevel> levels{BodyLevel::frozen, BodyLevel::full};
    for (int tick = 0; tick < 300; ++tick) {
        step_idle(*world);
        for (BodyId ball = 0; ball < 2; ++ball) {
            const BodyLevel level = level_of(*world, 10 + ball);
            if (level != levels[ball]) {
                changes[ball].push_back(gap(*world, 10 + ball));
                levels[ball] = level;
            }
        }
    }
    // Levels change at the first tick's end beyond the border, and the pod goes 1 m a tick.
    ASSERT_EQ(changes[0].size(), 4U);
    EXPECT_NEAR(changes[0][0], 79.5, 0.5);
    EXPECT_NEAR(changes[0][1], 39.5, 0.5);
    EXPECT_NEAR(changes[0][2], 44.5, 0.5);
    EXPECT_NEAR(changes[0][3], 88.5, 0.5);
    ASSERT_EQ(changes[1].size(), 2U);
    EXPECT_NEAR(changes[1][0], 44.5, 0.5);
    EXPECT_NEAR(changes[1][1], 88.5, 0.5);
}

/// Bodies at full detail and frozen ones alone: in its n-th tick awake a body is where it is at
/// tick n of a world without levels.
TEST(LevelOfDetail, WhatThawsGoesOnAsIfNoTimeHadPassed) {
    WorldDefinition scene = pod_scene(100, 100, {60, 0, 0});
    scene.bodies.push_back(sphere(10, {300, 60, 0}, 0.5)); // falls
    scene.bodies.back().angular_velocity = {1, 2, 3};
    add_chain(scene, 20, {300, 10, 5});
    add_stack(scene, 30, {300, 0, -5});
    scene.bodies.back().linear_velocity.x = 1;
    const WorldPtr world = make_world(scene);
    scene.settings.level_of_detail.enabled = false;
    const WorldPtr usual = make_world(scene);
    std::map<BodyId, std::size_t> ticks_awake;
    for (const BodyDefinition& body : scene.bodies) {
        if (body.mode == BodyMode::dynamic && body.id != kPod) {
            ticks_awake[body.id] = 0;
        }
    }
    std::vector<std::map<BodyId, Motion>> history;
    std::size_t ticks_frozen = 0;
    for (int tick = 0; tick < 600; ++tick) {
        std::map<BodyId, Motion>& now = history.emplace_back();
        for (const auto& [id, ticks] : ticks_awake) {
            now[id] = motion_of(*usual, id);
        }
        for (auto& [id, ticks] : ticks_awake) {
            ASSERT_EQ(motion_of(*world, id), history[ticks][id]) << id << " at tick " << tick;
            const bool frozen = level_of(*world, id) == BodyLevel::frozen;
            ticks += frozen ? 0 : 1;
            ticks_frozen += frozen ? 1 : 0;
        }
        step_idle(*world);
        step_idle(*usual);
    }
    for (const auto& [id, ticks] : ticks_awake) {
        EXPECT_GT(ticks, 150U) << id; // 210 m at 1 m a tick, less for the ball above
        EXPECT_LT(ticks, 240U) << id;
        EXPECT_EQ(level_of(*world, id), BodyLevel::frozen) << id; // the pod is gone again
        EXPECT_GT(to_double(length(world->body(id)->linear_velocity)), 0) << id;
    }
    EXPECT_GT(ticks_frozen, 3000U);
    const auto events = world->events();
    EXPECT_TRUE(events.empty());
}

TEST(LevelOfDetail, SimplifiedIsAWorldOfFewerSubstepsAndDiscreteCollision) {
    WorldDefinition scene = pod_scene(1, 1000, {});
    scene.settings.sleep_seconds = 0;
    for (BodyId id = 10; id < 30; ++id) {
        const Real up(static_cast<std::int64_t>(id - 9));
        BodyDefinition body = id % 2 == 0 ? box(id, {100, up, up / Real(16)}, {0.4, 0.3, 0.5})
                                          : sphere(id, {100, up, 0}, 0.4);
        body.restitution = 0.3;
        body.substeps = id == 20 ? 8 : 0;
        scene.bodies.push_back(body);
    }
    add_chain(scene, 40, {110, 8, 0});
    add_bullets(scene, 50, {150, 8, 0});
    const WorldPtr world = make_world(scene);
    scene.settings.level_of_detail.enabled = false;
    scene.settings.substeps = 2;
    for (BodyDefinition& body : scene.bodies) {
        body.substeps = 0;
        body.collision_mode = CollisionMode::discrete;
    }
    const WorldPtr coarse = make_world(scene);
    const auto* motion = rows<BodyMotion>(*world, section::kBody);
    auto* sleep = rows<BodySleep>(*world, section::kBodySleep);
    for (BodyRow row = 0; row < world->body_count(); ++row) {
        const bool is_far = world->body_at(row).mode == BodyMode::dynamic && motion[row].id != kPod;
        set_level(sleep[row], is_far ? BodyLevel::simplified : BodyLevel::full);
    }
    for (int tick = 1; tick <= 240; ++tick) {
        step_idle(*world);
        step_idle(*coarse);
        for (const BodyDefinition& body : scene.bodies) {
            if (body.mode == BodyMode::dynamic && body.id != kPod) {
                ASSERT_EQ(motion_of(*world, body.id), motion_of(*coarse, body.id))
                    << body.id << " at tick " << tick;
                ASSERT_EQ(level_of(*world, body.id), BodyLevel::simplified);
            }
        }
    }
    EXPECT_EQ(level_of(*world, kPod), BodyLevel::full);
}

TEST(LevelOfDetail, WithoutPlayersOrWithinReachNothingChanges) {
    for (const std::uint32_t pods : {0U, 2U}) {
        WorldDefinition scene = scene_of_all(40, pods);
        const WorldPtr usual = make_world(scene);
        const Real within = pods == 0 ? Real(1) : Real(1000);
        scene.settings.level_of_detail = {true, within, within, 1};
        const WorldPtr world = make_world(scene);
        for (int tick = 0; tick < 240; ++tick) {
            step_busy(*usual);
            step_busy(*world);
            ASSERT_EQ(world->state_hash(), usual->state_hash()) << tick;
        }
    }
}

TEST(LevelOfDetail, WhenThePlayersAreGoneAllComesBack) {
    WorldDefinition scene = pod_scene(50, 200, {});
    add_stack(scene, 10, {100, 0, 0});
    add_stack(scene, 20, {300, 0, 0});
    const WorldPtr world = make_world(scene);
    step_idle(*world);
    EXPECT_EQ(level_of(*world, 10), BodyLevel::simplified);
    EXPECT_EQ(level_of(*world, 20), BodyLevel::frozen);
    ASSERT_TRUE(world->destroy_body(kPod));
    step_idle(*world);
    EXPECT_EQ(level_of(*world, 10), BodyLevel::full);
    EXPECT_EQ(level_of(*world, 20), BodyLevel::full);
}

TEST(LevelOfDetail, AnIslandHasTheLevelOfItsNearestBody) {
    // Chains whose links are 1 m apart along the way of the pod, which goes 1 m a tick.
    WorldDefinition scene = pod_scene(50, 100, {0, 0, 60});
    add_chain(scene, 10, {0, 10, 150});
    add_chain(scene, 30, {5, 10, 160});
    const WorldPtr world = make_world(scene);
    std::vector<int> changes(2);
    for (int tick = 0; tick < 330; ++tick) {
        const BodyLevel before[] = {level_of(*world, 11), level_of(*world, 31)};
        step_idle(*world);
        for (BodyId chain = 0; chain < 2; ++chain) {
            const BodyId first = 11 + 20 * chain;
            for (BodyId link = 1; link < 6; ++link) {
                ASSERT_EQ(level_of(*world, first + link), level_of(*world, first)) << tick;
            }
            changes[chain] += level_of(*world, first) != before[chain] ? 1 : 0;
        }
    }
    for (const int count : changes) {
        EXPECT_EQ(count, 5); // down to frozen at once, then up twice and down twice
    }
}

TEST(LevelOfDetail, ATouchThawsTheWholeIslandWithoutAnEvent) {
    WorldDefinition scene = pod_scene(50, 100, {});
    add_stack(scene, 10, {111.5, 0, 0});
    add_stack(scene, 20, {111.5, 0, 20});
    scene.bodies.push_back(sphere(30, {106, 1, 0}, 1));
    scene.bodies.back().friction = 0;
    scene.bodies.back().linear_velocity.x = 6;
    const WorldPtr world = make_world(scene);
    step_idle(*world);
    for (const BodyId id : {10U, 11U, 12U, 20U, 21U, 22U}) {
        ASSERT_EQ(level_of(*world, id), BodyLevel::frozen) << id;
    }
    int ticks = 0;
    while (level_of(*world, 10) == BodyLevel::frozen && ticks < 120) {
        step_idle(*world);
        ++ticks;
        for (const Event& event : world->events()) {
            EXPECT_NE(event.type, EventType::woke);
        }
    }
    EXPECT_NEAR(ticks, 40, 5); // 4 m at 6 m/s
    for (const BodyId id : {10U, 11U, 12U}) {
        EXPECT_EQ(level_of(*world, id), BodyLevel::simplified) << id;
        EXPECT_EQ(level_of(*world, id + 10), BodyLevel::frozen) << id;
    }
    step_idle(*world, 30);
    EXPECT_GT(to_double(world->body(11)->position.x), 111.55);
}

TEST(LevelOfDetail, AnImpulseThawsAnIslandForItsTick) {
    WorldDefinition scene = pod_scene(50, 100, {});
    scene.settings.gravity = {};
    add_chain(scene, 10, {0, 10, 300});
    for (BodyId link = 1; link <= 6; ++link) {
        scene.bodies[scene.bodies.size() - link].linear_velocity.x = 0.6;
    }
    const WorldPtr world = make_world(scene);
    step_idle(*world, 10);
    const Motion first = motion_of(*world, 11);
    const Motion last = motion_of(*world, 16);
    step_idle(*world, 10);
    ASSERT_EQ(motion_of(*world, 11), first);
    const Vec3 change{0, 3, 0};
    ASSERT_TRUE(world->apply_impulse(16, change * world->body(16)->mass, last.position));
    step_idle(*world);
    const Motion thawed = motion_of(*world, 16);
    EXPECT_GT(to_double(motion_of(*world, 11).position.x - first.position.x), 0.005);
    EXPECT_GT(to_double(thawed.position.y - last.position.y), 0.02); // less than 3 m/s / 60
    EXPECT_GT(to_double(thawed.linear_velocity.y), 1);
    EXPECT_EQ(level_of(*world, 16), BodyLevel::frozen);
    step_idle(*world, 10);
    EXPECT_EQ(motion_of(*world, 16), thawed);
}

TEST(LevelOfDetail, AJointThawsWhatItJoins) {
    WorldDefinition scene = pod_scene(50, 100, {});
    scene.settings.gravity = {};
    for (BodyId id = 10; id < 13; ++id) {
        const Real along(static_cast<std::int64_t>(id));
        scene.bodies.push_back(sphere(id, {300 + along, 5, 0}, 0.2));
        scene.bodies.back().linear_velocity.z = 0.6;
    }
    const WorldPtr world = make_world(scene);
    step_idle(*world, 10);
    EXPECT_NEAR(to_double(world->body(10)->position.z), 0.01, 1e-4);
    JointDefinition joint;
    joint.id = 1;
    joint.body_a = 10;
    joint.body_b = 11;
    joint.anchor_a = {0.5, 0, 0};
    joint.anchor_b = {-0.5, 0, 0};
    ASSERT_TRUE(world->create_joint(joint).ok());
    step_idle(*world, 10);
    EXPECT_NEAR(to_double(world->body(10)->position.z), 0.02, 1e-4);
    EXPECT_NEAR(to_double(world->body(11)->position.z), 0.02, 1e-4);
    EXPECT_NEAR(to_double(world->body(12)->position.z), 0.01, 1e-4);
}

TEST(LevelOfDetail, AKinematicPlatformStopsAndGoesOnWithItsLoad) {
    WorldDefinition scene = pod_scene(50, 100, {60, 0, 0});
    BodyDefinition platform = box(10, {250, 5, 0}, {4, 0.5, 4});
    platform.mode = BodyMode::kinematic;
    platform.linear_velocity.y = 1;
    scene.bodies.push_back(platform);
    add_stack(scene, 11, {250, 5.5, 0});
    const WorldPtr world = make_world(scene);
    int ticks_frozen = 0;
    for (int tick = 0; tick < 480; ++tick) {
        step_idle(*world);
        const double height = to_double(world->body(10)->position.y);
        for (const BodyId id : {11U, 12U, 13U}) {
            ASSERT_EQ(level_of(*world, id), level_of(*world, 10)) << tick;
            ASSERT_NEAR(
                to_double(world->body(id)->position.y) - height, static_cast<double>(id) - 10, 0.03)
                << tick;
        }
        ticks_frozen += level_of(*world, 10) == BodyLevel::frozen ? 1 : 0;
    }
    EXPECT_GT(ticks_frozen, 200);
    EXPECT_LT(ticks_frozen, 300);
    EXPECT_NEAR(to_double(world->body(10)->position.y), 5 + (480 - ticks_frozen) / 60.0, 0.02);
}

TEST(LevelOfDetail, ATouchThawsAPlatformWithItsLoad) {
    WorldDefinition scene = pod_scene(50, 100, {});
    BodyDefinition platform = box(10, {117, 5, 0}, {4, 0.5, 4});
    platform.mode = BodyMode::kinematic;
    platform.linear_velocity.y = 1;
    scene.bodies.push_back(platform);
    add_stack(scene, 11, {117, 5.5, 0});
    scene.bodies.push_back(sphere(20, {104, 6.2, 0}, 3));
    scene.bodies.back().linear_velocity.x = 12;
    const WorldPtr world = make_world(scene);
    step_idle(*world);
    ASSERT_EQ(level_of(*world, 10), BodyLevel::frozen);
    ASSERT_EQ(level_of(*world, 20), BodyLevel::simplified);
    int ticks = 0;
    while (level_of(*world, 10) == BodyLevel::frozen && ticks < 60) {
        step_idle(*world);
        ++ticks;
    }
    EXPECT_NEAR(ticks, 30, 5); // 6 m at 12 m/s
    for (const BodyId id : {10U, 11U, 12U, 13U}) {
        EXPECT_EQ(level_of(*world, id), BodyLevel::simplified) << id;
    }
}

TEST(LevelOfDetail, FrozenBodiesAreNotGoneOver) {
    WorldDefinition scene = pod_scene(50, 100, {});
    scene.settings.gravity = {};
    for (BodyId id = 10; id < 310; ++id) {
        const Real along(static_cast<std::int64_t>(id));
        scene.bodies.push_back(sphere(id, {300 + along, 50, 0}, 0.6)); // each touches the next
    }
    const WorldPtr world = make_world(scene);
    EXPECT_EQ(world->counts().awake, 301U);
    step_idle(*world, 2);
    EXPECT_EQ(world->counts().awake, 1U);
    const auto bytes_of = [&](std::uint32_t section) {
        // The pod, row 1, counts how long it has been still.
        const std::size_t skipped = section == section::kBodySleep ? 2 * sizeof(BodySleep) : 0;
        const auto bytes = world->section_bytes(section).subspan(skipped);
        return std::vector<std::byte>(bytes.begin(), bytes.end());
    };
    const auto pairs = bytes_of(section::kPair);
    const auto manifolds = bytes_of(section::kManifold);
    const auto sleep = bytes_of(section::kBodySleep);
    step_idle(*world, 120);
    EXPECT_EQ(bytes_of(section::kPair), pairs);
    EXPECT_EQ(bytes_of(section::kManifold), manifolds);
    EXPECT_EQ(bytes_of(section::kBodySleep), sleep);
}

/// All levels at once, and pods that change them.
WorldDefinition levels_scene() {
    WorldDefinition scene = with_levels(scene_of_all(40, 2));
    add_stack(scene, 40000, {60, 0, 0});
    return scene;
}

TEST(LevelOfDetail, SavedLoadedAndRestoredItGoesOnToTheSameBits) {
    const WorldPtr world = make_world(levels_scene());
    std::vector<std::uint32_t> seen(4);
    for (int round = 0; round < 6; ++round) {
        for (int tick = 0; tick < 17 + round; ++tick) {
            step_busy(*world);
        }
        ASSERT_TRUE(world->check().ok());
        std::vector<std::byte> bytes;
        world->save(bytes);
        KeptState kept;
        world->keep(kept);
        const WorldPtr loaded = make_world(levels_scene());
        ASSERT_TRUE(loaded->load(bytes).ok());
        std::vector<std::uint64_t> hashes;
        for (int tick = 0; tick < 60; ++tick) {
            step_busy(*world);
            step_busy(*loaded);
            loaded->drop_derived();
            ASSERT_EQ(world->state_hash(), loaded->state_hash()) << round << " " << tick;
            hashes.push_back(world->state_hash());
            for (BodyRow row = 0; row < world->body_count(); ++row) {
                ++seen[static_cast<std::size_t>(world->body_at(row).level)];
            }
        }
        world->restore(kept);
        for (const std::uint64_t hash : hashes) {
            step_busy(*world);
            ASSERT_EQ(world->state_hash(), hash) << round;
        }
        world->restore(kept);
    }
    for (const std::uint32_t count : seen) {
        EXPECT_GT(count, 1000U);
    }
}

TEST(LevelOfDetail, LevelsThatNoStepLeavesAreRefused) {
    WorldDefinition scene = pod_scene(50, 100, {});
    add_stack(scene, 10, {300, 0, 0});
    const WorldPtr world = make_world(scene);
    const WorldPtr twin = make_world(scene);
    step_idle(*world, 5);
    scene.settings.level_of_detail.enabled = false;
    const WorldPtr without = make_world(scene);
    const auto load_with = [&](World& into, BodyRow row, std::uint8_t level) {
        auto* sleep = rows<BodySleep>(*world, section::kBodySleep);
        const std::uint8_t before = sleep[row].level;
        sleep[row].level = level;
        std::vector<std::byte> bytes;
        world->save(bytes);
        sleep[row].level = before;
        const Status loaded = into.load(bytes);
        return loaded ? std::string() : loaded.error().message;
    };
    const auto frozen = static_cast<std::uint8_t>(BodyLevel::frozen);
    ASSERT_EQ(level_of(*world, 10), BodyLevel::frozen);
    ASSERT_NE(world->body(10)->linear_velocity, Vec3{});
    EXPECT_EQ(load_with(*twin, 2, frozen), ""); // body 10
    EXPECT_NE(load_with(*without, 2, frozen).find("level"), std::string::npos);
    EXPECT_NE(load_with(*twin, 2, 4).find("level"), std::string::npos);
    EXPECT_NE(load_with(*twin, 2, 1).find("level"), std::string::npos);
    EXPECT_NE(load_with(*twin, 0, frozen).find("level"), std::string::npos); // the ground
}

TEST(LevelOfDetail, SettingsOutOfRangeAreRefused) {
    const auto message_of = [](const LevelOfDetail& detail) {
        WorldDefinition scene;
        scene.settings.level_of_detail = detail;
        const Result<WorldPtr> world = World::create(scene);
        return world ? std::string() : world.error().message;
    };
    EXPECT_EQ(message_of({true, 1, 16000, 16}), "");
    EXPECT_EQ(message_of({true, 60, 60, 1}), "");
    EXPECT_NE(message_of({true, 0.5, 100, 2}).find("full_within"), std::string::npos);
    EXPECT_NE(message_of({true, 50, 49, 2}).find("simplified_within"), std::string::npos);
    EXPECT_NE(message_of({true, 50, 16001, 2}).find("simplified_within"), std::string::npos);
    EXPECT_NE(message_of({true, 50, 100, 0}).find("simplified_substeps"), std::string::npos);
    EXPECT_NE(message_of({true, 50, 100, 17}).find("simplified_substeps"), std::string::npos);
}

} // namespace
} // namespace lockwind::test
