#include "tests/support/dice.h"
#include "tests/unit/dynamics/joint_bench.h"

namespace lockwind {
namespace {

using testing::Dice; // NOLINT(misc-unused-using-decls): GoogleTest has a namespace of that name

/// Links of 1 kg and 0.5 m under a weight, which gets a push.
class Chain {
public:
    Chain(double weight, std::uint32_t substeps, bool numbered_up = false)
        : bench_(settings(substeps)) {
        constexpr int kLinks = 10;
        const BodyRow top = bench_.add(fixed(cube(0.1, vec(0, 0.1, 0))));
        std::vector<JointDefinition> joints;
        BodyRow last = top;
        for (int link = 0; link < kLinks; ++link) {
            BodyDefinition body = box(0.05, 0.25, 0.05, vec(0, -0.25 - 0.5 * link, 0));
            body.mass = 1;
            const BodyRow row = bench_.add(body);
            const double half = link == 0 ? 0.1 : 0.25;
            joints.push_back(join(JointKind::ball, last, row, vec(0, -half, 0), vec(0, 0.25, 0)));
            last = row;
        }
        BodyDefinition body = cube(0.5, vec(0, -0.5 * kLinks - 0.5, 0));
        body.mass = real(weight);
        weight_ = bench_.add(body);
        joints.push_back(join(JointKind::ball, last, weight_, vec(0, -0.25, 0), vec(0, 0.5, 0)));
        if (numbered_up) {
            std::reverse(joints.begin(), joints.end());
        }
        for (const JointDefinition& joint : joints) {
            bench_.add(joint);
        }
        bench_.motion(weight_).linear_velocity[0] = 3 << 20;
    }
    double worst_gap(int ticks) {
        double worst = 0;
        for (int tick = 0; tick < ticks; ++tick) {
            bench_.step();
            worst = std::max(worst, bench_.worst_gap());
        }
        return worst;
    }
    JointBench& bench() { return bench_; }
    BodyRow weight() const { return weight_; }

private:
    static WorldSettings settings(std::uint32_t substeps) {
        WorldSettings settings;
        settings.substeps = substeps;
        return settings;
    }
    JointBench bench_;
    BodyRow weight_ = 0;
};

TEST(JointStability, ChainsHoldTheirWeight) {
    const struct {
        double weight;
        std::uint32_t substeps;
        double gap_max;
    } cases[] = {{1, 4, 0.004}, {100, 4, 0.05}, {100, 8, 0.015}, {1000, 8, 0.15}, {1000, 16, 0.05}};
    for (const auto& c : cases) {
        for (const bool up : {false, true}) {
            Chain chain(c.weight, c.substeps, up);
            const double gap = chain.worst_gap(600);
            EXPECT_LT(gap, c.gap_max) << c.weight << " kg, " << c.substeps << " substeps";
            std::cout << c.weight << " kg, " << c.substeps << " substeps: " << 1000 * gap
                      << " mm\n";
        }
    }
}

/// A pendulum of a heavy weight gains nothing.
TEST(JointStability, ChainsGainNoEnergy) {
    Chain chain(100, 4);
    const double start = 9.0 / 2 + 9.81 * -5.5;
    double highest = start;
    for (int tick = 0; tick < 600; ++tick) {
        chain.bench().step();
        const double now = chain.bench().energy(chain.weight(), 1.0 / 6);
        highest = std::max(highest, now);
    }
    EXPECT_LT(highest, start + 0.25);
}

/// A rotor on a hinge at its end turns by up to 0.08 rad a substep.
TEST(JointStability, FastHingeStaysExact) {
    const struct {
        double speed; // rad/s
        double off;   // m
        double kept;
    } cases[] = {{99, 0, 0.9999}, {10, 0.5, 0.9995}, {20, 0.5, 0.99}};
    for (const auto& c : cases) {
        JointBench bench(JointBench::weightless());
        const BodyRow post = bench.add(fixed(cube(0.1, vec(0, 0, 0))));
        BodyDefinition body = box(0.4, 0.1, 0.2, vec(c.off, 0, 0));
        body.angular_velocity = vec(0, 0, c.speed);
        body.linear_velocity = vec(0, c.speed * c.off, 0);
        const BodyRow rotor = bench.add(body);
        bench.add(about_z(join(JointKind::hinge, post, rotor, vec(0, 0, 0), vec(-c.off, 0, 0))));
        double gap = 0;
        double tilt = 0;
        for (int tick = 0; tick < 600; ++tick) {
            bench.step();
            gap = std::max(gap, bench.gap(0));
            tilt = std::max(
                tilt,
                std::acos(std::min(1.0, rotated(bench.motion(rotor).orientation, {0, 0, 1})[2])));
        }
        std::cout << c.speed << " rad/s, " << c.off << " m off: gap " << 1000 * gap << " mm, tilt "
                  << tilt << " rad, speed " << bench.spin(rotor, 2) << " rad/s\n";
        EXPECT_LT(gap, 1e-3);
        EXPECT_LT(tilt, 1e-3);
        EXPECT_GT(bench.spin(rotor, 2), c.kept * c.speed);
        EXPECT_LT(bench.spin(rotor, 2), 1.0001 * c.speed);
    }
}

/// Beads of 2 cm hang by springs of 60 Hz between them: the second joint bears nine beads by a
/// reduced mass of half a bead, and gives way by 18 g / (2 pi 60 Hz)^2.
TEST(JointStability, SmallBodiesHangAsTheirSoftnessSays) {
    JointBench bench;
    BodyRow last = bench.add(fixed(cube(0.01, vec(0, 0, 0))));
    for (int link = 0; link < 10; ++link) {
        const BodyRow next = bench.add(ball(0.01, vec(0, -0.02 * (link + 1), 0)));
        bench.add(join(JointKind::ball, last, next, vec(0, -0.01, 0), vec(0, 0.01, 0)));
        last = next;
    }
    double gap = 0;
    bench.motion(last).linear_velocity[0] = 1 << 14; // 16 mm/s
    for (int tick = 0; tick < 600; ++tick) {
        bench.step();
        gap = std::max(gap, bench.worst_gap());
    }
    const double expected = 18 * 9.81 / std::pow(2 * std::numbers::pi * 60, 2);
    std::cout << "2 cm beads: gap " << 1e6 * gap << " um, at rest " << 1e6 * bench.worst_gap()
              << " um, " << bench.speed(last) << " m/s\n";
    EXPECT_NEAR(bench.worst_gap(), expected, 0.05 * expected);
    EXPECT_LT(gap, 1.5 * expected);
    EXPECT_LT(bench.speed(last), 0.02);
}

TEST(JointStability, FreePairKeepsItsMomentum) {
    for (const double mass : {1.0, 3.0}) {
        JointBench bench(JointBench::weightless());
        BodyDefinition light = box(0.3, 0.1, 0.2, vec(0, 0, 0));
        light.mass = 1;
        light.linear_velocity = vec(1, 2, -1);
        light.angular_velocity = vec(3, -2, 1);
        BodyDefinition heavy = box(0.2, 0.3, 0.1, vec(0.7, 0, 0));
        heavy.mass = real(mass);
        const BodyRow a = bench.add(light);
        const BodyRow b = bench.add(heavy);
        bench.add(join(JointKind::ball, a, b, vec(0.4, 0, 0), vec(-0.3, 0, 0)));
        for (int tick = 0; tick < 600; ++tick) {
            bench.step();
        }
        const double start[3] = {1, 2, -1};
        for (int axis = 0; axis < 3; ++axis) {
            const double now = bench.velocity(a, axis) + mass * bench.velocity(b, axis);
            EXPECT_NEAR(now, start[axis], std::ldexp(200.0, -20)) << mass;
        }
        EXPECT_LT(bench.gap(0), 1e-3);
    }
}

BodyDefinition random_body(Dice& dice, const Vec3& place) {
    const double size = 0.05 + 0.01 * static_cast<double>(dice.below(40));
    BodyDefinition body =
        dice.chance(500) ? ball(size, place) : box(size, 0.3, 0.5 * size + 0.05, place);
    body.mass = real(0.1 * static_cast<double>(dice.between(1, 300)));
    return body;
}

/// `driven`: with motors, springs and grabs.
void add_random_joint(Dice& dice, JointBench& bench, BodyRow a, BodyRow b, bool driven) {
    const auto draw = [&](double size) {
        return size * (static_cast<double>(dice.below(2001)) / 1000 - 1);
    };
    constexpr JointKind kPassive[] = {JointKind::distance,
                                      JointKind::ball,
                                      JointKind::hinge,
                                      JointKind::slider,
                                      JointKind::fixed,
                                      JointKind::wheel,
                                      JointKind::cone_twist};
    const JointKind kind =
        driven && dice.chance(125) ? JointKind::grab : kPassive[dice.below(std::size(kPassive))];
    JointDefinition joint = join(kind, a, b, vec(0, 0, 0), vec(draw(0.6), draw(0.6), draw(0.6)));
    // Together at the start, where no body is turned.
    joint.anchor_a = {joint.anchor_b.x + real(bench.position(b, 0) - bench.position(a, 0)),
                      joint.anchor_b.y + real(bench.position(b, 1) - bench.position(a, 1)),
                      joint.anchor_b.z + real(bench.position(b, 2) - bench.position(a, 2))};
    joint.frame_a = {real(draw(1)), real(draw(1)), real(draw(1)), real(0.3)};
    joint.frame_b = joint.frame_a;
    const bool has_axis =
        kind == JointKind::hinge || kind == JointKind::slider || kind == JointKind::wheel;
    joint.has_limit = kind == JointKind::distance || kind == JointKind::cone_twist ||
                      (has_axis && dice.chance(500));
    joint.length_max = real(1 + draw(0.5));
    joint.angle_min = real(-0.5);
    joint.angle_max = real(0.7);
    joint.swing_max = real(1 + draw(0.9));
    joint.has_motor = driven && has_axis && dice.chance(300);
    joint.motor_speed = real(draw(10));
    joint.motor_max = real(100 + draw(100));
    joint.has_spring = kind == JointKind::grab || (driven && has_axis && dice.chance(300));
    joint.spring_hertz = real(5 + draw(4));
    joint.collide_connected = dice.chance(200);
    if (kind == JointKind::grab) {
        joint.body_a = 0;
        joint.motor_max = 1000;
        joint.target = vec(draw(5), 3, draw(5));
    }
    bench.add(joint);
}

/// Bodies of 0.1 to 30 kg, each joined to one before it.
void add_random_tree(Dice& dice, JointBench& bench, bool driven) {
    bench.add(ground());
    for (int index = 0; index < 20; ++index) {
        bench.add(random_body(dice, vec(1.2 * (index % 5), 2 + index / 5, 0.3 * index)));
        const auto last = static_cast<BodyRow>(index + 1);
        if (index > 0) {
            add_random_joint(
                dice, bench, static_cast<BodyRow>(1 + dice.below(last - 1)), last, driven);
        }
    }
}

/// J, of translation and place: the rest is not negative.
double mechanical_energy(JointBench& bench) {
    double sum = 0;
    for (BodyRow row = 1; row <= 20; ++row) {
        const double mass =
            std::ldexp(1.0, 40) / static_cast<double>(bench.properties(row).inverse_mass);
        sum += mass * (bench.speed(row) * bench.speed(row) / 2 + 9.81 * bench.position(row, 1));
    }
    return sum;
}

TEST(JointStability, WhatNothingDrivesGainsNoEnergy) {
    double fastest = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        Dice dice(seed);
        JointBench bench;
        add_random_tree(dice, bench, false);
        const double start = mechanical_energy(bench);
        double most = 0;
        for (int tick = 0; tick < 600; ++tick) {
            bench.step();
            most = std::max(most, mechanical_energy(bench));
            for (BodyRow row = 1; row <= 20; ++row) {
                fastest = std::max(fastest, bench.speed(row));
            }
        }
        EXPECT_LT(most, 1.02 * start) << seed;
        EXPECT_LT(mechanical_energy(bench), 0.8 * start) << seed;
    }
    std::cout << "fastest body: " << fastest << " m/s\n";
}

/// A grab of 9 Hz draws from 10 m off at up to 570 m/s.
TEST(JointStability, DrivenRandomScenesDoNotExplode) {
    double fastest = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        Dice dice(seed);
        JointBench bench;
        add_random_tree(dice, bench, true);
        for (int tick = 0; tick < 600; ++tick) {
            bench.step();
            for (BodyRow row = 1; row <= 20; ++row) {
                ASSERT_LT(bench.speed(row), 570) << seed << " at " << tick;
                ASSERT_LT(std::abs(bench.position(row, 1)), 100) << seed << " at " << tick;
                fastest = std::max(fastest, bench.speed(row));
            }
        }
    }
    std::cout << "fastest body: " << fastest << " m/s\n";
}

