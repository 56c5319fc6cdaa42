#include "scene/scene.h"
#include "tests/support/code_scenes.h"

#include <array>
#include <gtest/gtest.h>
#include <iostream>

// The scene `lod`: a pod glides past three groups of bodies, which stand still while it is far.
namespace lockwind::test {
namespace {

constexpr int kTicks = 360;
constexpr BodyId kPerGroup = 29;
constexpr BodyId kArm = 29; // of the first group: the ground is body 1

WorldDefinition lod_scene() {
    SceneOptions options;
    options.players = 1;
    Result<WorldDefinition> scene = load_scene("lod", options);
    EXPECT_TRUE(scene.ok());
    return std::move(scene).value();
}

TEST(LodScene, AGroupMovesWhileThePodIsNear) {
    const WorldDefinition scene = lod_scene();
    const WorldPtr world = make_world(scene);
    std::array<int, 3> moved{};
    std::array<int, 3> full{};
    std::array<Vec3, 3> places{};
    int stood_while_frozen = 0;
    for (int tick = 0; tick < kTicks; ++tick) {
        std::array<BodyLevel, 3> before{};
        for (BodyId group = 0; group < 3; ++group) {
            before[group] = world->body(kArm + group * kPerGroup)->level;
        }
        step_idle(*world);
        for (BodyId group = 0; group < 3; ++group) {
            const BodyView arm = *world->body(kArm + group * kPerGroup);
            ASSERT_EQ(arm.shape.half_extents.x, Real(1));
            const bool has_moved = arm.position != places[group];
            const bool was_frozen = before[group] == BodyLevel::frozen;
            places[group] = arm.position;
            ASSERT_NE(has_moved, was_frozen) << "group " << group << " at tick " << tick;
            moved[group] += has_moved ? 1 : 0;
            full[group] += arm.level == BodyLevel::full ? 1 : 0;
            stood_while_frozen += was_frozen ? 1 : 0;
        }
    }
    // At 20 m/s, 3 ticks a metre: 33 m and a bit behind it, 30 m more ahead; full 13 m and 12 m.
    EXPECT_NEAR(moved[0], 105, 12);
    EXPECT_NEAR(moved[1], 192, 15);
    EXPECT_NEAR(full[1], 75, 12);
    EXPECT_NEAR(moved[2], 149, 15);
    EXPECT_GT(stood_while_frozen, kTicks);
}

TEST(LodScene, FarBodiesAreNotStepped) {
    WorldDefinition scene = lod_scene();
    const WorldPtr world = make_world(scene);
    scene.settings.level_of_detail.enabled = false;
    const WorldPtr usual = make_world(scene);
    double share = 0;
    for (int tick = 0; tick < kTicks; ++tick) {
        step_idle(*world);
        step_idle(*usual);
        share += static_cast<double>(world->counts().awake) / usual->counts().awake / kTicks;
    }
    std::cout << "awake: " << share << " of those without levels\n";
    EXPECT_LT(share, 0.6);
}

} // namespace
} // namespace lockwind::test
