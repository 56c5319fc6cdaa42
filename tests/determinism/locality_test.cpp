#include "dynamics/body.h"
#include "tests/support/code_scenes.h"
#include "world/state.h"

#include <cstring>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

/// A floor with a pile and a pod, `offset` m along x; ids from `first_id`.
void add_group(WorldDefinition& scene, BodyId first_id, Real offset) {
    BodyDefinition floor = box(first_id, {offset, -0.5, 0}, {20, 0.5, 20});
    floor.mode = BodyMode::fixed;
    scene.bodies.push_back(floor);
    for (std::uint32_t index = 0; index < 24; ++index) {
        const Vec3 place{offset + Real(index % 3) * Real(0.9),
                         Real(index / 6) * Real(1.2) + Real(0.6),
                         Real(index % 2) * Real(0.9)};
        const BodyId id = first_id + 1 + index;
        scene.bodies.push_back(index % 2 == 0 ? box(id, place, {0.4, 0.4, 0.4})
                                              : capsule(id, place, 0.3, 0.2));
    }
    if (scene.hulls.empty()) {
        scene.hulls.push_back({{{0.5, 0.1, 0},
                                {-0.5, 0, 0},
                                {0, 0.4, 0},
                                {0, -0.4, 0},
                                {0, 0, 0.5},
                                {0.1, 0, -0.5},
                                {0.3, 0.3, 0.3}}});
    }
    for (std::uint32_t index = 0; index < 8; ++index) {
        BodyDefinition rock = box(first_id + 30 + index,
                                  {offset + Real(index % 4), Real(6) + Real(index / 4), 1},
                                  {1, 1, 1});
        rock.shape.type = ShapeType::hull;
        scene.bodies.push_back(rock);
    }
    add_bullets(scene, first_id + 100, {offset, 4, 8});
    add_pod(scene, first_id + 50, {offset, 0.3, -6});
}

const BodyMotion* motion_of(World& world, BodyId id) {
    const auto* rows =
        reinterpret_cast<const BodyMotion*>(world.section_bytes(section::kBody).data());
    for (std::uint32_t row = 0; row < world.row_count(section::kBody); ++row) {
        if (rows[row].id == id) {
            return &rows[row];
        }
    }
    return nullptr;
}

/// Every body of `part` is in `whole`, bit for bit. Returns how many there are.
std::uint32_t expect_contained(World& part, World& whole) {
    const auto* rows =
        reinterpret_cast<const BodyMotion*>(part.section_bytes(section::kBody).data());
    const std::uint32_t count = part.row_count(section::kBody);
    for (std::uint32_t row = 0; row < count; ++row) {
        const BodyMotion* twin = motion_of(whole, rows[row].id);
        if (twin == nullptr || std::memcmp(twin, &rows[row], sizeof(BodyMotion)) != 0) {
            ADD_FAILURE() << "body " << rows[row].id << " differs at tick " << part.tick();
            return 0;
        }
    }
    return count;
}

TEST(Locality, WhatHappensToAGroupDependsOnThatGroupAlone) {
    WorldDefinition first;
    WorldDefinition second;
    WorldDefinition both;
    add_group(first, 1000, -300);
    add_group(second, 2000, 300);
    add_group(both, 2000, 300); // the pod of slot 0 is the second group's
    add_group(both, 1000, -300);
    const WorldPtr a = make_world(first);
    const WorldPtr b = make_world(second);
    const WorldPtr whole = make_world(both);
    for (Tick tick = 1; tick <= 240; ++tick) {
        const std::vector<SlotInput> inputs = busy_inputs(tick, 2);
        ASSERT_TRUE(b->step({&inputs[0], 1}).ok());
        ASSERT_TRUE(a->step({&inputs[1], 1}).ok());
        ASSERT_TRUE(whole->step(inputs).ok());
        const std::uint32_t count = expect_contained(*a, *whole) + expect_contained(*b, *whole);
        ASSERT_EQ(count, whole->body_count());
    }
    EXPECT_GT(whole->counts().contacts, 40U);
    EXPECT_GT(whole->counts().created_total, 5U);
}

/// The same group elsewhere does the same, positions apart: nothing is measured from the origin.
TEST(Locality, WhereTheWorldsOriginLiesDoesNotMatter) {
    WorldDefinition here;
    WorldDefinition there;
    add_group(here, 1000, 0);
    add_group(there, 1000, 10000);
    for (WorldDefinition* scene : {&here, &there}) {
        scene->settings.bounds = 16000;
        scene->settings.level_of_detail = {true, 6, 12, 2};
    }
    const WorldPtr a = make_world(here);
    const WorldPtr b = make_world(there);
    for (Tick tick = 1; tick <= 240; ++tick) {
        const std::vector<SlotInput> inputs = busy_inputs(tick, 1);
        ASSERT_TRUE(a->step(inputs).ok());
        ASSERT_TRUE(b->step(inputs).ok());
        ASSERT_EQ(a->event_hash(), b->event_hash()) << tick;
        ASSERT_EQ(a->body_count(), b->body_count());
        for (BodyRow row = 0; row < a->body_count(); ++row) {
            const BodyView body = a->body_at(row);
            const BodyView moved = b->body_at(row);
            ASSERT_EQ(moved.position, (body.position + Vec3{10000, 0, 0}));
            ASSERT_EQ(moved.orientation, body.orientation);
            ASSERT_EQ(moved.linear_velocity, body.linear_velocity);
            ASSERT_EQ(moved.angular_velocity, body.angular_velocity);
            ASSERT_EQ(moved.level, body.level);
        }
    }
}

} // namespace
} // namespace lockwind::test
