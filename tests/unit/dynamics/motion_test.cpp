#include "tests/unit/dynamics/dynamics_bench.h"

#include <numbers>

namespace lockwind {
namespace {

constexpr double kGravity = 9.81;

WorldSettings weightless() {
    WorldSettings settings;
    settings.gravity = vec(0, 0, 0);
    return settings;
}

struct Rate {
    std::uint32_t tick_rate;
    std::uint32_t substeps;
};

class EveryRate : public testing::TestWithParam<Rate> {};

/// Semi-implicit Euler with step h falls g t (t + h) / 2 in t.
TEST_P(EveryRate, FreeFallIsTheClosedForm) {
    WorldSettings settings;
    settings.tick_rate_hz = GetParam().tick_rate;
    settings.substeps = GetParam().substeps;
    DynamicsBench bench(settings);
    const BodyRow row = bench.add(cube(0.5, vec(3, 100, -4)));
    bench.run(static_cast<int>(2 * settings.tick_rate_hz));
    const double t = 2;
    const double h = 1.0 / (settings.tick_rate_hz * settings.substeps);
    const double fall = kGravity * t * (t + h) / 2;
    EXPECT_NEAR(bench.position(row, 1), 100 - fall, 2e-5 * fall);
    EXPECT_NEAR(bench.velocity(row, 1), -kGravity * t, 2e-5 * kGravity * t);
    EXPECT_EQ(bench.position(row, 0), 3);
    EXPECT_EQ(bench.velocity(row, 2), 0);
}

TEST_P(EveryRate, SpinTurnsByItsAngle) {
    WorldSettings settings = weightless();
    settings.tick_rate_hz = GetParam().tick_rate;
    settings.substeps = GetParam().substeps;
    DynamicsBench bench(settings);
    BodyDefinition body = cube(0.5, vec(0, 0, 0));
    body.angular_velocity = vec(0, 2.5, 0);
    const BodyRow row = bench.add(body);
    bench.run(static_cast<int>(settings.tick_rate_hz));
    const std::int32_t* q = bench.motion(row).orientation;
    EXPECT_NEAR(2 * std::atan2(std::ldexp(q[1], -30), std::ldexp(q[3], -30)), 2.5, 1e-5);
    EXPECT_EQ(q[0], 0);
    EXPECT_EQ(q[2], 0);
}

INSTANTIATE_TEST_SUITE_P(Motion,
                         EveryRate,
                         testing::Values(Rate{60, 4},
                                         Rate{60, 1},
                                         Rate{10, 1},
                                         Rate{30, 8},
                                         Rate{144, 3},
                                         Rate{240, 16}));

TEST(Motion, ProjectileFliesTheParabola) {
    DynamicsBench bench;
    BodyDefinition body = ball(0.1, vec(0, 50, 0));
    body.linear_velocity = vec(12, 9, -5);
    const BodyRow row = bench.add(body);
    for (int tick = 1; tick <= 120; ++tick) {
        bench.step();
        const double t = tick / 60.0;
        EXPECT_NEAR(bench.position(row, 0), 12 * t, 1e-6);
        EXPECT_NEAR(bench.position(row, 2), -5 * t, 1e-6);
        EXPECT_NEAR(bench.position(row, 1), 50 + 9 * t - kGravity * t * (t + 1 / 240.0) / 2, 1e-3);
    }
}

/// A rotation of 10 rad/s and more once overflowed a product and came out halved.
TEST(Motion, FastSpinIsNotLost) {
    for (const double speed : {8.0, 10.0, 12.0, 25.0, 60.0, 99.0}) {
        DynamicsBench bench(weightless());
        BodyDefinition body = cube(0.5, vec(0, 0, 0));
        body.angular_velocity = vec(speed, 0, 0);
        const BodyRow row = bench.add(body);
        bench.step();
        const std::int32_t* q = bench.motion(row).orientation;
        const double turned = 2 * std::atan2(std::ldexp(q[0], -30), std::ldexp(q[3], -30));
        EXPECT_NEAR(turned, speed / 60, 1e-6 * speed);
    }
}

TEST(Motion, OrientationStaysOfUnitLength) {
    DynamicsBench bench(weightless());
    BodyDefinition body = box(0.2, 0.5, 0.9, vec(0, 0, 0));
    body.angular_velocity = vec(20, -31, 17);
    const BodyRow row = bench.add(body);
    for (int tick = 0; tick < 3600; ++tick) {
        bench.step();
        double square = 0;
        for (const std::int32_t component : bench.motion(row).orientation) {
            square += std::ldexp(component, -30) * std::ldexp(component, -30);
        }
        ASSERT_NEAR(square, 1, 2e-8);
    }
}

TEST(Motion, SpeedsAreClampedToTheSettings) {
    WorldSettings settings;
    settings.gravity = vec(0, -900, 0);
    settings.linear_speed_max = real(30);
    settings.angular_speed_max = real(5);
    DynamicsBench bench(settings);
    BodyDefinition body = cube(0.5, vec(0, 0, 0));
    body.linear_velocity = vec(20, 0, 20);
    body.angular_velocity = vec(3, 3, 2);
    const BodyRow row = bench.add(body);
    bench.motion(row).angular_velocity[0] *= 3;
    bench.run(60);
    EXPECT_LE(bench.speed(row), 30);
    EXPECT_GT(bench.speed(row), 29.999);
    const double spin = std::hypot(bench.spin(row, 0), bench.spin(row, 1), bench.spin(row, 2));
    EXPECT_LE(spin, 5.00001);
    EXPECT_GT(spin, 4.999);
}

TEST(Motion, KinematicBodiesMoveByTheirVelocityAlone) {
    DynamicsBench bench;
    BodyDefinition body = box(2, 0.1, 1, vec(0, 1, 0));
    body.mode = BodyMode::kinematic;
    body.linear_velocity = vec(1.5, -0.25, 0);
    body.angular_velocity = vec(0, 1, 0);
    const BodyRow row = bench.add(body);
    bench.add(ball(0.5, vec(0, 1.55, 0)));
    bench.add(fixed(cube(1, vec(3, 0, 0))));
    bench.run(120);
    EXPECT_NEAR(bench.position(row, 0), 3, 1e-6);
    EXPECT_NEAR(bench.position(row, 1), 0.5, 1e-6);
    EXPECT_EQ(bench.velocity(row, 0), 1.5);
    const std::int32_t* q = bench.motion(row).orientation;
    EXPECT_NEAR(2 * std::atan2(std::ldexp(q[1], -30), std::ldexp(q[3], -30)), 2, 1e-5);
}

TEST(Motion, FixedBodiesNeverMove) {
    DynamicsBench bench;
    const BodyRow row = bench.add(fixed(cube(0.5, vec(0, 0, 0))));
    bench.add(cube(0.5, vec(0.1, 0.99, 0)));
    const BodyMotion before = bench.motion(row);
    bench.run(60);
    const BodyMotion& after = bench.motion(row);
    EXPECT_TRUE(std::equal(before.position, before.position + 3, after.position));
    EXPECT_TRUE(std::equal(before.orientation, before.orientation + 4, after.orientation));
    EXPECT_EQ(bench.speed(row), 0);
}

/// A body that turns freely, read back in double.
class FreeTop {
public:
    FreeTop(double x, double y, double z, const Vec3& spin) : bench_(weightless(), 4) {
        BodyDefinition body = box(x, y, z, vec(0, 0, 0));
        body.angular_velocity = spin;
        body.mass = 1;
        row_ = bench_.add(body);
        const double half[3] = {x, y, z};
        for (int axis = 0; axis < 3; ++axis) {
            const double a = half[(axis + 1) % 3];
            const double b = half[(axis + 2) % 3];
            inertia_[axis] = (a * a + b * b) / 3;
        }
    }
    void step() { bench_.step(); }

