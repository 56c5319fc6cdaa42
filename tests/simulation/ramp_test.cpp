#include "tests/simulation/measures.h"

#include <gtest/gtest.h>
#include <iostream>
#include <numbers>

// Coulomb's friction on a plane and on the face of a box, level and tilted.
namespace lockwind::test {
namespace {

constexpr Vector kAcross{0, 0, 1};

/// A flat box lying on a plane, or on a box of 200 m, that is tilted by `angle` about z and rises
/// towards +x. Both have the friction `mu`.
struct Slope {
    Slope(double tilt, double mu, ShapeType ramp, const Vector& velocity = {})
        : world(make_world(scene(tilt, mu, ramp, velocity))), angle(tilt) {
        start = along();
    }

    static WorldDefinition scene(double angle, double mu, ShapeType ramp, const Vector& velocity) {
        WorldDefinition scene;
        scene.settings.sleep_seconds = 0;
        const RealQuat tilt = turn(kAcross, angle);
        const Vector up = turned(tilt, {0, 1, 0});
        BodyDefinition base = ramp == ShapeType::plane ? ground(1) : box(1, {}, {100, 5, 100});
        base.mode = BodyMode::fixed;
        base.orientation = tilt;
        base.position = ramp == ShapeType::plane ? Vec3{} : vec(up * -5);
        base.friction = real(mu);
        BodyDefinition body = box(2, vec(up * 0.2), {0.4, 0.2, 0.5});
        body.orientation = tilt;
        body.friction = real(mu);
        body.linear_velocity = vec(velocity);
        scene.bodies = {base, body};
        return scene;
    }

    /// Way and speed down the slope, m and m/s.
    double along() const {
        return -dot(vector_of(world->body(2)->position), {std::cos(angle), std::sin(angle), 0});
    }
    double speed() const {
        return -dot(vector_of(world->body(2)->linear_velocity),
                    {std::cos(angle), std::sin(angle), 0});
    }

    WorldPtr world;
    double angle;
    double start = 0;
};

class OnASlope : public testing::TestWithParam<ShapeType> {};

TEST_P(OnASlope, StaysOnePercentBelowTheAngleOfFriction) {
    double worst = 0;
    for (const double degrees : {5.0, 15.0, 30.0, 45.0}) {
        const double angle = degrees * std::numbers::pi / 180;
        Slope slope(angle, std::tan(angle / 0.99), GetParam());
        step_idle(*slope.world, 60);
        const double settled = slope.along();
        step_idle(*slope.world, 540);
        worst = std::max(worst, slope.along() - settled);
        EXPECT_LT(std::abs(slope.along() - slope.start), 0.01) << degrees;
        EXPECT_LT(std::abs(slope.along() - settled), 0.001) << degrees;
    }
    std::cout << "creeps " << worst * 1000 << " mm in 9 s\n";
}

TEST_P(OnASlope, SlidesOnePercentAboveTheAngleOfFriction) {
    for (const double degrees : {5.0, 15.0, 30.0, 45.0}) {
        const double angle = degrees * std::numbers::pi / 180;
        const double mu = std::tan(angle / 1.01);
        Slope slope(angle, mu, GetParam());
        step_idle(*slope.world, 300);
        const double way = kGravity * (std::sin(angle) - mu * std::cos(angle)) * 5 * 5 / 2;
        EXPECT_NEAR(slope.along() - slope.start, way, 0.1 * way) << degrees;
    }
}

TEST_P(OnASlope, SlidesAtGravityLessFriction) {
    double worst = 0;
    for (const double degrees : {10.0, 25.0, 40.0}) {
        for (const double part : {0.0, 0.3, 0.6, 0.8}) {
            const double angle = degrees * std::numbers::pi / 180;
            const double mu = part * std::tan(angle);
            Slope slope(angle, mu, GetParam());
            step_idle(*slope.world, 30);
            const double before = slope.speed();
            step_idle(*slope.world, 120);
            const double expected = kGravity * (std::sin(angle) - mu * std::cos(angle));
            const double found = (slope.speed() - before) / 2;
            worst = std::max(worst, std::abs(found / expected - 1));
            EXPECT_NEAR(found, expected, 0.01 * expected) << degrees << " degrees, " << mu;
        }
    }
    std::cout << "acceleration is off by at most " << worst * 100 << " %\n";
}

/// v^2 / (2 mu g) in every direction. Its path bends by up to two degrees, for the two tangents'
/// rows weigh differently on a box that is longer one way, and the cone is cut along what they ask.
TEST_P(OnASlope, OnLevelGroundASlidingBoxStopsAfterTheClosedFormWay) {
    double worst = 0;
    double worst_aside = 0;
    for (const double mu : {0.2, 0.5, 0.9}) {
        for (const double degrees : {0.0, 30.0, 45.0, 77.0, 200.0}) {
            const double v = 6;
            const double direction = degrees * std::numbers::pi / 180;
            const Vector ahead{std::cos(direction), 0, std::sin(direction)};
            Slope level(0, mu, GetParam(), ahead * v);
            step_idle(*level.world, 300);
            const BodyView body = *level.world->body(2);
            const double expected = v * v / (2 * mu * kGravity);
            const double way = dot(vector_of(body.position), ahead);
            const double aside = dot(vector_of(body.position), cross(ahead, {0, 1, 0}));
            worst = std::max(worst, std::abs(way / expected - 1));
            worst_aside = std::max(worst_aside, std::abs(aside / expected));
            EXPECT_NEAR(way, expected, 0.01 * expected) << mu << ", " << degrees << " degrees";
            EXPECT_LT(std::abs(aside), 0.035 * expected) << mu << ", " << degrees << " degrees";
            EXPECT_LT(length(vector_of(body.linear_velocity)), 1e-3);
        }
    }
    std::cout << "stopping way is off by at most " << worst * 100 << " %, aside by "
              << worst_aside * 100 << " %\n";
}

INSTANTIATE_TEST_SUITE_P(Ramps,
                         OnASlope,
                         testing::Values(ShapeType::plane, ShapeType::box),
                         [](const testing::TestParamInfo<ShapeType>& ramp) {
                             return ramp.param == ShapeType::plane ? "Plane" : "Box";
                         });

} // namespace
} // namespace lockwind::test
