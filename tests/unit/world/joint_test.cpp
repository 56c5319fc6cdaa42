#include "tests/support/code_scenes.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

namespace lockwind::test {
namespace {

std::string refusal(const WorldDefinition& definition) {
    const Result<WorldPtr> world = World::create(definition);
    return world ? "" : world.error().message;
}

/// One of each joint about a post.
WorldDefinition gallery() {
    WorldDefinition definition;
    add_joints(definition, 1, {0, 5, 0});
    return definition;
}

TEST(WorldJoint, RefusalsNameTheJointAndTheField) {
    const struct {
        const char* expected;
        void (*spoil)(JointDefinition&);
    } cases[] = {
        {"joint 1099511627776: id is out", [](JointDefinition& j) { j.id = 1ULL << 40U; }},
        {"joint 1: body_a is no body", [](JointDefinition& j) { j.body_a = 99; }},
        {"joint 1: body_b is body_a", [](JointDefinition& j) { j.body_b = j.body_a; }},
        {"joint 1: anchor_a.y", [](JointDefinition& j) { j.anchor_a.y = 500; }},
        {"joint 1: anchor_b is more than 1000", [](JointDefinition& j) { j.anchor_b.x = 390; }},
        {"joint 1: frame_b is 0",
         [](JointDefinition& j) {
             j.frame_b = {0, 0, 0, 0};
         }},
        {"joint 1: has_motor is not", [](JointDefinition& j) { j.has_motor = true; }},
        {"joint 1: spring_hertz", [](JointDefinition& j) { j.spring_hertz = 0; }},
        {"joint 1: break_force", [](JointDefinition& j) { j.break_force = -1; }},
        {"joint 2: id is used twice", [](JointDefinition& j) { j.id = 2; }},
    };
    for (const auto& c : cases) {
        WorldDefinition definition = gallery();
        c.spoil(definition.joints[0]);
        EXPECT_NE(refusal(definition).find(c.expected), std::string::npos)
            << refusal(definition) << " for " << c.expected;
    }
    WorldDefinition small = gallery();
    small.settings.joint_capacity = 3;
    EXPECT_NE(refusal(small).find("joint_capacity of 3"), std::string::npos) << refusal(small);
}

/// Limits that a kind does not have are not looked at, nor kept.
TEST(WorldJoint, LimitsOfOtherKindsAreLeftOut) {
    const auto spoil = [](JointDefinition& joint) {
        const bool is_length = joint.kind == JointKind::distance ||
                               joint.kind == JointKind::slider || joint.kind == JointKind::wheel;
        const Real extremes[] = {Real::highest(), Real::lowest()};
        if (is_length) {
            joint.angle_min = extremes[0];
            joint.angle_max = extremes[1];
            joint.swing_max = extremes[1];
        } else {
            joint.length_min = extremes[0];
            joint.length_max = extremes[1];
            joint.swing_max = joint.kind == JointKind::hinge ? extremes[0] : joint.swing_max;
        }
    };
    WorldDefinition spoilt = gallery();
    int limits = 0;
    for (JointDefinition& joint : spoilt.joints) {
        limits += joint.has_limit ? 1 : 0;
        spoil(joint);
    }
    EXPECT_GE(limits, 3);
    const WorldPtr world = make_world(spoilt);
    const WorldPtr usual = make_world(gallery());
    EXPECT_TRUE(world->check().ok()) << world->check().error().message;
    EXPECT_EQ(world->state_hash(), usual->state_hash());
}

TEST(WorldJoint, OrderOfTheDefinitionDoesNotMatter) {
    WorldDefinition reversed = gallery();
    std::reverse(reversed.joints.begin(), reversed.joints.end());
    const WorldPtr a = make_world(gallery());
    const WorldPtr b = make_world(reversed);
    for (int tick = 0; tick < 60; ++tick) {
        ASSERT_EQ(a->state_hash(), b->state_hash()) << tick;
        step_idle(*a);
        step_idle(*b);
    }
}

TEST(WorldJoint, SnapshotInMidMotionGoesOnToTheSameBits) {
    const WorldPtr world = make_world(gallery());
    const WorldPtr other = make_world(gallery());
    std::vector<std::byte> bytes;
    for (int tick = 0; tick < 200; ++tick) {
        step_idle(*world);
        if (tick % 20 == 7) {
            world->save(bytes);
            const Status loaded = other->load(bytes);
            ASSERT_TRUE(loaded.ok()) << loaded.error().message;
        } else {
            step_idle(*other);
        }
        if (tick > 7) {
            ASSERT_EQ(world->state_hash(), other->state_hash()) << tick;
        }
    }
    EXPECT_EQ(world->counts().joints, gallery().joints.size());
}

TEST(WorldJoint, BreakingIsToldInOrderAndRemovesTheJoint) {
    WorldDefinition definition;
    BodyDefinition post = box(1, {0, 5, 0}, {0.1, 0.1, 0.1});
    post.mode = BodyMode::fixed;
    definition.bodies.push_back(post);
    for (BodyId id = 2; id <= 5; ++id) {
        BodyDefinition weight = sphere(id, {Real(std::int64_t(id)), 4, 0}, 0.2);
        weight.mass = 10;
        definition.bodies.push_back(weight);
        JointDefinition joint;
        joint.id = 10 - id;
        joint.body_a = 1;
        joint.body_b = id;
        joint.anchor_a = {Real(std::int64_t(id)), 0, 0};
        joint.anchor_b = {0, 1, 0};
        joint.break_force = id == 3 ? 500 : 50; // a weight is 98 N
        definition.joints.push_back(joint);
    }
    const WorldPtr world = make_world(definition);
    std::vector<Event> breaks;
    for (int tick = 0; tick < 60; ++tick) {
        step_idle(*world);
        for (const Event& event : world->events()) {
            if (event.type == EventType::joint_break) {
                breaks.push_back(event);
            }
        }
    }
    const std::vector<Event> expected = {{EventType::joint_break, 1, 2, 8},
                                         {EventType::joint_break, 1, 4, 6},
                                         {EventType::joint_break, 1, 5, 5}};
    EXPECT_EQ(breaks, expected);
    EXPECT_EQ(world->counts().joints, 1U);
    EXPECT_TRUE(world->joint(7).has_value());
    EXPECT_FALSE(world->joint(8).has_value());
    EXPECT_LT(to_double(world->body(2)->position.y), 3);
    EXPECT_NEAR(to_double(world->body(3)->position.y), 4, 0.01);
}

TEST(WorldJoint, GoesWithItsBodyAndFollowsTheOthers) {
    const WorldPtr world = make_world(gallery());
    const std::uint32_t before = world->counts().joints;
    ASSERT_TRUE(world->create_body(sphere(500, {50, 5, 0}, 0.2)).ok());
    const std::optional<JointView> second = world->joint(2);
    ASSERT_TRUE(second.has_value());
    ASSERT_TRUE(world->destroy_body(world->joint(1)->body_b));
    EXPECT_EQ(world->counts().joints, before - 1);
    EXPECT_FALSE(world->joint(1).has_value());
    EXPECT_EQ(world->joint(2)->body_a, second->body_a);
    EXPECT_EQ(world->joint(2)->body_b, second->body_b);
    EXPECT_TRUE(world->check().ok());
    step_idle(*world, 30);
    EXPECT_TRUE(world->check().ok());
}

TEST(WorldJoint, ComesGoesAndIsSteeredBetweenSteps) {
    const WorldPtr world = make_world(gallery());
    JointDefinition joint;
    joint.id = 100;
    joint.kind = JointKind::grab;
    joint.body_b = world->joint(1)->body_b;
    joint.spring_hertz = 3;
    ASSERT_TRUE(world->create_joint(joint).ok());
    EXPECT_FALSE(world->create_joint(joint).ok());
    EXPECT_TRUE(world->set_joint_target(100, {1, 2, 3}));
    EXPECT_FALSE(world->set_joint_target(1, {1, 2, 3}));
    EXPECT_FALSE(world->set_joint_motor(100, 3));
    EXPECT_EQ(world->joint(100)->target, (Vec3{1, 2, 3}));
    EXPECT_EQ(world->joint(100)->body_a, 0U);
    EXPECT_TRUE(world->check().ok());
    step_idle(*world, 10);
    EXPECT_TRUE(world->destroy_joint(100));
    EXPECT_FALSE(world->destroy_joint(100));
    EXPECT_TRUE(world->check().ok());
}

} // namespace
} // namespace lockwind::test
