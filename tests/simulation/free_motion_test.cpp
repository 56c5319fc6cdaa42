#include "tests/simulation/measures.h"

#include <gtest/gtest.h>
#include <iostream>
#include <numbers>

// Bodies that touch nothing: spinners and projectiles against closed forms.
namespace lockwind::test {
namespace {

constexpr int kTicksAMinute = 3600;

WorldDefinition weightless() {
    WorldDefinition scene;
    scene.settings.gravity = {};
    scene.settings.sleep_seconds = 0;
    return scene;
}

/// A box of three unequal inertias that spins about the middle one, pushed by `nudge` rad/s.
BodyDefinition spinner(BodyId id, double spin, double nudge) {
    BodyDefinition body = box(id, vec(20 * static_cast<double>(id), 0, 0), {0.2, 0.5, 0.9});
    body.mass = 1;
    body.orientation = turn({0.6, 0, 0.8}, 0.3 * static_cast<double>(id));
    body.angular_velocity = vec(turned(body.orientation, {nudge, spin, 0}));
    return body;
}

Vector local_spin(const BodyView& body) {
    return turned_back(body.orientation, vector_of(body.angular_velocity));
}

/// Euler's equations, free: seconds between two flips of the spin about the middle axis. Landau and
/// Lifshitz, Mechanics, 37: 4 K(k) / rate is the whole period, two flips.
double flip_seconds(const BodyDefinition& body) {
    const Vector inertia = inertia_of(body.shape, to_double(body.mass));
    double i[3] = {inertia.x, inertia.y, inertia.z};
    const Vector spin = turned_back(body.orientation, vector_of(body.angular_velocity));
    const double twice_energy =
        i[0] * spin.x * spin.x + i[1] * spin.y * spin.y + i[2] * spin.z * spin.z;
    const double square = i[0] * i[0] * spin.x * spin.x + i[1] * i[1] * spin.y * spin.y +
                          i[2] * i[2] * spin.z * spin.z;
    std::sort(i, i + 3);
    if (square < twice_energy * i[1]) {
        std::swap(i[0], i[2]);
    }
    const double rate =
        std::sqrt((i[2] - i[1]) * (square - twice_energy * i[0]) / (i[0] * i[1] * i[2]));
    const double k2 = (i[1] - i[0]) * (twice_energy * i[2] - square) /
                      ((i[2] - i[1]) * (square - twice_energy * i[0]));
    return 2 * std::comp_ellint_1(std::sqrt(k2)) / rate;
}

TEST(Spinner, TumblesForAMinuteAndKeepsItsMomentum) {
    WorldDefinition scene = weightless();
    for (const double spin : {1.0, 2.0, 4.0, 6.0, 8.0}) {
        scene.bodies.push_back(spinner(scene.bodies.size() + 1, spin, 0.05 * spin));
    }
    const WorldPtr world = make_world(scene);
    std::vector<BodyView> start;
    for (BodyRow row = 0; row < world->body_count(); ++row) {
        start.push_back(world->body_at(row));
    }
    std::vector<double> momentum_off(start.size());
    std::vector<double> energy_off(start.size());
    std::vector<double> flips(start.size());
    std::vector<double> sign(start.size(), 1);
    std::vector<double> last_flip(start.size());
    std::vector<double> first_flip(start.size());
    for (int tick = 1; tick <= kTicksAMinute; ++tick) {
        step_idle(*world);
        for (BodyRow row = 0; row < world->body_count(); ++row) {
            const BodyView body = world->body_at(row);
            const double before = length(angular_momentum(start[row]));
            momentum_off[row] =
                std::max(momentum_off[row], std::abs(length(angular_momentum(body)) / before - 1));
            energy_off[row] = std::max(
                energy_off[row], std::abs(kinetic_energy(body) / kinetic_energy(start[row]) - 1));
            if (local_spin(body).y * sign[row] < 0) {
                sign[row] = -sign[row];
                first_flip[row] = flips[row] == 0 ? tick / 60.0 : first_flip[row];
                last_flip[row] = tick / 60.0;
                ++flips[row];
            }
        }
    }
    for (std::size_t row = 0; row < start.size(); ++row) {
        ASSERT_GE(flips[row], 3);
        const double period = (last_flip[row] - first_flip[row]) / (flips[row] - 1);
        const double expected = flip_seconds(scene.bodies[row]);
        std::cout << flips[row] << " flips, one in " << period << " s (" << expected
                  << "); |L| off by " << momentum_off[row] << ", energy by " << energy_off[row]
                  << "\n";
        EXPECT_LT(momentum_off[row], 1e-4);
        EXPECT_LT(energy_off[row], 0.002);
        EXPECT_NEAR(period, expected, 0.01 * expected);
    }
}

WorldDefinition thrown(std::uint32_t substeps) {
    WorldDefinition scene;
    scene.settings.substeps = substeps;
    scene.bodies.push_back(sphere(1, {0, 50, 0}, 0.25));
    scene.bodies[0].linear_velocity = {12, 9, -5};
    return scene;
}

/// The integrator's own closed form, in integers: a tick's gravity is one rounded number, so the
/// velocity is exact; places are sums of velocity x step, each rounded once and divided by a
/// reciprocal of 2^-28 relative error.
TEST(Projectile, FollowsTheIntegratorsClosedForm) {
    for (const std::uint32_t substeps : {1U, 2U, 4U, 8U, 16U}) {
        const WorldPtr world = make_world(thrown(substeps));
        const std::int64_t gravity = std::llround(std::ldexp(-kGravity / 60, 20));
        std::int64_t fallen = 0; // sum of the velocities of all substeps x substeps, 2^-20 m/s
        double worst = 0;
        for (int tick = 1; tick <= 180; ++tick) {
            step_idle(*world);
            const BodyView body = *world->body(1);
            const std::int64_t before = (std::int64_t{9} << 20) + (tick - 1) * gravity;
            for (std::uint32_t substep = 1; substep <= substeps; ++substep) {
                // The share of gravity that is due by now, floored.
                std::int64_t due = gravity * substep / static_cast<std::int64_t>(substeps);
                fallen += before + due;
            }
            ASSERT_EQ(body.linear_velocity.y.raw(), (before + gravity) << 12);
            ASSERT_EQ(body.linear_velocity.x, 12);
            const double steps = tick * static_cast<double>(substeps);
            const double rate = 60.0 * substeps;
            const double y = 50 + std::ldexp(static_cast<double>(fallen), -20) / rate;
            const double off = std::max({std::abs(to_double(body.position.y) - y),
                                         std::abs(to_double(body.position.x) - 12 * tick / 60.0),
                                         std::abs(to_double(body.position.z) + 5 * tick / 60.0)});
            worst = std::max(worst, off);
            ASSERT_LE(off, steps * (0x1p-33 + 12 / rate * 0x1p-28));
        }
        std::cout << substeps << " substeps: off by at most " << worst * 1e9 << " nm in 3 s\n";
    }
}

/// Semi-implicit Euler falls g t h / 2 too far: half of it with half the step.
TEST(Projectile, ComesToTheParabolaAtFirstOrder) {
    double last = 0;
    for (const std::uint32_t substeps : {1U, 2U, 4U, 8U, 16U}) {
        const WorldPtr world = make_world(thrown(substeps));
        step_idle(*world, 120);
        const double h = 1 / (60.0 * substeps);
        const double parabola = 50 + 9 * 2 - kGravity * 2 * 2 / 2;
        const double off = parabola - to_double(world->body(1)->position.y);
        std::cout << substeps << " substeps: " << off * 1000 << " mm too low\n";
        EXPECT_NEAR(off, kGravity * 2 * h / 2, 1e-4);
        if (last != 0) {
            EXPECT_NEAR(last / off, 2, 0.05);
        }
        last = off;
    }
}

} // namespace
} // namespace lockwind::test
