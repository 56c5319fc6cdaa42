#include "scene/scene.h"

#include "lockwind/trig.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace lockwind {
namespace {

const std::string kBodies =
    "name: \"t\"\n"
    "body { name: \"post\" mode: fixed position { x: 1 y: 2 } sphere { radius: 0.1 } }\n"
    "body { name: \"arm\" position { x: 3 y: 2 } rotation { axis { z: 1 } degrees: 90 }"
    " sphere { radius: 0.1 } }\n"
    "body { name: \"row\" sphere { radius: 0.1 } grid { count { x: 3 y: 1 z: 1 }"
    " pitch { x: 1 y: 1 z: 1 } } }\n";

Result<WorldDefinition> parse(const std::string& joint) {
    return parse_scene(kBodies + joint + "\n", "t.textproto");
}

JointDefinition joint_of(const std::string& text) {
    const Result<WorldDefinition> world = parse(text);
    EXPECT_TRUE(world.ok()) << (world.ok() ? "" : world.error().message);
    return world.ok() && !world.value().joints.empty() ? world.value().joints[0]
                                                       : JointDefinition{};
}

double number(Real value) {
    return static_cast<double>(value.raw()) / 4294967296.0;
}

TEST(JointScene, AnchorsBecomeThoseOfTheBodies) {
    const JointDefinition joint =
        joint_of("joint { body_a: \"post\" body_b: \"arm\" anchor { x: 2 y: 2 } ball {} }");
    EXPECT_EQ(joint.id, 1U);
    EXPECT_EQ(joint.body_a, 1U);
    EXPECT_EQ(joint.body_b, 2U);
    EXPECT_EQ(joint.anchor_a, (Vec3{1, 0, 0}));
    // The arm is turned by 90 degrees about z: world -x is its +y.
    EXPECT_NEAR(number(joint.anchor_b.x), 0, 1e-8);
    EXPECT_NEAR(number(joint.anchor_b.y), 1, 1e-8);
}

/// The frame's x, turned by body and frame, is the axis; a wheel's z is its spin axis.
TEST(JointScene, AxesBecomeThoseOfTheBodies) {
    const JointDefinition joint =
        joint_of("joint { body_a: \"post\" body_b: \"arm\" axis { y: -0.5 } spin_axis { z: -1 } "
                 "wheel { spring { hertz: 3 } } }");
    const RealQuat arm = from_axis_angle({0, 0, 1}, Angle::from_turns(0.25));
    for (const RealQuat& frame : {joint.frame_a, arm * joint.frame_b}) {
        const Vec3 axis = rotate(frame, {1, 0, 0});
        const Vec3 spin = rotate(frame, {0, 0, 1});
        EXPECT_NEAR(number(axis.y), -1, 1e-7);
        EXPECT_NEAR(number(spin.z), -1, 1e-7);
    }
}

TEST(JointScene, ReadsEveryField) {
    const JointDefinition hinge = joint_of(
        "joint { body_a: \"row[2]\" body_b: \"arm\" collide_connected: true break_force: 7 "
        "break_torque: 8 hinge { limit { min: -90 max: 45 } motor { speed: -2 max: 3 } "
        "spring { hertz: 4 damping_ratio: 0.5 rest: 30 } } }");
    EXPECT_EQ(hinge.kind, JointKind::hinge);
    EXPECT_EQ(hinge.body_a, 5U);
    EXPECT_TRUE(hinge.collide_connected && hinge.has_limit && hinge.has_motor && hinge.has_spring);
    EXPECT_NEAR(number(hinge.angle_min), -M_PI / 2, 1e-8);
    EXPECT_NEAR(number(hinge.angle_max), M_PI / 4, 1e-8);
    EXPECT_NEAR(number(hinge.rest_angle), M_PI / 6, 1e-8);
    EXPECT_EQ(hinge.motor_speed, Real(-2));
    EXPECT_EQ(hinge.motor_max, Real(3));
    EXPECT_EQ(hinge.spring_hertz, Real(4));
    EXPECT_EQ(hinge.spring_damping, Real(0.5));
    EXPECT_EQ(hinge.break_force, Real(7));
    EXPECT_EQ(hinge.break_torque, Real(8));
    const JointDefinition rod = joint_of("joint { body_a: \"post\" body_b: \"arm\" anchor { x: 1 } "
                                         "anchor_b { x: 4 y: 4 } distance {} }");
    EXPECT_EQ(rod.length_min, Real(5));
    EXPECT_EQ(rod.length_max, Real(5));
    const JointDefinition grab =
        joint_of("joint { body_b: \"arm\" anchor { y: 3 } grab { spring { hertz: 2 } "
                 "force_max: 9 } }");
    EXPECT_EQ(grab.body_a, 0U);
    EXPECT_EQ(grab.target, (Vec3{0, 3, 0}));
    EXPECT_EQ(grab.motor_max, Real(9));
}

TEST(JointScene, ErrorsNameLineColumnAndField) {
    const struct {
        const char* joint;
        const char* expected;
    } cases[] = {
        {"joint { body_a: \"post\" body_b: \"arm\" }", "5:1: joint[0] has no kind"},
        {"joint { body_b: \"arm\" ball {} }", "joint[0].body_a is missing"},
        {"joint { body_a: \"pots\" body_b: \"arm\" ball {} }",
         "5:9: joint[0].body_a \"pots\" is no body's name"},
        {"joint { body_a: \"row\" body_b: \"arm\" ball {} }", "give row[0] .. row[2]"},
        {"joint { body_a: \"row[3]\" body_b: \"arm\" ball {} }", "give row[0] .. row[2]"},
        {"joint { body_a: \"arm\" body_b: \"arm\" ball {} }", "joint[0].body_b is body_a too"},
        {"joint { body_a: \"post\" body_b: \"arm\" axis { } ball {} }", "joint[0].axis is 0"},
        {"joint { body_a: \"post\" body_b: \"arm\" hinge { limit { min: 2 max: 1 } } }",
         "joint[0].hinge.limit.min is above max"},
        {"joint { body_a: \"post\" body_b: \"arm\" weld { spring { hertz: 0 } } }",
         "joint[0].weld.spring.hertz is 0"},
        {"joint { body_a: \"post\" body_b: \"arm\" anchor { x: 900 } ball {} }",
         "joint[0].anchor is more than 400 m"},
        {"joint { body_a: \"post\" body_b: \"arm\" anchor_b { x: 9 } ball {} }",
         "joint[0].anchor_b is for a distance alone"},
        {"joint { body_a: \"post\" body_b: \"arm\" break_force: -1 ball {} }",
         "joint[0].break_force is -1 N"},
        {"joint { body_a: \"post\" body_b: \"arm\" grab { spring { hertz: 1 } } }",
         "joint[0].body_a is given"},
        {"body { name: \"arm\" sphere { radius: 1 } }", "body[3].name \"arm\" is another"},
    };
    for (const auto& c : cases) {
        const Result<WorldDefinition> world = parse(c.joint);
        ASSERT_FALSE(world.ok()) << c.joint;
        EXPECT_NE(world.error().message.find(c.expected), std::string::npos)
            << world.error().message;
    }
}

} // namespace
} // namespace lockwind
