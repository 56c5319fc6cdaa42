#include "tests/support/code_scenes.h"

#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

/// A lift that rises at 2 m/s with a crate on it.
WorldDefinition lift() {
    WorldDefinition scene;
    BodyDefinition floor = box(1, {0, 1, 0}, {1, 0.1, 1});
    floor.mode = BodyMode::kinematic;
    floor.linear_velocity = {0, 2, 0};
    scene.bodies = {floor, box(2, {0, 1.6, 0}, {0.4, 0.5, 0.4})};
    return scene;
}

BodyDefinition definition_of(const BodyView& view) {
    BodyDefinition body;
    body.id = view.id;
    body.mode = view.mode;
    body.shape = view.shape;
    body.position = view.position;
    body.orientation = view.orientation;
    body.linear_velocity = view.linear_velocity;
    body.angular_velocity = view.angular_velocity;
    return body;
}

/// What is handed over goes on as one that was created dynamic there and then.
TEST(Redefine, KinematicBecomesDynamicInMidFlight) {
    WorldDefinition scene;
    BodyDefinition body = box(1, {0, 50, 0}, {0.3, 0.4, 0.5});
    body.mode = BodyMode::kinematic;
    body.linear_velocity = {3, 1, 0};
    body.angular_velocity = {0, 2, 1};
    scene.bodies = {body};
    const WorldPtr world = make_world(scene);
    step_idle(*world, 30);
    EXPECT_NEAR(static_cast<double>(world->body_at(0).position.x.raw()) * 0x1p-32, 1.5, 1e-5);
    BodyDefinition dynamic = definition_of(world->body_at(0));
    dynamic.mode = BodyMode::dynamic;
    ASSERT_TRUE(world->redefine_body(dynamic).ok());

    WorldDefinition other_scene;
    other_scene.bodies = {dynamic};
    const WorldPtr other = make_world(other_scene);
    for (int tick = 0; tick < 120; ++tick) {
        step_idle(*world, 1);
        step_idle(*other, 1);
        const BodyView a = world->body_at(0);
        const BodyView b = other->body_at(0);
        ASSERT_EQ(a.position, b.position) << tick;
        ASSERT_EQ(a.linear_velocity, b.linear_velocity) << tick;
        ASSERT_EQ(a.angular_velocity, b.angular_velocity) << tick;
    }
    EXPECT_LT(world->body_at(0).linear_velocity.y, Real(-15)); // it fell
    EXPECT_TRUE(world->check().ok());
}

TEST(Redefine, DynamicBecomesKinematicAndCarries) {
    WorldDefinition scene = lift();
    scene.bodies[0].mode = BodyMode::dynamic;
    scene.bodies[0].linear_velocity = {};
    scene.bodies.push_back(ground(3));
    const WorldPtr world = make_world(scene);
    step_idle(*world, 180);
    const Real low = world->body_at(1).position.y;
    BodyDefinition floor = definition_of(world->body_at(0));
    floor.mode = BodyMode::kinematic;
    floor.linear_velocity = {0, 2, 0};
    ASSERT_TRUE(world->redefine_body(floor).ok());
    step_idle(*world, 60);
    const double risen = static_cast<double>((world->body_at(1).position.y - low).raw()) * 0x1p-32;
    EXPECT_NEAR(risen, 2, 0.05);
    // And back: both fall to the ground.
    floor = definition_of(world->body_at(0));
    floor.mode = BodyMode::dynamic;
    ASSERT_TRUE(world->redefine_body(floor).ok());
    step_idle(*world, 240);
    EXPECT_LT(world->body_at(1).position.y, low + Real(0.1));
    EXPECT_TRUE(world->check().ok());
}

TEST(Redefine, KeepsJointsAndTheyHold) {
    WorldDefinition scene;
    BodyDefinition hand = box(1, {0, 5, 0}, {0.1, 0.1, 0.1});
    hand.mode = BodyMode::kinematic;
    scene.bodies = {hand, sphere(2, {0, 4, 0}, 0.2)};
    JointDefinition joint;
    joint.id = 1;
    joint.body_a = 1;
    joint.body_b = 2;
    joint.anchor_b = {0, 1, 0};
    scene.joints = {joint};
    const WorldPtr world = make_world(scene);
    step_idle(*world, 30);
    EXPECT_GT(world->body_at(1).position.y, Real(3.99));
    hand = definition_of(world->body_at(0));
    hand.mode = BodyMode::dynamic;
    hand.mass = 1;
    ASSERT_TRUE(world->redefine_body(hand).ok());
    step_idle(*world, 30);
    EXPECT_LT(world->body_at(0).position.y, Real(4.5)); // both fall
    const Vec3 between = world->body_at(0).position - world->body_at(1).position;
    EXPECT_NEAR(static_cast<double>(length(between).raw()) * 0x1p-32, 1, 1e-3);
}

TEST(Redefine, IsSeenByQueriesAtOnce) {
    WorldDefinition scene = lift();
    const WorldPtr world = make_world(scene);
    step_idle(*world, 1);
    EXPECT_TRUE(world->ray_cast({0, 50, 0}, {0, -50, 0}).has_value());
    for (BodyDefinition& body : scene.bodies) {
        body.position.x = 20;
        ASSERT_TRUE(world->redefine_body(body).ok());
    }
    EXPECT_FALSE(world->ray_cast({0, 50, 0}, {0, -50, 0}).has_value());
    EXPECT_TRUE(world->ray_cast({20, 50, 0}, {20, -50, 0}).has_value());
}

TEST(Redefine, ErrorsChangeNothing) {
    WorldDefinition scene = busy_scene(6, 1);
    add_joints(scene, 10000, {0, 30, 0});
    const WorldPtr world = make_world(scene);
    const std::uint64_t hash = world->state_hash();
    const auto refusal = [&](const BodyDefinition& definition) {
        const Status status = world->redefine_body(definition);
        EXPECT_EQ(world->state_hash(), hash);
        return status.ok() ? std::string() : status.error().message;
    };
    const auto hung = definition_of(*world->body(10001));
    BodyDefinition wrong = hung;
    wrong.id = 77777;
    EXPECT_NE(refusal(wrong).find("body 77777: is no body"), std::string::npos);
    wrong = hung;
    wrong.shape.half_extents.x = 1;
    EXPECT_NE(refusal(wrong).find("body 10001: shape is another"), std::string::npos);
    wrong = hung;
    wrong.mode = BodyMode::kinematic; // its joint's other body is fixed
    EXPECT_NE(refusal(wrong).find("body 10001: joint 10000 cannot"), std::string::npos);
    wrong = hung;
    wrong.position.x = 29999;
    EXPECT_NE(refusal(wrong).find("outside"), std::string::npos);
    wrong = hung;
    wrong.friction = -1;
    EXPECT_NE(refusal(wrong).find("friction"), std::string::npos);
    EXPECT_NE(refusal(definition_of(*world->pod(0))).find("pod"), std::string::npos);
}

} // namespace
} // namespace lockwind::test
