#include "dynamics/turn.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace lockwind {
namespace {

std::int64_t raw(double value) {
    return std::llround(std::ldexp(value, 30));
}
double value_of(std::int64_t raw_value) {
    return std::ldexp(static_cast<double>(raw_value), -30);
}

TEST(Turn, SineAndCosineAreExactTo30NanoradiansUpTo4) {
    for (int step = -4000; step <= 4000; ++step) {
        const double angle = value_of(raw(step / 1000.0));
        const SinCos result = sin_cos(raw(angle));
        const double tolerance = 1e-9 * (std::abs(angle) > 0.5 ? 30 : 3);
        EXPECT_NEAR(value_of(result.sin), std::sin(angle), tolerance) << angle;
        EXPECT_NEAR(value_of(result.cos), std::cos(angle), tolerance) << angle;
    }
}

TEST(Turn, QuaternionIsTheExponentialOfTheTurn) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 4000; ++trial) {
        double half[3];
        std::int64_t raw_half[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double range = trial % 2 == 0 ? 2 : 0.05;
            half[axis] = (std::ldexp(static_cast<double>(random()), -31) - 1) * range;
            raw_half[axis] = raw(half[axis]);
        }
        std::int64_t q[4];
        turn_quaternion(raw_half, q);
        const double angle = std::hypot(half[0], half[1], half[2]);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(value_of(q[axis]), half[axis] / angle * std::sin(angle), 4e-8);
        }
        EXPECT_NEAR(value_of(q[3]), std::cos(angle), 4e-8);
    }
}

TEST(Turn, NormalizingMendsOnePartInTenThousand) {
    for (const double scale : {0.9999, 1.0, 1.0001}) {
        const std::int64_t q[4] = {
            raw(0.5 * scale), raw(-0.5 * scale), raw(0.1 * scale), raw(0.7 * scale)};
        std::int32_t out[4];
        normalize_quaternion(q, out);
        double square = 0;
        for (const std::int32_t component : out) {
            square += value_of(component) * value_of(component);
        }
        EXPECT_NEAR(square, 1, 3e-8);
    }
}

TEST(Turn, ProductMayOverwriteItsFactors) {
    const std::int64_t a[4] = {raw(0.5), raw(0.5), raw(-0.5), raw(0.5)};
    const std::int64_t b[4] = {raw(0.6), 0, raw(0.8), 0};
    std::int64_t apart[4];
    multiply_quaternions(a, b, apart);
    std::int64_t in_place[4] = {a[0], a[1], a[2], a[3]};
    multiply_quaternions(in_place, b, in_place);
    const double expected[4] = {0.7, -0.7, 0.1, 0.1};
    for (int index = 0; index < 4; ++index) {
        EXPECT_EQ(apart[index], in_place[index]);
        EXPECT_NEAR(value_of(apart[index]), expected[index], 2e-9);
    }
}

/// Second order: halving the step takes three quarters of the error away.
TEST(FreeTurn, ConvergesAtSecondOrder) {
    const auto momentum_after = [](int steps, std::int64_t out[3]) {
        FreeTurn turn{};
        turn.inertia[0] = 6 << 21;
        turn.inertia[1] = 2 << 21;
        turn.inertia[2] = 1 << 21;
        turn.inertia_min = 1 << 21;
        turn.angle_of_velocity = (std::int64_t{1} << 32) / steps;
        turn.velocity_max = std::int64_t{1} << 40;
        turn.orientation[3] = std::int64_t{1} << 30;
        turn.momentum[0] = 2 << 20;
        turn.momentum[1] = 5 << 20;
        turn.momentum[2] = 9 << 20;
        for (int step = 0; step < steps; ++step) {
            turn.run();
        }
        for (int axis = 0; axis < 3; ++axis) {
            out[axis] = turn.momentum[axis];
        }
    };
    std::int64_t best[3];
    momentum_after(4096, best);
    double last = 0;
    for (const int steps : {4, 8, 16, 32}) {
        std::int64_t now[3];
        momentum_after(steps, now);
        const double error = std::hypot(static_cast<double>(now[0] - best[0]),
                                        static_cast<double>(now[1] - best[1]),
                                        static_cast<double>(now[2] - best[2]));
        if (last > 0) {
            EXPECT_NEAR(last / error, 4, 0.7) << steps << " steps";
        }
        last = error;
    }
}

TEST(FreeTurn, KeepsTheLengthOfMomentum) {
    FreeTurn turn{};
    turn.inertia[0] = 5 << 21;
    turn.inertia[1] = 2 << 21;
    turn.inertia[2] = 1 << 21;
    turn.inertia_min = 1 << 21;
    turn.angle_of_velocity = std::int64_t{1} << 31;
    turn.velocity_max = std::int64_t{1} << 40;
    turn.orientation[3] = std::int64_t{1} << 30;
    turn.momentum[0] = 3 << 22;
    turn.momentum[1] = 1 << 22;
    turn.momentum[2] = -(2 << 22);
    const auto length = [&] {
        return std::hypot(static_cast<double>(turn.momentum[0]),
                          static_cast<double>(turn.momentum[1]),
                          static_cast<double>(turn.momentum[2]));
    };
    const double before = length();
    for (int step = 0; step < 1000; ++step) {
        turn.run();
    }
    EXPECT_NEAR(length() / before, 1, 3e-6);
}

} // namespace
} // namespace lockwind
