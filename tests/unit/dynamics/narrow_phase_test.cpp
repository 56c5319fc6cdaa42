#include "dynamics/narrow_phase.h"
#include "tests/unit/dynamics/dynamics_bench.h"

#include <random>

namespace lockwind {
namespace {

TEST(NarrowPhase, RestingManifoldsAreNotMadeAnew) {
    DynamicsBench bench({}, 8);
    bench.add(ground());
    bench.add(cube(0.5, vec(0, 0.5, 0)));
    bench.add(cube(0.5, vec(0, 1.5, 0)));
    bench.run(60);
    const Manifold before = bench.state().manifolds[0];
    bench.run(120);
    const Manifold& after = bench.state().manifolds[0];
    EXPECT_TRUE(std::equal(before.anchor_a, before.anchor_a + 12, after.anchor_a));
    EXPECT_TRUE(std::equal(before.separation, before.separation + 4, after.separation));
}

TEST(NarrowPhase, AManifoldThatDriftsLittleIsKeptHoweverOftenItIsLookedAt) {
    DynamicsBench bench({}, 8);
    bench.add(fixed(box(50, 1, 50, vec(0, -1, 0))));
    const BodyRow row = bench.add(cube(0.5, vec(0, 0.5, 0)));
    bench.run(60);
    const Manifold before = bench.state().manifolds[0];
    const auto look_after_moving = [&](double way) {
        bench.motion(row).position[0] += real(way).raw();
        bench.look_again();
        EXPECT_EQ(bench.dynamics().narrow_phase(bench.tables()), StepFault::none);
        return bench.state().manifolds[0].centre_delta[0];
    };
    EXPECT_EQ(look_after_moving(0.02), before.centre_delta[0]);
    EXPECT_EQ(look_after_moving(0.02), before.centre_delta[0]);
    EXPECT_NE(look_after_moving(0.02), before.centre_delta[0]) << "farther than 50 mm";
}

TEST(NarrowPhase, SlidingBoxRenewsItsManifoldBeforeItDriftsFiveCentimetres) {
    DynamicsBench bench({}, 8);
    bench.add(fixed(box(50, 1, 50, vec(0, -1, 0))));
    BodyDefinition body = cube(0.5, vec(0, 0.5, 0));
    body.friction = 0;
    body.linear_velocity = vec(1, 0, 0);
    const BodyRow row = bench.add(body);
    int renewals = 0;
    std::int32_t anchor = 0;
    for (int tick = 0; tick < 120; ++tick) {
        bench.step();
        const Manifold& manifold = bench.state().manifolds[0];
        const double made_at = std::ldexp(manifold.centre_delta[0], -22);
        EXPECT_LT(bench.position(row, 0) - made_at, 0.05 + 0.025 + 2.0 / 60);
        renewals += manifold.centre_delta[0] != anchor ? 1 : 0;
        anchor = manifold.centre_delta[0];
    }
    // Two metres: a renewal for every five to eleven centimetres.
    EXPECT_GE(renewals, 18);
    EXPECT_LE(renewals, 45);
}

TEST(NarrowPhase, ImpulsesFollowTheirFeatures) {
    DynamicsBench bench({}, 8);
    bench.add(fixed(box(50, 1, 50, vec(0, -1, 0))));
    BodyDefinition body = cube(0.5, vec(0, 0.5, 0));
    body.linear_velocity = vec(0.5, 0, 0);
    bench.add(body);
    bench.run(30);
    const Manifold before = bench.state().manifolds[0];
    const ContactImpulse borne = bench.state().impulses[0];
    ASSERT_EQ(before.point_count, 4);
    // The points in another order, and the pair looked at again.
    Manifold& turned = bench.state().manifolds[0];
    for (int point = 0; point < 4; ++point) {
        const int from = (point + 1) % 4;
        turned.feature[point] = before.feature[from];
        bench.state().impulses[0].normal[point] = borne.normal[from];
    }
    bench.look_again();
    bench.state().manifolds[0].centre_delta[0] += 1 << 22;
    ASSERT_EQ(bench.dynamics().narrow_phase(bench.tables()), StepFault::none);
    const Manifold& after = bench.state().manifolds[0];
    for (int point = 0; point < 4; ++point) {
        EXPECT_EQ(after.feature[point], before.feature[point]);
        EXPECT_EQ(bench.state().impulses[0].normal[point], borne.normal[point]);
    }
}

TEST(NarrowPhase, FrictionKeepsItsDirectionWhenTheNormalTurns) {
    DynamicsBench bench({}, 8);
    bench.add(fixed(ball(0.5, vec(0, 0, 0))));
    const BodyRow row = bench.add(ball(0.5, vec(0.6, 0.8, 0)));
    bench.step();
    Manifold& manifold = bench.state().manifolds[0];
    ASSERT_EQ(manifold.point_count, 1);
    ContactImpulse& impulse = bench.state().impulses[0];
    impulse.friction[0] = 300000;
    impulse.friction[1] = -500000;
    const auto world_friction = [&impulse](const Manifold& m, double out[3]) {
        for (int axis = 0; axis < 3; ++axis) {
            const int next = (axis + 1) % 3;
            const int last = (axis + 2) % 3;
            const double n[2] = {std::ldexp(m.normal[next], -30), std::ldexp(m.normal[last], -30)};
            const double t[2] = {std::ldexp(m.tangent[next], -30),
                                 std::ldexp(m.tangent[last], -30)};
            out[axis] = impulse.friction[0] * std::ldexp(m.tangent[axis], -30) +
                        impulse.friction[1] * (n[0] * t[1] - n[1] * t[0]);
        }
    };
    double before[3];
    world_friction(manifold, before);
    const std::int32_t normal = manifold.normal[0];
    bench.motion(row).position[2] += std::int64_t{1} << 26;
    bench.look_again();
    ASSERT_EQ(bench.dynamics().narrow_phase(bench.tables()), StepFault::none);
    ASSERT_NE(manifold.normal[0], normal);
    double after[3];
    world_friction(manifold, after);
    const double length = std::hypot(before[0], before[1], before[2]);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(after[axis], before[axis], 0.02 * length);
    }
}

TEST(NarrowPhase, TangentIsAUnitVectorAcrossTheNormal) {
    std::mt19937 random(6);
    const auto check = [](const double n[3]) {
        std::int32_t normal[3];
        for (int axis = 0; axis < 3; ++axis) {
            normal[axis] = static_cast<std::int32_t>(std::lround(std::ldexp(n[axis], 30)));
        }
        std::int32_t tangent[3];
        tangent_of(normal, tangent);
        double dot = 0;
        double square = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double t = std::ldexp(tangent[axis], -30);
            dot += t * n[axis];
            square += t * t;
        }
        EXPECT_NEAR(dot, 0, 4e-9);
        EXPECT_NEAR(square, 1, 1e-8);
    };
    for (int trial = 0; trial < 2000; ++trial) {
        double n[3];
        for (double& component : n) {
            component = std::ldexp(static_cast<double>(random()), -31) - 1;
        }
        const double length = std::hypot(n[0], n[1], n[2]);
        for (double& component : n) {
            component /= length;
        }
        check(n);
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
            double n[3] = {};
            n[axis] = sign;
            check(n);
        }
    }
}

} // namespace
} // namespace lockwind
