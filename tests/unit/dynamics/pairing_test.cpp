#include "dynamics/pairing.h"
#include "tests/unit/dynamics/dynamics_bench.h"

#include <cmath>
#include <gtest/gtest.h>

namespace lockwind {
namespace {

std::int32_t coefficient(double value) {
    return static_cast<std::int32_t>(std::llround(std::ldexp(value, 28)));
}

double combined(double a, double b, CombineRule rule_a, CombineRule rule_b) {
    return std::ldexp(combine(coefficient(a),
                              coefficient(b),
                              static_cast<std::uint8_t>(rule_a),
                              static_cast<std::uint8_t>(rule_b)),
                      -28);
}

TEST(Pairing, CombinesByTheRule) {
    const auto both = [](double a, double b, CombineRule rule) {
        return combined(a, b, rule, rule);
    };
    EXPECT_NEAR(both(0.2, 0.8, CombineRule::average), 0.5, 1e-8);
    EXPECT_NEAR(both(0.2, 0.8, CombineRule::geometric_mean), 0.4, 1e-8);
    EXPECT_NEAR(both(0.2, 0.8, CombineRule::minimum), 0.2, 1e-8);
    EXPECT_NEAR(both(0.2, 0.8, CombineRule::multiply), 0.16, 1e-8);
    EXPECT_NEAR(both(0.2, 0.8, CombineRule::maximum), 0.8, 1e-8);
    EXPECT_EQ(both(4, 4, CombineRule::multiply), 4); // the format holds 4, not 16
    EXPECT_EQ(both(0, 4, CombineRule::geometric_mean), 0);
}

TEST(Pairing, TheLaterRuleCountsWhoeverHasIt) {
    constexpr CombineRule kRules[] = {CombineRule::average,
                                      CombineRule::geometric_mean,
                                      CombineRule::minimum,
                                      CombineRule::multiply,
                                      CombineRule::maximum};
    for (const CombineRule a : kRules) {
        for (const CombineRule b : kRules) {
            const CombineRule later = std::max(a, b);
            EXPECT_EQ(combined(0.3, 0.7, a, b), combined(0.3, 0.7, later, later));
            EXPECT_EQ(combined(0.3, 0.7, a, b), combined(0.7, 0.3, b, a));
        }
    }
}

/// Height that a ball reaches again after a fall of 5 m.
double rebound(double ball_restitution, double ground_restitution, CombineRule rule) {
    DynamicsBench bench;
    BodyDefinition floor = ground();
    floor.restitution = real(ground_restitution);
    floor.restitution_rule = rule;
    bench.add(floor);
    BodyDefinition falling = ball(0.5, vec(0, 5.5, 0));
    falling.restitution = real(ball_restitution);
    falling.restitution_rule = rule;
    const BodyRow row = bench.add(falling);
    double highest = 0;
    bool rises = false;
    for (int tick = 0; tick < 200; ++tick) {
        bench.step();
        rises = rises || bench.velocity(row, 1) >= -0.01;
        highest = rises ? std::max(highest, bench.position(row, 1) - 0.5) : 0;
    }
    return highest;
}

TEST(Pairing, ABallReboundsByTheRule) {
    // e^2 h
    EXPECT_NEAR(rebound(0.8, 0.5, CombineRule::maximum), 0.64 * 5, 0.15);
    EXPECT_NEAR(rebound(0.8, 0.5, CombineRule::multiply), 0.16 * 5, 0.08);
    EXPECT_NEAR(rebound(0.8, 0, CombineRule::multiply), 0, 0.02);
}

TEST(Pairing, ABoxSlidesByTheRule) {
    const auto distance = [](CombineRule rule) {
        DynamicsBench bench;
        BodyDefinition floor = ground();
        floor.friction = real(0.9);
        floor.friction_rule = rule;
        bench.add(floor);
        BodyDefinition sliding = cube(0.5, vec(0, 0.5, 0));
        sliding.linear_velocity = vec(3, 0, 0);
        sliding.friction = real(0.1);
        sliding.friction_rule = rule;
        const BodyRow row = bench.add(sliding);
        bench.run(300);
        return bench.position(row, 0);
    };
    // v^2 / (2 mu g)
    EXPECT_NEAR(distance(CombineRule::minimum), 9 / (2 * 0.1 * 9.81), 0.1);
    EXPECT_NEAR(distance(CombineRule::geometric_mean), 9 / (2 * 0.3 * 9.81), 0.05);
    EXPECT_NEAR(distance(CombineRule::average), 9 / (2 * 0.5 * 9.81), 0.04);
}

/// A box on a belt, after 10 s; friction brings it to the belt's speed at mu g.
TEST(SurfaceVelocity, ABeltCarriesWhatLiesOnIt) {
    for (const double turn : {0.0, 1.0}) { // about y, rad
        DynamicsBench bench;
        BodyDefinition belt = fixed(box(50, 0.5, 50, vec(0, -0.5, 0)));
        belt.orientation = {0, real(std::sin(turn / 2)), 0, real(std::cos(turn / 2))};
        belt.surface_velocity = vec(2, 0, 0);
        bench.add(belt);
        const BodyRow row = bench.add(cube(0.5, vec(0, 0.5, 0)));
        bench.run(600);
        const double speed = std::hypot(bench.velocity(row, 0), bench.velocity(row, 2));
        EXPECT_NEAR(speed, 2, 0.01);
        EXPECT_NEAR(bench.velocity(row, 0), 2 * std::cos(turn), 0.01);
        EXPECT_NEAR(bench.velocity(row, 2), -2 * std::sin(turn), 0.01);
        // v t - v^2 / (2 mu g)
        const double distance = std::hypot(bench.position(row, 0), bench.position(row, 2));
        EXPECT_NEAR(distance, 2 * 10 - 4 / (2 * 0.5 * 9.81), 0.05);
    }
}

TEST(SurfaceVelocity, ABodyWithARunningSurfaceDrivesItself) {
    DynamicsBench bench;
    bench.add(ground());
    BodyDefinition crawler = box(1, 0.5, 1, vec(0, 0.5, 0));
    crawler.surface_velocity = vec(1.5, 0, 0);
    const BodyRow row = bench.add(crawler);
    bench.run(300);
    EXPECT_NEAR(bench.velocity(row, 0), -1.5, 0.02);
}

TEST(Pairing, MeetingNeedsADynamicBodyAndBothMasks) {
    BodyProperties a{};
    BodyProperties b{};
    a.mask = b.mask = kAllLayers;
    a.mode = static_cast<std::uint8_t>(BodyMode::dynamic);
    EXPECT_TRUE(may_meet(a, b));
    EXPECT_TRUE(may_meet(b, a));
    b.layer = 31;
    a.mask = ~(1U << 31U);
    EXPECT_FALSE(may_meet(a, b));
    EXPECT_FALSE(may_meet(b, a));
    a.mask = kAllLayers;
    b.mask = 0;
    EXPECT_FALSE(may_meet(a, b));
    b.mask = 1;
    EXPECT_TRUE(may_meet(a, b));
    a.sensor = 1;
    EXPECT_TRUE(may_meet(a, b));
    b.sensor = 1;
    EXPECT_FALSE(may_meet(a, b));
    b.sensor = 0;
    a.mode = static_cast<std::uint8_t>(BodyMode::kinematic);
    EXPECT_FALSE(may_meet(a, b));
}

} // namespace
} // namespace lockwind
