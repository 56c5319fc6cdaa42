#include "tests/simulation/measures.h"

#include <gtest/gtest.h>
#include <iostream>

// Newton's law of impact between balls, in free space: what the textbook says of speeds,
// directions, momentum and energy.
namespace lockwind::test {
namespace {

/// Steps of a stored velocity, Q11.20 m/s.
constexpr double kUlp = 0x1p-20;

WorldDefinition free_space() {
    WorldDefinition scene;
    scene.settings.gravity = {};
    scene.settings.sleep_seconds = 0;
    return scene;
}

BodyDefinition ball(BodyId id, const Vector& place, const Vector& velocity, double restitution) {
    BodyDefinition body = sphere(id, vec(place), 0.5);
    body.mass = 1;
    body.friction = 0;
    body.restitution = real(restitution);
    body.linear_velocity = vec(velocity);
    return body;
}

Vector velocity_of(const World& world, BodyId id) {
    return vector_of(world.body(id)->linear_velocity);
}

Vector momentum(const World& world) {
    Vector sum;
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        const BodyView body = world.body_at(row);
        sum = sum + vector_of(body.linear_velocity) * to_double(body.mass);
    }
    return sum;
}

struct Meeting {
    double mass;   // of the ball that is hit, kg; the other has 1
    double offset; // impact parameter, m; 1 is a graze
    double restitution;
};

class TwoBalls : public testing::TestWithParam<Meeting> {};

/// The normal at the touch is the line of centres, along which the approach turns to -e times
/// itself; across it, without friction, nothing changes.
TEST_P(TwoBalls, LeaveAsNewtonSays) {
    const auto [mass, offset, e] = GetParam();
    constexpr double kSpeed = 5;
    WorldDefinition scene = free_space();
    scene.bodies.push_back(ball(1, {-3, 0, 0}, {kSpeed, 0, 0}, e));
    scene.bodies.push_back(ball(2, {0, offset, 0}, {}, e));
    scene.bodies[1].mass = real(mass);
    const WorldPtr world = make_world(scene);
    const Vector momentum_before = momentum(*world);
    const double energy_before = kinetic_energy(*world);
    step_idle(*world, 90);
    ASSERT_GT(world->counts().events_total, 0U) << "they never met";

    const Vector normal{std::sqrt(1 - offset * offset), offset, 0};
    const double along = kSpeed * normal.x;
    const double reduced = mass / (1 + mass);
    const Vector a = Vector{kSpeed, 0, 0} - normal * ((1 + e) * reduced * along);
    const Vector b = normal * ((1 + e) * reduced * along / mass);
    // The normal is that of the centres when the tick of the touch began, within a tick's way of
    // the touch; the centres are one metre apart.
    const double turn_max = offset == 0 ? 0 : kSpeed / 60;
    const double off =
        std::max(length(velocity_of(*world, 1) - a), length(velocity_of(*world, 2) - b));
    EXPECT_LT(off, (e == 0 ? 2e-4 : 4 * kUlp) + 2 * kSpeed * turn_max);

    // Equal shares of an impulse are rounded alike. Others are off by some steps a tick of contact,
    // of which an elastic impact has one or two, and an inelastic one all that are left.
    const double momentum_off = length(momentum(*world) - momentum_before);
    EXPECT_LE(momentum_off, mass == 1 ? 0 : (e == 0 ? 64 : 8) * kUlp * (1 + mass));
    // What is lost is lost along the normal that the impulse had, which is the way that the ball
    // that rested leaves.
    const Vector left = velocity_of(*world, 2);
    const double along_left = kSpeed * left.x / length(left);
    const double lost = (1 - e * e) * reduced * along_left * along_left / 2;
    const double energy_off = kinetic_energy(*world) - (energy_before - lost);
    EXPECT_NEAR(energy_off / energy_before, 0, e == 1 ? 1e-5 : 1e-4);
    std::cout << "velocity off by " << off << " m/s, momentum by " << momentum_off / kUlp
              << " ulp kg, energy by " << energy_off / energy_before * 100 << " %\n";
}

INSTANTIATE_TEST_SUITE_P(Collision,
                         TwoBalls,
                         testing::Values(Meeting{1, 0, 1},
                                         Meeting{1, 0, 0},
                                         Meeting{1, 0, 0.5},
                                         Meeting{3, 0, 1},
                                         Meeting{50, 0, 1},
                                         Meeting{3, 0, 0},
                                         Meeting{1, 0.5, 1},
                                         Meeting{1, 0.8, 1},
                                         Meeting{1, 0.5, 0},
                                         Meeting{7, 0.3, 1},
                                         Meeting{7, 0.3, 0.4}));

/// Equal balls in a row with gaps between them: only the last one leaves, with the speed of the
/// first.
TEST(Cradle, ARowHandsTheSpeedOn) {
    constexpr int kBalls = 8;
    WorldDefinition scene = free_space();
    for (int index = 0; index < kBalls; ++index) {
        scene.bodies.push_back(ball(1 + static_cast<BodyId>(index),
                                    {index * 1.1, 0, 0},
                                    {index == 0 ? 4.0 : 0.0, 0, 0},
                                    1));
    }
    const WorldPtr world = make_world(scene);
    step_idle(*world, 120);
    double rest = 0;
    for (int index = 0; index + 1 < kBalls; ++index) {
        rest = std::max(rest, length(velocity_of(*world, 1 + static_cast<BodyId>(index))));
    }
    const double last = velocity_of(*world, kBalls).x;
    std::cout << "the last leaves at " << last << " m/s, the others keep " << rest << "\n";
    EXPECT_NEAR(last, 4, 16 * kUlp);
    EXPECT_LE(rest, 16 * kUlp);
}

/// A gas of elastic balls of many masses between walls never gains energy. It loses some: impacts
/// below 1 m/s do not bounce, and a ball that is hit twice in a tick bounces row by row.
TEST(Gas, OfElasticBallsGainsNoEnergyAndKeepsFourFifths) {
    WorldDefinition scene = free_space();
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-5.0, 5.0}) {
            Vector place;
            Vector half{6, 6, 6};
            (axis == 0 ? place.x : axis == 1 ? place.y : place.z) = side;
            (axis == 0 ? half.x : axis == 1 ? half.y : half.z) = 1;
            BodyDefinition wall = box(scene.bodies.size() + 1, vec(place), vec(half));
            wall.mode = BodyMode::fixed;
            wall.friction = 0;
            scene.bodies.push_back(wall);
        }
    }
    for (int index = 0; index < 27; ++index) {
        const auto draw = [&](std::uint64_t counter) {
            return to_double(random_symmetric(5, static_cast<std::uint64_t>(index), counter));
        };
        const Vector place{index % 3 * 2.0 - 2, index / 3 % 3 * 2.0 - 2, index / 9 * 2.0 - 2};
        BodyDefinition body = ball(
            100 + static_cast<BodyId>(index), place, {draw(0) * 4, draw(1) * 4, draw(2) * 4}, 1);
        body.mass = real(std::exp(draw(3)));
        scene.bodies.push_back(body);
    }
    const WorldPtr world = make_world(scene);
    const double before = kinetic_energy(*world);
    std::size_t hits = 0;
    double worst = 0;
    for (int tick = 0; tick < 600; ++tick) {
        step_idle(*world);
        hits += static_cast<std::size_t>(std::ranges::count_if(
            world->events(), [](const Event& event) { return event.type == EventType::hit; }));
        worst = std::max(worst, kinetic_energy(*world) / before - 1);
    }
    const double kept = kinetic_energy(*world) / before;
    std::cout << hits << " hits leave " << kept * 100 << " % of the energy; at most " << worst * 100
              << " % more\n";
    EXPECT_GT(hits, 300U);
    EXPECT_GT(kept, 0.8);
    EXPECT_LT(worst, 1e-4);
}

