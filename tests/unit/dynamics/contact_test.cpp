#include "tests/unit/dynamics/dynamics_bench.h"

#include <numbers>
#include <random>

namespace lockwind {
namespace {

constexpr double kGravity = 9.81;

WorldSettings weightless() {
    WorldSettings settings;
    settings.gravity = vec(0, 0, 0);
    return settings;
}

/// A cube lying on a slope of `angle`, friction 0.5.
struct Slope {
    explicit Slope(double angle) : bench({}, 4) {
        bench.add(ground(angle));
        BodyDefinition body = cube(0.5, vec(-0.5 * std::sin(angle), 0.5 * std::cos(angle), 0));
        body.orientation = {0, 0, real(std::sin(angle / 2)), real(std::cos(angle / 2))};
        row = bench.add(body);
    }
    DynamicsBench bench;
    BodyRow row = 0;
};

TEST(Friction, CubeSticksBelowTheFrictionAngle) {
    Slope slope(std::atan(0.5) - 0.01);
    slope.bench.run(300);
    EXPECT_LT(slope.bench.speed(slope.row), 1e-3);
    EXPECT_NEAR(slope.bench.position(slope.row, 0), -0.5 * std::sin(std::atan(0.5) - 0.01), 0.02);
}

TEST(Friction, CubeSlidesAboveTheFrictionAngle) {
    for (const double angle : {0.55, 0.7, 0.9}) {
        Slope slope(angle);
        slope.bench.run(30);
        const double before = slope.bench.speed(slope.row);
        slope.bench.run(60);
        const double expected = kGravity * (std::sin(angle) - 0.5 * std::cos(angle));
        EXPECT_NEAR(slope.bench.speed(slope.row) - before, expected, 0.01 * expected) << angle;
    }
}

TEST(Friction, SlidingCubeStopsAfterTheClosedFormDistance) {
    DynamicsBench bench({}, 4);
    bench.add(ground());
    BodyDefinition body = cube(0.5, vec(0, 0.5, 0));
    body.linear_velocity = vec(3, 0, 4);
    const BodyRow row = bench.add(body);
    bench.run(120);
    const double distance = 5 * 5 / (2 * 0.5 * kGravity);
    EXPECT_LT(bench.speed(row), 1e-3);
    EXPECT_NEAR(bench.position(row, 0), 0.6 * distance, 0.02 * distance);
    EXPECT_NEAR(bench.position(row, 2), 0.8 * distance, 0.02 * distance);
}

TEST(Friction, SpinningCubeIsBrakedByTwist) {
    DynamicsBench bench({}, 4);
    bench.add(ground());
    BodyDefinition body = cube(0.5, vec(0, 0.5, 0));
    body.angular_velocity = vec(0, 10, 0);
    const BodyRow row = bench.add(body);
    bench.run(6);
    const double before = bench.spin(row, 1);
    bench.run(12);
    // Torque mu m g r with its points at r = 0.5 sqrt 2, inertia m / 6.
    const double braking = 0.5 * kGravity * 0.5 * std::numbers::sqrt2 * 6;
    EXPECT_NEAR(before - bench.spin(row, 1), braking * 0.2, 0.05 * braking * 0.2);
    bench.run(60);
    EXPECT_NEAR(bench.spin(row, 1), 0, 1e-3);
}

TEST(Friction, GeometricMeanOfThePartners) {
    DynamicsBench bench({}, 4);
    BodyDefinition floor = ground();
    floor.friction = 0.25;
    bench.add(floor);
    BodyDefinition body = cube(0.5, vec(0, 0.5, 0));
    body.friction = 0.81;
    body.linear_velocity = vec(8, 0, 0);
    const BodyRow row = bench.add(body);
    bench.run(30);
    const double before = bench.velocity(row, 0);
    bench.run(30);
    const double expected = 0.45 * kGravity * 0.5;
    EXPECT_NEAR(before - bench.velocity(row, 0), expected, 0.02 * expected);
}

TEST(Rolling, BallRollsDownASlopeAtFiveSevenths) {
    const double angle = 0.3;
    DynamicsBench bench({}, 4);
    bench.add(ground(angle));
    const BodyRow row = bench.add(ball(0.5, vec(-0.5 * std::sin(angle), 0.5 * std::cos(angle), 0)));
    bench.run(30);
    const double before = bench.speed(row);
    bench.run(60);
    const double expected = 5.0 / 7 * kGravity * std::sin(angle);
    EXPECT_NEAR(bench.speed(row) - before, expected, 0.01 * expected);
    EXPECT_NEAR(bench.spin(row, 2) * 0.5, bench.speed(row), 0.01 * bench.speed(row));
}

TEST(Rolling, SlidingBallComesToRollAtFiveSevenths) {
    DynamicsBench bench({}, 4);
    bench.add(ground());
    BodyDefinition body = ball(0.5, vec(0, 0.5, 0));
    body.linear_velocity = vec(7, 0, 0);
    const BodyRow row = bench.add(body);
    bench.run(180);
    EXPECT_NEAR(bench.velocity(row, 0), 5, 0.02);
    EXPECT_NEAR(bench.spin(row, 2), -10, 0.05);
    const double rolling = bench.velocity(row, 0);
    bench.run(300);
    EXPECT_NEAR(bench.velocity(row, 0), rolling, 0.01) << "rolling has no friction";
}

TEST(Rolling, CapsuleRollsOnItsSide) {
    const double angle = 0.2;
    DynamicsBench bench({}, 4);
    bench.add(ground(angle));
    BodyDefinition body = ball(0.5, vec(-0.5 * std::sin(angle), 0.5 * std::cos(angle), 0));
    body.shape.type = ShapeType::capsule;
    body.shape.half_height = 0.5;
    const double half = std::numbers::sqrt2 / 2;
    body.orientation = {real(half), 0, 0, real(half)};
    const BodyRow row = bench.add(body);
    bench.run(30);
    const double before = bench.speed(row);
    bench.run(60);
    const double k2 = 1 / std::ldexp(bench.properties(row).inverse_inertia[1], -26) *
                      std::pow(std::ldexp(bench.properties(row).gyration_radius, -22), 2);
    const double expected = kGravity * std::sin(angle) / (1 + k2 / 0.25);
    EXPECT_NEAR(bench.speed(row) - before, expected, 0.02 * expected);
}

struct Collision {
    double mass_a;
    double mass_b;
    double restitution;
};

class HeadOn : public testing::TestWithParam<Collision> {};

TEST_P(HeadOn, SpeedsAreNewtons) {
    const auto [mass_a, mass_b, restitution] = GetParam();
    DynamicsBench bench(weightless(), 4);
    BodyDefinition a = ball(0.5, vec(-1, 0, 0));
    a.mass = real(mass_a);
    a.restitution = real(restitution);
    a.linear_velocity = vec(6, 0, 0);
    BodyDefinition b = ball(0.5, vec(1, 0, 0));
    b.mass = real(mass_b);
    b.linear_velocity = vec(-3, 0, 0);
    const BodyRow row_a = bench.add(a);
    const BodyRow row_b = bench.add(b);
    bench.run(60);
    const double momentum = mass_a * 6 - mass_b * 3;
    const double common = momentum / (mass_a + mass_b);
    EXPECT_NEAR(
        bench.velocity(row_a, 0), common - restitution * 9 * mass_b / (mass_a + mass_b), 0.06);
    EXPECT_NEAR(
        bench.velocity(row_b, 0), common + restitution * 9 * mass_a / (mass_a + mass_b), 0.06);
    EXPECT_NEAR(mass_a * bench.velocity(row_a, 0) + mass_b * bench.velocity(row_b, 0),
                momentum,
                1e-4 * (mass_a + mass_b));
}

INSTANTIATE_TEST_SUITE_P(Restitution,
                         HeadOn,
                         testing::Values(Collision{1, 1, 1},
                                         Collision{1, 1, 0.5},
                                         Collision{1, 1, 0},
                                         Collision{2, 1, 1},
                                         Collision{1, 100, 0.7},
                                         Collision{1000, 1, 1}));

TEST(Restitution, BallBouncesBackToTheSquareOfIt) {
    for (const double restitution : {0.3, 0.6, 0.9}) {
        DynamicsBench bench({}, 4);
        bench.add(ground());
        BodyDefinition body = ball(0.25, vec(0, 5.25, 0));
        body.restitution = real(restitution);
        const BodyRow row = bench.add(body);
        double top = 0;
        bool bounced = false;
        for (int tick = 0; tick < 180; ++tick) {
            bench.step();
            bounced = bounced || bench.velocity(row, 1) > 0;
            if (bounced) {
                top = std::max(top, bench.position(row, 1) - 0.25);
            }
            if (bounced && bench.velocity(row, 1) < 0) {
                break;
            }
        }
        const double expected = 5 * restitution * restitution;
        EXPECT_NEAR(top, expected, 0.06 * 5) << restitution;
    }
}

TEST(Restitution, SlowContactsDoNotBounce) {
    DynamicsBench bench({}, 4);
    bench.add(ground());
    BodyDefinition body = ball(0.25, vec(0, 0.27, 0));
    body.restitution = 1;
    const BodyRow row = bench.add(body);
    bench.run(60);
    EXPECT_NEAR(bench.position(row, 1), 0.25, 0.006);
    EXPECT_LT(bench.speed(row), 1e-3);
}

TEST(Restitution, ElasticBilliardKeepsItsEnergy) {
    WorldSettings settings = weightless();
    DynamicsBench bench(settings, 16);
    for (const double side : {-4.0, 4.0}) {
        bench.add(fixed(box(0.5, 5, 5, vec(side, 0, 0))));
        bench.add(fixed(box(5, 0.5, 5, vec(0, side, 0))));
    }
    BodyDefinition body = ball(0.5, vec(0, 0, 0));
    body.restitution = 1;
    body.friction = 0;
    body.linear_velocity = vec(5, 3, 0);
    const BodyRow row = bench.add(body);
    bench.run(600);
    EXPECT_NEAR(bench.speed(row), std::hypot(5, 3), 0.2);
}

TEST(Contact, HitsTellTheImpulseOverTheReducedMass) {
    DynamicsBench bench(weightless(), 4);
    BodyDefinition a = ball(0.5, vec(-0.55, 0, 0));
    a.linear_velocity = vec(4, 0, 0);
    const BodyRow row_a = bench.add(a);
    const BodyRow row_b = bench.add(ball(0.5, vec(0.55, 0, 0)));
    int hits = 0;
    for (int tick = 0; tick < 30; ++tick) {
        bench.step();
        for (const ContactHit& hit : bench.dynamics().contact_hits()) {
            ++hits;
            EXPECT_EQ(hit.row_a, row_a);
            EXPECT_EQ(hit.row_b, row_b);
            EXPECT_NEAR(std::ldexp(hit.impulse, -20), 4, 0.2);
        }
    }
    EXPECT_EQ(hits, 1);
}

TEST(Contact, BeginsAndEndsAreToldOnceInPairOrder) {
    DynamicsBench bench({}, 8);
    bench.add(ground());
    bench.add(ball(0.5, vec(0, 0.5, 0)));
    bench.add(ball(0.5, vec(3, 0.5, 0)));
    bench.step();
    ASSERT_EQ(bench.dynamics().contact_changes().size(), 2U);
    EXPECT_EQ(bench.dynamics().contact_changes()[0].row_b, 1U);
    EXPECT_EQ(bench.dynamics().contact_changes()[1].row_b, 2U);
    bench.motion(1).linear_velocity[1] = 3 << 20;
    std::vector<bool> changes;
    for (int tick = 0; tick < 55; ++tick) {
        bench.step();
        for (const ContactChange& change : bench.dynamics().contact_changes()) {
            EXPECT_EQ(change.row_b, 1U);
            changes.push_back(change.begin);
        }
    }
    EXPECT_EQ(changes, (std::vector<bool>{false, true}));
}

TEST(Contact, KinematicPlatformCarriesAndSpinsWhatStandsOnIt) {
    DynamicsBench bench({}, 4);
    BodyDefinition platform = box(20, 0.5, 20, vec(0, -0.5, 0));
    platform.mode = BodyMode::kinematic;
    platform.linear_velocity = vec(1, 0, 0);
    platform.angular_velocity = vec(0, 0.5, 0);
    const BodyRow base = bench.add(platform);
    const BodyRow row = bench.add(cube(0.5, vec(0, 0.5, 0)));
    bench.run(120);
    EXPECT_NEAR(bench.spin(row, 1), 0.5, 0.01);
    EXPECT_NEAR(bench.position(row, 0), bench.position(base, 0), 0.15);
    EXPECT_EQ(bench.velocity(base, 0), 1);
}

/// Boxes of one metre, bottom first; the last one may be heavier.
void add_column(DynamicsBench& bench, int count, double top_mass) {
    for (int index = 0; index < count; ++index) {
        BodyDefinition body = cube(0.5, vec(0, 0.5 + index, 0));
        body.mass = real(index + 1 == count ? top_mass : 1);
        bench.add(body);
    }
}

TEST(Stack, TenBoxesStandUnderATenfoldTop) {
    DynamicsBench bench;
    bench.add(fixed(box(100, 1, 100, vec(0, -1, 0))));
    add_column(bench, 10, 10);
    bench.run(1200);
    for (BodyRow row = 1; row <= 10; ++row) {
        EXPECT_NEAR(bench.position(row, 1), row - 0.5, 0.1);
        EXPECT_NEAR(bench.position(row, 0), 0, 0.05);
        EXPECT_NEAR(bench.position(row, 2), 0, 0.05);
    }
}

TEST(Stack, ColumnComesToRest) {
    DynamicsBench bench;
    bench.add(ground());
    add_column(bench, 10, 1);
    bench.run(600);
    for (BodyRow row = 1; row <= 10; ++row) {
        for (int axis = 0; axis < 3; ++axis) {
            // Units of 2^-20 m/s: a limit cycle of rounding is all that is left.
            EXPECT_LE(std::abs(bench.motion(row).linear_velocity[axis]), 100);
            EXPECT_LE(std::abs(bench.motion(row).angular_velocity[axis]), 100);
        }
    }
}

TEST(Stack, PyramidOf210Drifts3CentimetresIn600Ticks) {
    DynamicsBench bench;
    bench.add(fixed(box(100, 1, 100, vec(0, -1, 0))));
    std::vector<Vec3> start;
    for (int level = 0; level < 20; ++level) {
        for (int index = 0; index < 20 - level; ++index) {
            start.push_back(vec((index - (19 - level) * 0.5) * 1.05, 0.5 + level, 0));
            BodyDefinition body = cube(0.5, start.back());
            body.mass = 1;
            bench.add(body);
        }
    }
    bench.run(600);
    double drift = 0;
    for (BodyRow row = 1; row <= 210; ++row) {
        const Vec3& from = start[row - 1];
        const double off[3] = {bench.position(row, 0) - std::ldexp(from.x.raw(), -32),
                               bench.position(row, 1) - std::ldexp(from.y.raw(), -32),
                               bench.position(row, 2) - std::ldexp(from.z.raw(), -32)};
        drift = std::max(drift, std::hypot(off[0], off[1], off[2]));
    }
    EXPECT_LT(drift, 0.035);
}

TEST(Stack, DeepOverlapIsPushedOutSlowly) {
    DynamicsBench bench({}, 4);
    bench.add(ground());
    // Ten metres deep: the separation in velocity units once left the format at 8.5 m.
    const BodyRow row = bench.add(box(6, 6, 6, vec(0, -4, 0)));
    double fastest = 0;
    for (int tick = 0; tick < 300; ++tick) {
        bench.step();
        fastest = std::max(fastest, bench.speed(row));
    }
    EXPECT_NEAR(bench.position(row, 1), 6, 0.02);
    EXPECT_LT(fastest, 3.3);
}

/// A cloud of boxes and balls that falls in on itself without gravity.
template <class Mass>
void add_cloud(DynamicsBench& bench, Mass&& mass_of) {
    std::mt19937 random(3);
    for (int x = 0; x < 4; ++x) {
        for (int y = 0; y < 4; ++y) {
            for (int z = 0; z < 4; ++z) {
                const double at[3] = {(x - 1.5) * 1.5, (y - 1.5) * 1.5, (z - 1.5) * 1.5};
                const Vec3 position = vec(at[0], at[1], at[2]);
                BodyDefinition body = random() % 2 == 0 ? ball(0.5, position) : cube(0.5, position);
                body.linear_velocity = vec(-at[0], -at[1], -at[2]);
                body.mass = mass_of(random());
                bench.add(body);
            }
        }
    }
}

TEST(Momentum, OfEqualMassesIsConservedToTheLastBit) {
    DynamicsBench bench(weightless(), 64);
    add_cloud(bench, [](std::uint64_t) { return Real(1); });
    std::int64_t before[3] = {};
    std::int64_t after[3] = {};
    const auto sum = [&](std::int64_t out[3]) {
        for (BodyRow row = 0; row < 64; ++row) {
            for (int axis = 0; axis < 3; ++axis) {
                out[axis] += bench.motion(row).linear_velocity[axis];
            }
        }
    };
    sum(before);
    std::uint32_t contacts = 0;
    for (int tick = 0; tick < 180; ++tick) {
        bench.step();
        contacts = std::max(contacts, bench.state().manifold_count);
    }
    sum(after);
    EXPECT_GT(contacts, 50U);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(before[axis], after[axis]);
    }
}

TEST(Momentum, OfMixedMassesIsConservedToRounding) {
    DynamicsBench bench(weightless(), 64);
    add_cloud(bench, [](std::uint64_t random) { return Real(1 + random % 50); });
    const auto mass_of = [&](BodyRow row) {
        return std::ldexp(1, 40) / static_cast<double>(bench.properties(row).inverse_mass);
    };
    double before[3] = {};
    double after[3] = {};
    double mass = 0;
    const auto sum = [&](double out[3]) {
        for (BodyRow row = 0; row < 64; ++row) {
            for (int axis = 0; axis < 3; ++axis) {
                out[axis] += mass_of(row) * bench.velocity(row, axis);
            }
        }
    };
    for (BodyRow row = 0; row < 64; ++row) {
        mass += mass_of(row);
    }
    sum(before);
    bench.run(180);
    sum(after);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(before[axis], after[axis], 1e-4 * mass);
    }
}

