#include "tests/unit/dynamics/joint_bench.h"

namespace lockwind {
namespace {

constexpr double kGravity = 9.81;
constexpr double kTurn = 2 * std::numbers::pi;

/// A ball on a joint `length` from a fixed point, let go at `amplitude` from straight down.
class Pendulum {
public:
    Pendulum(double length, double amplitude) {
        const double x = length * std::sin(amplitude);
        const double y = length * std::cos(amplitude);
        const BodyRow top = bench_.add(fixed(cube(0.1, vec(0, 0, 0))));
        bob_ = bench_.add(ball(kRadius, vec(x, -y, 0)));
        bench_.add(join(JointKind::ball, top, bob_, vec(0, 0, 0), vec(-x, y, 0)));
    }
    /// Mean period of the swings of `ticks`, from passing the middle to the left, s.
    double period(int ticks) {
        double first = 0;
        double last = 0;
        int passes = 0;
        double before = bench_.position(bob_, 0);
        for (int tick = 1; tick <= ticks; ++tick) {
            bench_.step();
            const double now = bench_.position(bob_, 0);
            if (before > 0 && now <= 0) {
                last = (tick - 1 + before / (before - now)) / 60;
                first = passes == 0 ? last : first;
                ++passes;
            }
            before = now;
        }
        return passes > 1 ? (last - first) / (passes - 1) : 0;
    }
    double energy() { return bench_.energy(bob_, kMoment); }
    double gap() { return bench_.gap(0); }
    static constexpr double kRadius = 0.05;
    static constexpr double kMoment = 0.4 * kRadius * kRadius; // by mass

private:
    JointBench bench_;
    BodyRow bob_ = 0;
};

double small_period(double length) {
    return kTurn * std::sqrt((length * length + Pendulum::kMoment) / (kGravity * length));
}

TEST(Joint, PendulumSwingsAtTheClosedFormPeriod) {
    for (const double length : {1.0, 10.0}) {
        // The circle's correction for a small amplitude: 1 + amplitude^2 / 16.
        const double expected = small_period(length) * (1 + 0.05 * 0.05 / 16);
        EXPECT_NEAR(Pendulum(length, 0.05).period(3600), expected, 5e-5 * expected);
    }
}

/// Complete elliptic integral: 2 K(sin 45) / pi = 1.18034.
TEST(Joint, PendulumOfNinetyDegreesSwingsSlowerAsPublished) {
    for (const double length : {1.0, 10.0}) {
        const double expected = small_period(length) * 1.18034;
        EXPECT_NEAR(Pendulum(length, kTurn / 4).period(3600), expected, 5e-4 * expected);
    }
}

TEST(Joint, PendulumKeepsEnergyAndLengthForAMinute) {
    Pendulum pendulum(1, kTurn / 4);
    const double start = pendulum.energy();
    for (int second = 0; second < 60; ++second) {
        pendulum.period(60);
        EXPECT_NEAR(pendulum.energy(), start, 0.01 * kGravity) << second;
        EXPECT_LT(pendulum.gap(), 3e-4) << second;
    }
}

/// The poles of the implicit Euler step of a spring, x = 2 pi f h: |z|^2 = a3, 2 Re z = 1 + a3 (1 -
/// x^2), a3 = 1 / (1 + x (2 zeta + x)).
TEST(Joint, SpringRingsAtItsFrequencyAndDamping) {
    for (const double damping : {0.0, 0.1}) {
        constexpr double kHertz = 2;
        JointBench bench(JointBench::weightless());
        const BodyRow wall = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
        const BodyRow mass = bench.add(ball(0.2, vec(2.5, 0, 0)));
        JointDefinition spring = join(JointKind::distance, wall, mass, vec(0, 0, 0), vec(0, 0, 0));
        spring.has_spring = true;
        spring.spring_hertz = real(kHertz);
        spring.spring_damping = real(damping);
        spring.rest_length = 2;
        bench.add(spring);
        const double x = kTurn * kHertz / 240;
        const double a3 = 1 / (1 + x * (2 * damping + x));
        const double angle = std::acos((1 + a3 * (1 - x * x)) / (2 * std::sqrt(a3)));
        const double period = kTurn / angle / 240;
        double first = 0;
        double last = 0;
        int passes = 0;
        double before = 0.5;
        double peak = 0;
        for (int tick = 1; tick <= 180; ++tick) {
            bench.step();
            const double now = bench.position(mass, 0) - 2;
            if (before > 0 && now <= 0) {
                last = (tick - 1 + before / (before - now)) / 60;
                first = passes == 0 ? last : first;
                ++passes;
            }
            before = now;
            peak = tick > 150 ? std::max(peak, std::abs(now)) : 0;
        }
        ASSERT_GT(passes, 3);
        EXPECT_NEAR((last - first) / (passes - 1), period, 0.005 * period);
        // The highest swing of the last half second, one period: at its begin.
        const double decay = std::pow(a3, 0.5 * 240 * (150.0 / 60));
        EXPECT_NEAR(peak, 0.5 * decay, 0.08 * 0.5 * decay);
    }
}

TEST(Joint, RodAndRopeKeepTheirLength) {
    for (const double least : {0.0, 2.0}) {
        JointBench bench;
        const BodyRow top = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
        const BodyRow bob = bench.add(ball(0.1, vec(2, 0, 0)));
        JointDefinition rope = join(JointKind::distance, top, bob, vec(0, 0, 0), vec(0, 0, 0));
        rope.has_limit = true;
        rope.length_min = real(least);
        rope.length_max = 2;
        bench.add(rope);
        double worst = 0;
        double lowest = 0;
        for (int tick = 0; tick < 600; ++tick) {
            bench.step();
            worst = std::max(worst, bench.gap(0) - 2);
            lowest = std::min(lowest, bench.position(bob, 1));
        }
        EXPECT_LT(worst, 1e-3);
        EXPECT_LT(lowest, -1.99);
    }
}

TEST(Joint, HingeRestsOnItsLimit) {
    JointBench bench;
    const BodyRow post = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
    const BodyRow arm = bench.add(box(0.5, 0.05, 0.05, vec(0.6, 0, 0)));
    JointDefinition hinge =
        about_z(join(JointKind::hinge, post, arm, vec(0.1, 0, 0), vec(-0.5, 0, 0)));
    hinge.has_limit = true;
    hinge.angle_min = real(-0.3);
    hinge.angle_max = real(0.2);
    bench.add(hinge);
    bench.run(300);
    EXPECT_NEAR(bench.angle_z(arm), -0.3, 1e-3);
    bench.motion(arm).angular_velocity[2] = 3 << 20;
    double highest = 0;
    for (int tick = 0; tick < 60; ++tick) {
        bench.step();
        highest = std::max(highest, bench.angle_z(arm));
        EXPECT_LT(bench.gap(0), 2e-3); // as it strikes the stop
    }
    EXPECT_NEAR(highest, 0.2, 5e-3);
}

/// alpha = torque / inertia about the hinge, m (k^2 + L^2): the lever counts in full.
TEST(Joint, HingeMotorAcceleratesByItsTorqueUpToItsSpeed) {
    for (const double lever : {0.0, 1.5}) {
        JointBench bench(JointBench::weightless());
        const BodyRow post = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
        BodyDefinition body = box(0.4, 0.2, 0.1, vec(lever, 0, 0));
        body.mass = 3;
        const BodyRow wheel = bench.add(body);
        JointDefinition hinge =
            about_z(join(JointKind::hinge, post, wheel, vec(0, 0, 0), vec(-lever, 0, 0)));
        hinge.has_motor = true;
        hinge.motor_speed = 4;
        const double inertia = 3 * ((0.16 + 0.04) / 3 + lever * lever);
        hinge.motor_max = real(2 * inertia); // 2 rad/s^2
        bench.add(hinge);
        bench.run(60);
        EXPECT_NEAR(bench.spin(wheel, 2), 2, 2e-3);
        bench.run(90);
        EXPECT_NEAR(bench.spin(wheel, 2), 4, 1e-3);
        bench.run(60);
        EXPECT_NEAR(bench.spin(wheel, 2), 4, 1e-3);
    }
}

TEST(Joint, HingeSpringRestsAtItsAngle) {
    JointBench bench(JointBench::weightless());
    const BodyRow post = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
    const BodyRow door = bench.add(box(0.5, 0.05, 0.5, vec(0.6, 0, 0)));
    JointDefinition hinge =
        about_z(join(JointKind::hinge, post, door, vec(0.1, 0, 0), vec(-0.5, 0, 0)));
    hinge.has_spring = true;
    hinge.spring_hertz = 2;
    hinge.rest_angle = real(0.7);
    bench.add(hinge);
    bench.run(180);
    EXPECT_NEAR(bench.angle_z(door), 0.7, 1e-3);
}

TEST(Joint, SliderMotorLiftsOrFallsByItsForce) {
    for (const double force_by_weight : {2.0, 0.5}) {
        JointBench bench;
        const BodyRow post = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
        BodyDefinition body = cube(0.3, vec(1, 0, 0));
        body.mass = 7;
        const BodyRow lift = bench.add(body);
        JointDefinition slider =
            along_y(join(JointKind::slider, post, lift, vec(1, 0, 0), vec(0, 0, 0)));
        slider.has_motor = true;
        slider.motor_speed = 1;
        slider.motor_max = real(force_by_weight * 7 * kGravity);
        bench.add(slider);
        bench.run(30);
        const double expected = force_by_weight > 1 ? 1 : -kGravity * 0.5 * 0.5;
        EXPECT_NEAR(bench.velocity(lift, 1), expected, 2e-3);
        EXPECT_NEAR(bench.position(lift, 0), 1, 1e-3);
        EXPECT_NEAR(bench.angle_z(lift), 0, 1e-3);
    }
}

TEST(Joint, SliderStopsAtItsLimits) {
    JointBench bench;
    const BodyRow post = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
    const BodyRow lift = bench.add(cube(0.3, vec(1, 0, 0)));
    JointDefinition slider =
        along_y(join(JointKind::slider, post, lift, vec(1, 0, 0), vec(0, 0, 0)));
    slider.has_limit = true;
    slider.length_min = real(-0.5);
    slider.length_max = real(0.25);
    bench.add(slider);
    bench.run(180);
    EXPECT_NEAR(bench.position(lift, 1), -0.5, 1e-3);
    bench.motion(lift).linear_velocity[1] = 8 << 20;
    double highest = -1;
    for (int tick = 0; tick < 60; ++tick) {
        bench.step();
        highest = std::max(highest, bench.position(lift, 1));
    }
    EXPECT_NEAR(highest, 0.25, 5e-3);
}

TEST(Joint, WeldHoldsACantilever) {
    JointBench bench;
    BodyRow last = bench.add(fixed(cube(0.2, vec(0, 0, 0))));
    for (int index = 0; index < 4; ++index) {
        const BodyRow next = bench.add(cube(0.2, vec(0.4 * (index + 1), 0, 0)));
        bench.add(join(JointKind::fixed, last, next, vec(0.2, 0, 0), vec(-0.2, 0, 0)));
        last = next;
    }
    double lowest = 0;
    for (int tick = 0; tick < 600; ++tick) {
        bench.step();
        lowest = std::min(lowest, bench.position(last, 1));
    }
    EXPECT_GT(lowest, -0.06);
    EXPECT_LT(bench.speed(last), 1e-3);
}

/// A long lever couples place and angle nearly fully: ten metres on a block of 10 cm.
TEST(Joint, WeldHoldsALongLever) {
    JointBench bench;
    const BodyRow post = bench.add(fixed(cube(0.2, vec(0, 0, 0))));
    const BodyRow tip = bench.add(cube(0.05, vec(10, 0, 0)));
    bench.add(join(JointKind::fixed, post, tip, vec(0, 0, 0), vec(-10, 0, 0)));
    double lowest = 0;
    for (int tick = 0; tick < 600; ++tick) {
        bench.step();
        lowest = std::min(lowest, bench.position(tip, 1));
    }
    EXPECT_GT(lowest, -0.01);
}

/// k = m (2 pi f)^2, so that the deflection m g / k is g / (2 pi f)^2.
TEST(Joint, SuspensionSinksByWeightOverStiffness) {
    JointBench bench;
    const BodyRow frame = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
    const BodyRow wheel = bench.add(ball(0.3, vec(0, -0.5, 0)));
    JointDefinition joint =
        along_y(join(JointKind::wheel, frame, wheel, vec(0, -0.5, 0), vec(0, 0, 0)));
    joint.has_spring = true;
    joint.spring_hertz = 2;
    joint.spring_damping = real(0.7);
    joint.has_motor = true;
    joint.motor_speed = 12;
    joint.motor_max = 1000;
    bench.add(joint);
    bench.run(300);
    const double stiffness = kTurn * 2 * kTurn * 2;
    EXPECT_NEAR(-0.5 - bench.position(wheel, 1), kGravity / stiffness, 1e-4);
    EXPECT_NEAR(bench.position(wheel, 0), 0, 1e-4);
    EXPECT_NEAR(bench.spin(wheel, 2), 12, 0.01); // about the joint's z, which is the bodies'
}

TEST(Joint, ConeTwistStaysInConeAndTwist) {
    JointBench bench;
    const BodyRow post = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
    const BodyRow limb = bench.add(box(0.5, 0.1, 0.1, vec(0.5, 0, 0)));
    JointDefinition joint = join(JointKind::cone_twist, post, limb, vec(0, 0, 0), vec(-0.5, 0, 0));
    joint.has_limit = true;
    joint.angle_min = real(-0.4);
    joint.angle_max = real(0.4);
    joint.swing_max = real(0.6);
    bench.add(joint);
    bench.motion(limb).angular_velocity[0] = 1 << 20;
    bench.motion(limb).angular_velocity[1] = 2 << 20;
    double swing = 0;
    double twist = 0;
    for (int tick = 0; tick < 600; ++tick) {
        bench.step();
        const std::int32_t* q = bench.motion(limb).orientation;
        const Vector x = rotated(q, {1, 0, 0});
        swing = std::max(swing, std::acos(x[0]));
        twist = std::max(twist, std::abs(2 * std::atan2(q[0], q[3])));
        EXPECT_LT(bench.gap(0), 2e-3);
    }
    EXPECT_NEAR(swing, 0.6, 0.02);
    EXPECT_NEAR(twist, 0.4, 0.02);
}

TEST(Joint, GrabBringsItsBodyAndHoldsIt) {
    for (const double force_by_weight : {0.0, 4.0, 0.5}) {
        JointBench bench;
        BodyDefinition body = cube(0.2, vec(0, 0, 0));
        body.mass = 2;
        const BodyRow held = bench.add(body);
        JointDefinition grab = join(JointKind::grab, 0, held, vec(0, 0, 0), vec(0, 0, 0));
        grab.body_a = 0;
        grab.spring_hertz = 3;
        grab.target = vec(1, 2, -1);
        grab.motor_max = real(force_by_weight * 2 * kGravity);
        bench.add(grab);
        bench.run(300);
        const double stiffness = kTurn * 3 * kTurn * 3;
        if (force_by_weight == 0.5) {
            EXPECT_LT(bench.position(held, 1), -50);
            continue;
        }
        EXPECT_NEAR(bench.position(held, 0), 1, 1e-3);
        EXPECT_NEAR(bench.position(held, 1), 2 - kGravity / stiffness, 1e-3);
        EXPECT_NEAR(bench.position(held, 2), -1, 1e-3);
        bench.joint(0).target[0] = -(std::int64_t{3} << 32);
        bench.run(300);
        EXPECT_NEAR(bench.position(held, 0), -3, 1e-3);
    }
}

bool breaks_within(JointBench& bench, int ticks) {
    bool breaks = false;
    for (int tick = 0; tick < ticks; ++tick) {
        bench.step();
        breaks = breaks || !bench.dynamics().broken_joints().empty();
    }
    return breaks;
}

TEST(Joint, BreaksAboveItsForceAndHoldsBelow) {
    for (const double part : {0.99, 1.01}) {
        JointBench bench;
        const BodyRow top = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
        BodyDefinition body = cube(0.2, vec(0, -1, 0));
        body.mass = 5;
        const BodyRow weight = bench.add(body);
        JointDefinition hook = join(JointKind::ball, top, weight, vec(0, 0, 0), vec(0, 1, 0));
        hook.break_force = real(part * 5 * kGravity);
        bench.add(hook);
        EXPECT_EQ(breaks_within(bench, 300), part < 1) << part;
    }
}

/// torque = m g L at the weld.
TEST(Joint, BreaksAboveItsTorqueAndHoldsBelow) {
    for (const double part : {0.97, 1.03}) {
        JointBench bench;
        const BodyRow wall = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
        BodyDefinition body = cube(0.2, vec(2, 0, 0));
        body.mass = 5;
        const BodyRow weight = bench.add(body);
        JointDefinition weld = join(JointKind::fixed, wall, weight, vec(0, 0, 0), vec(-2, 0, 0));
        weld.break_torque = real(part * 5 * kGravity * 2);
        bench.add(weld);
        EXPECT_EQ(breaks_within(bench, 300), part < 1) << part;
    }
}

TEST(Joint, JoinedBodiesMeetOnlyWhereTheyMay) {
    for (const bool collide : {false, true}) {
        JointBench bench(JointBench::weightless());
        const BodyRow a = bench.add(cube(0.5, vec(0, 0, 0)));
        const BodyRow b = bench.add(cube(0.5, vec(0.8, 0, 0)));
        JointDefinition joint = join(JointKind::distance, a, b, vec(0, 0, 0), vec(0, 0, 0));
        joint.has_limit = true;
        joint.length_max = 3;
        joint.collide_connected = collide;
        bench.add(joint);
        bench.run(120);
        EXPECT_EQ(bench.position(b, 0) - bench.position(a, 0) > 0.9, collide);
        wake_joined(bench.tables(), bench.state().joints[0]); // they may again
        bench.state().joint_count = 0;
        bench.state().joints[0] = Joint{};
        bench.run(120);
        EXPECT_GT(bench.position(b, 0) - bench.position(a, 0), 0.9);
    }
}

} // namespace
} // namespace lockwind