struct Drop {
    double restitution;
    double height;
    std::uint32_t tick_rate_hz;
};

class Rebound : public testing::TestWithParam<Drop> {};

/// e^2 h, to the way of the tick of the impact.
TEST_P(Rebound, IsTheSquareOfTheCoefficient) {
    const auto [e, height, rate] = GetParam();
    WorldDefinition scene;
    scene.settings.tick_rate_hz = rate;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(sphere(2, vec(0, height + 0.5, 0), 0.5));
    scene.bodies[1].restitution = real(e);
    const WorldPtr world = make_world(scene);
    double top = 0;
    bool has_bounced = false;
    for (std::uint32_t tick = 0; tick < 4 * rate; ++tick) {
        step_idle(*world);
        const BodyView body = *world->body(2);
        const bool rises = body.linear_velocity.y > 0;
        if (has_bounced && !rises) {
            break;
        }
        has_bounced = has_bounced || rises;
        top = has_bounced ? std::max(top, to_double(body.position.y) - 0.5) : 0;
    }
    const double expected = e * e * height;
    const double way = std::sqrt(2 * kGravity * height) / rate;
    std::cout << "rises to " << top << " of " << expected << " m; a tick's way is " << way << "\n";
    EXPECT_NEAR(top, expected, way);
}

INSTANTIATE_TEST_SUITE_P(Collision,
                         Rebound,
                         testing::Values(Drop{1, 5, 60},
                                         Drop{0.8, 5, 60},
                                         Drop{0.5, 5, 60},
                                         Drop{0.8, 1, 60},
                                         Drop{0.8, 20, 60},
                                         Drop{1, 5, 240},
                                         Drop{0.8, 5, 240},
                                         Drop{0.5, 20, 240}));

} // namespace
} // namespace lockwind::test