/// A heavy body sinks into a light one that bears it: 4 mm at 10:1, 34 cm at 1000:1, but it stands.
TEST(MassRatio, HeavyBoxStandsOnALightOne) {
    struct Sag {
        double ratio;
        double depth_max;
    };
    for (const Sag& sag : {Sag{10, 0.01}, Sag{100, 0.05}, Sag{1000, 0.4}}) {
        DynamicsBench bench({}, 4);
        bench.add(fixed(box(100, 1, 100, vec(0, -1, 0))));
        add_column(bench, 2, sag.ratio);
        bench.run(600);
        EXPECT_NEAR(bench.position(2, 1), 1.5, sag.depth_max) << sag.ratio;
        EXPECT_NEAR(bench.position(2, 0), 0, 0.05) << sag.ratio;
        EXPECT_LT(bench.speed(2), 0.02) << sag.ratio;
    }
}

/// Far beyond what can be borne: the light box is crushed, but no impulse leaves its format.
TEST(MassRatio, MillionfoldIsCrushedWithinTheFormats) {
    DynamicsBench bench({}, 8);
    bench.add(ground());
    BodyDefinition light = cube(0.5, vec(0, 0.5, 0));
    light.mass = real(0.001);
    light.friction = 4;
    bench.add(light);
    BodyDefinition heavy = cube(0.5, vec(0, 1.5, 0));
    heavy.mass = 1000000;
    heavy.friction = 4;
    heavy.linear_velocity = vec(1, -20, 0);
    bench.add(heavy);
    for (int tick = 0; tick < 600; ++tick) {
        bench.step();
        for (const ContactImpulse& impulse : bench.tables().impulses.rows()) {
            for (const std::int32_t normal : impulse.normal) {
                ASSERT_GE(normal, 0);
                ASSERT_LE(normal, 960 << 20);
            }
        }
    }
    EXPECT_GT(bench.position(2, 1), 0.4);
    EXPECT_LT(bench.position(2, 1), 2);
}

/// Bodies that touch and part: the gap grows by 2 m in a substep, and nothing is pushed.
TEST(Contact, WhatFliesApartFastIsLeftAlone) {
    for (const std::uint32_t substeps : {1U, 4U, 16U}) {
        WorldSettings settings;
        settings.gravity = vec(0, 0, 0);
        settings.substeps = substeps;
        settings.linear_speed_max = 500;
        DynamicsBench bench(settings, 4);
        bench.add(fixed(cube(1, vec(0, 0, 0))));
        BodyDefinition flying = ball(0.2, vec(1.205, 0, 0));
        flying.linear_velocity = vec(480, 3, 0);
        const BodyRow row = bench.add(flying);
        bench.step();
        EXPECT_EQ(bench.state().manifold_count, 1U);
        EXPECT_EQ(bench.velocity(row, 0), 480) << substeps;
        EXPECT_EQ(bench.velocity(row, 1), 3) << substeps;
        EXPECT_EQ(bench.spin(row, 2), 0) << substeps;
    }
}

} // namespace
} // namespace lockwind