/// A door, a chain and a grab about `x`; rows of joints and bodies in the order of the calls.
void add_group(JointBench& bench, double x) {
    const BodyRow post = bench.add(fixed(cube(0.1, vec(x, 3, 0))));
    const BodyRow door = bench.add(box(0.5, 0.4, 0.05, vec(x + 0.6, 3, 0)));
    const BodyRow tail = bench.add(ball(0.2, vec(x + 1.4, 3, 0)));
    bench.add(about_z(join(JointKind::hinge, post, door, vec(0.1, 0, 0), vec(-0.5, 0, 0))));
    bench.add(join(JointKind::ball, door, tail, vec(0.5, 0, 0), vec(-0.3, 0, 0)));
    bench.motion(tail).linear_velocity[2] = 2 << 20;
}

TEST(JointInvariance, OtherGroupsAndTheOriginChangeNoBit) {
    JointBench both;
    add_group(both, 0);
    add_group(both, 500);
    JointBench alone;
    add_group(alone, 500);
    for (int tick = 0; tick < 300; ++tick) {
        both.step();
        alone.step();
        for (BodyRow row = 1; row < 3; ++row) {
            for (const BodyRow other : {row, row + 3}) {
                const BodyMotion& a = alone.motion(row);
                const BodyMotion& b = both.motion(other);
                ASSERT_TRUE(std::equal(a.orientation, a.orientation + 4, b.orientation)) << tick;
                ASSERT_TRUE(std::equal(a.linear_velocity, a.linear_velocity + 3, b.linear_velocity))
                    << tick;
                ASSERT_TRUE(
                    std::equal(a.angular_velocity, a.angular_velocity + 3, b.angular_velocity))
                    << tick;
            }
        }
    }
    EXPECT_GT(alone.speed(2), 0.01);
}

TEST(JointInvariance, AFreshDynamicsGoesOnToTheSameBits) {
    JointBench straight;
    JointBench renewed;
    for (JointBench* bench : {&straight, &renewed}) {
        add_group(*bench, 0);
    }
    for (int tick = 0; tick < 200; ++tick) {
        renewed.renew();
        straight.step();
        renewed.step();
        ASSERT_TRUE(same_bits(straight.state(), renewed.state())) << tick;
    }
}

} // namespace
} // namespace lockwind
