#include "dynamics/integrator.h"

#include <cmath>
#include <gtest/gtest.h>
#include <iostream>
#include <numbers>

namespace lockwind {
namespace {

double to_double(Real value) {
    return std::ldexp(static_cast<double>(value.raw()), -32);
}

/// A unit mass on a unit spring along x: period 2 pi, energy 1/2.
Vec3 spring(const ParticleMotion& motion) {
    return -motion.position;
}
/// A unit mass about a centre of unit gravity; the circle of radius 1 has period 2 pi.
Vec3 centre(const ParticleMotion& motion) {
    const Real radius = length(motion.position);
    return -(motion.position / (radius * radius * radius));
}

constexpr ParticleMotion kStart{{1, 0, 0}, {0, 0, 0}};
constexpr ParticleMotion kCircle{{1, 0, 0}, {0, 1, 0}};

template <class Acceleration>
ParticleMotion
run(Integrator integrator, ParticleMotion motion, int steps, Real step, Acceleration acceleration) {
    for (int index = 0; index < steps; ++index) {
        motion = integrate(integrator, motion, step, acceleration);
    }
    return motion;
}

double energy(const ParticleMotion& motion) {
    const double x = to_double(motion.position.x);
    const double v = to_double(motion.velocity.x);
    return (x * x + v * v) / 2;
}

/// Error of position and velocity after 2 s, against cos and -sin.
double error_of(Integrator integrator, int steps_per_second) {
    const ParticleMotion end = run(integrator,
                                   kStart,
                                   2 * steps_per_second,
                                   Real(1) / Real(static_cast<std::uint32_t>(steps_per_second)),
                                   spring);
    return std::hypot(to_double(end.position.x) - std::cos(2.0),
                      to_double(end.velocity.x) + std::sin(2.0));
}

TEST(Integrator, ConvergesWithItsOrder) {
    const std::pair<Integrator, int> orders[] = {{Integrator::semi_implicit_euler, 1},
                                                 {Integrator::explicit_euler, 1},
                                                 {Integrator::verlet, 2},
                                                 {Integrator::leapfrog, 2},
                                                 {Integrator::rk4, 4}};
    for (const auto& [integrator, order] : orders) {
        // Of the fourth order, smaller steps' errors are lost in the roundings.
        const int steps = order == 4 ? 4 : 16;
        const double coarse = error_of(integrator, steps);
        const double fine = error_of(integrator, 2 * steps);
        const double measured = std::log2(coarse / fine);
        std::cout << "integrator " << static_cast<int>(integrator) << ": error " << coarse << ", "
                  << fine << ", order " << measured << "\n";
        EXPECT_NEAR(measured, order, 0.15);
    }
}

/// Lowest and highest energy over 100 periods at 60 Hz, relative to the start.
std::pair<double, double> energy_range(Integrator integrator) {
    ParticleMotion motion = kStart;
    double lowest = 1;
    double highest = 1;
    for (int step = 0; step < 37'699; ++step) {
        motion = integrate(integrator, motion, Real(1) / Real(60), spring);
        lowest = std::min(lowest, energy(motion) / energy(kStart));
        highest = std::max(highest, energy(motion) / energy(kStart));
    }
    return {lowest, highest};
}

TEST(Integrator, SymplecticOnesKeepTheEnergyWithinABand) {
    constexpr double kStep = 1.0 / 60;
    // Semi-implicit Euler conserves (x^2 + v^2 + h x v) / 2: within 1 +- h / 2 and a little.
    const auto [euler_low, euler_high] = energy_range(Integrator::semi_implicit_euler);
    EXPECT_GT(euler_low, 1 - kStep);
    EXPECT_LT(euler_high, 1 + kStep);
    for (const Integrator integrator : {Integrator::verlet, Integrator::leapfrog}) {
        const auto [low, high] = energy_range(integrator);
        EXPECT_GT(low, 1 - kStep * kStep);
        EXPECT_LT(high, 1 + kStep * kStep);
    }
}

TEST(Integrator, ExplicitEulerGainsEnergyAndRungeKuttaLosesLittle) {
    // (1 + h^2)^n
    const double gain = energy_range(Integrator::explicit_euler).second;
    EXPECT_NEAR(std::log(gain), 37'699 * std::log1p(1.0 / 3600), 0.01);
    // 1 - h^6 / 72 a step
    const auto [low, high] = energy_range(Integrator::rk4);
    EXPECT_NEAR(1 - low, 37'699 * std::pow(1.0 / 60, 6) / 72, 2e-6);
    EXPECT_LT(high, 1 + 2e-6);
}

TEST(Integrator, AnOrbitClosesAfterManyTurns) {
    constexpr int kSteps = 600; // a turn
    const Real step = Real::from_raw(std::llround(std::ldexp(2 * std::numbers::pi / kSteps, 32)));
    const ParticleMotion verlet = run(Integrator::verlet, kCircle, 20 * kSteps, step, centre);
    const ParticleMotion rk4 = run(Integrator::rk4, kCircle, 20 * kSteps, step, centre);
    const auto radius = [](const ParticleMotion& motion) {
        return std::hypot(to_double(motion.position.x), to_double(motion.position.y));
    };
    EXPECT_NEAR(radius(verlet), 1, 1e-4);
    EXPECT_NEAR(radius(rk4), 1, 1e-6);
    EXPECT_NEAR(to_double(rk4.position.y), 0, 2e-5); // the phase after 20 turns
}

TEST(Integrator, FreeFallIsExactForThoseOfSecondOrder) {
    const auto fall = [](const ParticleMotion&) { return Vec3{0, -10, 0}; };
    for (const Integrator integrator :
         {Integrator::verlet, Integrator::leapfrog, Integrator::rk4}) {
        const ParticleMotion end = run(integrator, {}, 64, Real(1) / Real(32), fall);
        EXPECT_EQ(end.position.y, Real(-20)); // g t^2 / 2
        EXPECT_EQ(end.velocity.y, Real(-20));
    }
    const ParticleMotion euler =
        run(Integrator::semi_implicit_euler, {}, 64, Real(1) / Real(32), fall);
    EXPECT_EQ(euler.position.y, Real(-20) - Real(10) / Real(32)); // and g h t / 2 more
}

} // namespace
} // namespace lockwind
