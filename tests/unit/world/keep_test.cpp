#include "tests/support/code_scenes.h"

#include "lockwind/rng.h"

#include <array>
#include <gtest/gtest.h>
#include <iostream>

namespace lockwind::test {
namespace {

/// Piles that fall asleep, beside all kinds of joints and two pods.
WorldDefinition sleepy_scene() {
    WorldDefinition scene = scene_of_all(40, 2);
    for (int pile = 0; pile < 300; ++pile) {
        for (int storey = 0; storey < 3; ++storey) {
            BodyDefinition body;
            body.id = 5000 + 10 * static_cast<BodyId>(pile) + static_cast<BodyId>(storey);
            body.shape.type = ShapeType::box;
            body.shape.half_extents = {0.4, 0.4, 0.4};
            body.position = {
                Real(14 + 2 * (pile % 20)), Real(1) + Real(storey), Real(14 + 2 * (pile / 20))};
            scene.bodies.push_back(body);
        }
    }
    // Passes 35 mm above the piles: makes pairs that never touch.
    BodyDefinition glider;
    glider.id = 4000;
    glider.mode = BodyMode::kinematic;
    glider.shape.type = ShapeType::box;
    glider.shape.half_extents = {0.3, 0.1, 16};
    glider.position = {Real(8), 2.535, Real(28)};
    glider.linear_velocity = {2, 0, 0};
    scene.bodies.push_back(glider);
    return scene;
}

std::vector<std::byte> saved(const World& world) {
    std::vector<std::byte> bytes;
    world.save(bytes);
    return bytes;
}

/// What a host may do between ticks; each of it must reach hashes and kept states.
void meddle(World& world, Tick tick) {
    const BodyId pile = 5000 + 10 * random_below(3, 1, tick, 300);
    switch (random_below(3, 2, tick, 24)) {
    case 0:
        world.apply_impulse(pile, {0, 500, 100}, {0, 0, 0});
        break;
    case 1:
        world.apply_torque(pile, {10, 0, 0});
        break;
    case 2:
        world.destroy_body(pile + 1);
        break;
    case 3: {
        BodyDefinition body;
        body.id = 100000 + tick;
        body.position = {Real(16), Real(12), Real(16)};
        static_cast<void>(world.create_body(body));
        break;
    }
    case 4: {
        JointDefinition joint;
        joint.id = 100000 + tick;
        joint.kind = JointKind::distance;
        joint.body_a = pile;
        joint.body_b = pile + 2;
        static_cast<void>(world.create_joint(joint));
        break;
    }
    default:
        break;
    }
}

/// A world that is loaded anew hashes everything; one that goes on only what it believes to have
/// changed.
TEST(Keep, HashesOfWhatChangedAreThoseOfAll) {
    const WorldPtr world = make_world(sleepy_scene());
    const WorldPtr fresh = make_world(sleepy_scene());
    std::uint32_t fewest = world->body_count();
    for (Tick tick = 1; tick <= 400; ++tick) {
        step_busy(*world);
        if (tick > 150) {
            meddle(*world, tick);
        }
        ASSERT_TRUE(fresh->load(saved(*world)).ok());
        ASSERT_EQ(world->state_hash(), fresh->state_hash()) << "tick " << tick;
        fewest = std::min(fewest, world->counts().awake);
    }
    std::cout << "as few as " << fewest << " of " << world->body_count() << " bodies awake\n";
    EXPECT_LT(fewest, world->body_count() / 2) << "pages must have stayed as they were";
}

TEST(Keep, GoesBackToEveryKeptStateBitForBit) {
    const WorldPtr world = make_world(sleepy_scene());
    const WorldPtr fresh = make_world(sleepy_scene());
    struct Slot {
        KeptState kept;
        std::vector<std::byte> bytes;
    };
    std::array<Slot, 9> ring;
    step_idle(*world, 150);
    std::uint32_t fewest = world->body_count();
    for (Tick round = 0; round < 400; ++round) {
        Slot& slot = ring[random_below(7, 1, round, ring.size())];
        if (random_below(7, 2, round, 3) == 0 && !slot.bytes.empty()) {
            world->restore(slot.kept);
            ASSERT_EQ(saved(*world), slot.bytes) << "round " << round;
        } else {
            world->keep(slot.kept);
            slot.bytes = saved(*world);
        }
        if (random_below(7, 3, round, 40) == 0) {
            ASSERT_TRUE(world->load(slot.bytes).ok());
        }
        // Goes on like a world that was loaded, whose derived sections are all made anew.
        ASSERT_TRUE(fresh->load(saved(*world)).ok());
        for (World* each : {world.get(), fresh.get()}) {
            meddle(*each, 1000 + round);
            step_idle(*each);
        }
        ASSERT_EQ(world->state_hash(), fresh->state_hash()) << "round " << round;
        fewest = std::min(fewest, world->counts().awake);
    }
    std::cout << "as few as " << fewest << " of " << world->body_count() << " bodies awake\n";
    EXPECT_LT(fewest, world->body_count() / 2) << "pages must have stayed as they were";
}

/// Speculative bodies leave a contact and are foreseen to meet again within one look.
TEST(Keep, GoesBackFromWhatWasOnlyForeseen) {
    std::size_t begun = 0;
    for (int speed = 4; speed < 60; speed += 5) {
        WorldDefinition scene;
        BodyDefinition wall = box(2, {0, 2, 0}, {0.2, 2, 4});
        wall.mode = BodyMode::fixed;
        scene.bodies = {ground(1), wall};
        for (BodyId id = 10; id < 14; ++id) {
            const Vec3 place{-3, 0.4, Real(static_cast<int>(id)) - Real(11.5)};
            BodyDefinition body =
                id % 2 == 1 ? box(id, place, {0.2, 0.2, 0.2}) : sphere(id, place, 0.2);
            body.linear_velocity = {Real(speed), Real(static_cast<int>(id) - 10), 0};
            body.restitution = 0.6;
            body.collision_mode = CollisionMode::speculative;
            scene.bodies.push_back(body);
        }
        const WorldPtr straight = make_world(scene);
        const WorldPtr back = make_world(scene);
        KeptState kept;
        for (int tick = 0; tick < 90; ++tick) {
            back->keep(kept);
            step_idle(*back);
            back->restore(kept);
            step_idle(*back);
            step_idle(*straight);
            ASSERT_EQ(back->state_hash(), straight->state_hash()) << speed << ", tick " << tick;
            ASSERT_EQ(back->contacts().size(), straight->contacts().size());
            begun += straight->events().size();
        }
    }
    EXPECT_GT(begun, 100U);
}

/// What a step that fails had marked to go does not go after the world went back.
TEST(Keep, GoesBackFromAFault) {
    WorldDefinition scene;
    scene.settings.bounds = 20;
    scene.settings.bounds_policy = BoundsPolicy::error;
    scene.bodies = {ground(1), sphere(6, {5, 0.3, 5}, 0.3)};
    add_pod(scene, 10, {0, 0.5, 0});
    scene.pods[0].ball_lifetime_ticks = 20;
    BodyDefinition far = sphere(5, {0, 10, 10}, 0.3);
    far.linear_velocity = {30, 0, 0};
    scene.bodies.push_back(far);
    PlayerInput shoot;
    shoot.buttons = PlayerInput::kShoot;
    int fault = 1;
    for (const WorldPtr world = make_world(scene); world->step(inputs_of({PlayerInput{}})).ok();) {
        ++fault;
    }
    ASSERT_GT(fault, 22);
    const WorldPtr world = make_world(scene);
    KeptState kept;
    for (int tick = 1; tick < fault; ++tick) {
        if (tick == fault - 2) {
            world->keep(kept);
        }
        ASSERT_TRUE(world->step(inputs_of({tick == fault - 20 ? shoot : PlayerInput{}})).ok());
    }
    ASSERT_FALSE(world->step(inputs_of({PlayerInput{}})).ok()); // the ball goes, too
    world->restore(kept);
    const std::uint32_t count = world->body_count();
    ASSERT_TRUE(world->step(inputs_of({PlayerInput{}})).ok());
    EXPECT_EQ(world->body_count(), count);
    EXPECT_TRUE(world->body((BodyId{10} << 32U) + 1).has_value());
}

TEST(Keep, BytesWrittenByHandAreSeen) {
    const WorldPtr world = make_world(sleepy_scene());
    step_busy(*world);
    KeptState kept;
    world->keep(kept);
    const std::uint64_t hash = world->state_hash();
    const std::span<std::byte> bytes = world->section_bytes(2);
    bytes[100] ^= std::byte{1};
    EXPECT_NE(world->state_hash(), hash);
    bytes[100] ^= std::byte{1};
    EXPECT_EQ(world->state_hash(), hash);
    bytes[100] ^= std::byte{1};
    world->restore(kept);
    EXPECT_EQ(world->state_hash(), hash);
}

} // namespace
} // namespace lockwind::test