    void rotation(double out[3][3]) {
        const std::int32_t* raw = bench_.motion(row_).orientation;
        double q[4];
        for (int index = 0; index < 4; ++index) {
            q[index] = std::ldexp(raw[index], -30);
        }
        const double x = q[0];
        const double y = q[1];
        const double z = q[2];
        const double w = q[3];
        const double matrix[3][3] = {
            {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
        std::copy(&matrix[0][0], &matrix[0][0] + 9, &out[0][0]);
    }
    /// In the body's frame, rad/s.
    void local_spin(double out[3]) {
        double r[3][3];
        rotation(r);
        for (int axis = 0; axis < 3; ++axis) {
            out[axis] = 0;
            for (int row = 0; row < 3; ++row) {
                out[axis] += r[row][axis] * bench_.spin(row_, row);
            }
        }
    }
    void momentum(double out[3]) {
        double r[3][3];
        double spin[3];
        rotation(r);
        local_spin(spin);
        for (int row = 0; row < 3; ++row) {
            out[row] = 0;
            for (int axis = 0; axis < 3; ++axis) {
                out[row] += r[row][axis] * inertia_[axis] * spin[axis];
            }
        }
    }
    double energy() {
        double spin[3];
        local_spin(spin);
        double sum = 0;
        for (int axis = 0; axis < 3; ++axis) {
            sum += inertia_[axis] * spin[axis] * spin[axis] / 2;
        }
        return sum;
    }
    double inertia(int axis) const { return inertia_[axis]; }

private:
    DynamicsBench bench_;
    BodyRow row_ = 0;
    double inertia_[3] = {};
};

/// In the body's frame the spin of a symmetric top circles its axis at w_3 (I_3 - I_1) / I_1.
TEST(FreeTurn, SymmetricTopPrecessesAtTheClosedFormRate) {
    FreeTop top(0.3, 0.8, 0.3, vec(1, 5, 0));
    const double rate = 5 * (top.inertia(1) - top.inertia(0)) / top.inertia(0);
    double angle = 0;
    double last = 0;
    constexpr int kTicks = 600;
    for (int tick = 0; tick <= kTicks; ++tick) {
        double spin[3];
        top.local_spin(spin);
        const double now = std::atan2(spin[0], spin[2]);
        angle += tick == 0 ? 0 : std::remainder(now - last, 2 * std::numbers::pi);
        last = now;
        top.step();
    }
    EXPECT_NEAR(angle, rate * kTicks / 60.0, std::abs(0.005 * rate * kTicks / 60.0));
    EXPECT_GT(std::abs(angle), 2 * std::numbers::pi) << "too slow to measure";
}

TEST(FreeTurn, KeepsMomentumAndEnergyForAMinute) {
    FreeTop top(0.2, 0.5, 0.9, vec(3, 4, 2));
    double start[3];
    top.momentum(start);
    const double length = std::hypot(start[0], start[1], start[2]);
    const double energy = top.energy();
    double worst_energy = 0;
    double worst_momentum = 0;
    for (int tick = 0; tick < 3600; ++tick) {
        top.step();
        double now[3];
        top.momentum(now);
        const double off = std::hypot(now[0] - start[0], now[1] - start[1], now[2] - start[2]);
        worst_momentum = std::max(worst_momentum, off / length);
        worst_energy = std::max(worst_energy, std::abs(top.energy() / energy - 1));
    }
    EXPECT_LT(worst_momentum, 1e-4);
    EXPECT_LT(worst_energy, 5e-3);
}

/// Spin about the middle axis tips over, again and again, and does not run away.
TEST(FreeTurn, MiddleAxisFlipsAndStaysBounded) {
    FreeTop top(0.2, 0.5, 0.9, vec(0.02, 6, 0));
    int flips = 0;
    bool up = true;
    double least = 1;
    double most = 0;
    const double energy = top.energy();
    for (int tick = 0; tick < 3600; ++tick) {
        top.step();
        double spin[3];
        top.local_spin(spin);
        if (std::abs(spin[1]) > 3 && (spin[1] > 0) != up) {
            up = !up;
            ++flips;
        }
        const double part = top.energy() / energy;
        least = std::min(least, part);
        most = std::max(most, part);
    }
    EXPECT_GE(flips, 4);
    EXPECT_GT(least, 0.98);
    EXPECT_LT(most, 1.02);
}

TEST(FreeTurn, SpinAboutAPrincipalAxisStaysThere) {
    for (int axis : {0, 2}) {
        FreeTop top(0.2, 0.5, 0.9, vec(axis == 0 ? 5 : 0, 0, axis == 2 ? 5 : 0));
        for (int tick = 0; tick < 600; ++tick) {
            top.step();
        }
        double spin[3];
        top.local_spin(spin);
        EXPECT_NEAR(spin[axis], 5, 1e-4);
        EXPECT_NEAR(spin[1], 0, 1e-4);
    }
}

} // namespace
} // namespace lockwind
