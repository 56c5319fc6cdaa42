#include "tests/unit/dynamics/dynamics_bench.h"

#include <cstring>
#include <functional>

// Islands that take more or fewer substeps than the settings say.
namespace lockwind {
namespace {

/// A row of balls on rods from a fixed post at x, the last one 200 times as heavy, that swings.
/// Returns its first row.
BodyRow add_chain(DynamicsBench& bench, double x, std::uint32_t substeps) {
    const BodyRow first = bench.add(fixed(cube(0.1, vec(x, 0, 0))));
    constexpr int kLinks = 8;
    for (int link = 1; link <= kLinks; ++link) {
        BodyDefinition body = box(0.2, 0.05, 0.05, vec(x + 0.5 * link, 0, 0));
        body.mass = link == kLinks ? 200 : 1;
        body.substeps = link == 3 ? substeps : 0; // one asks for the whole island
        const BodyRow row = bench.add(body);
        JointDefinition joint;
        joint.kind = JointKind::ball;
        joint.body_a = row;
        joint.body_b = row + 1;
        joint.anchor_a = vec(link == 1 ? 0 : 0.25, 0, 0);
        joint.anchor_b = vec(link == 1 ? -0.5 : -0.25, 0, 0);
        bench.add(joint);
    }
    return first;
}

/// A pile that falls, bounces and hits: no joints.
void add_pile(DynamicsBench& bench, double x, std::uint32_t substeps) {
    for (int index = 0; index < 12; ++index) {
        BodyDefinition body = index % 3 == 0 ? ball(0.3, vec(x + 0.1 * index, 1 + index, 0))
                                             : box(0.4, 0.3, 0.3, vec(x, 1 + index, 0.05 * index));
        body.restitution = real(0.5);
        body.substeps = substeps;
        bench.add(body);
    }
}

/// By how much the chain's last link is farther off than its joints allow, m: the most in a time.
double stretch(std::uint32_t substeps) {
    DynamicsBench bench({}, 32);
    const BodyRow first = add_chain(bench, 0, substeps);
    double most = 0;
    for (int tick = 0; tick < 180; ++tick) {
        bench.step();
        double length = 0;
        for (BodyRow link = 2; link <= 8; ++link) {
            double square = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const double way =
                    bench.position(first + link, axis) - bench.position(first + link - 1, axis);
                square += way * way;
            }
            length = std::max(length, std::sqrt(square) - 0.5);
        }
        most = std::max(most, length);
    }
    return most;
}

TEST(Substeps, MoreOfThemHoldAHeavyChainBetter) {
    const double usual = stretch(4);
    const double many = stretch(16);
    EXPECT_GT(usual, 0.002);
    EXPECT_LT(many, usual / 2);
}

/// 0.25 m less one tick's g t^2 / 2 (n + 1) / n of n substeps, by the closed form of semi-implicit
/// Euler: h^2 g N (N + 1) / 2 after N steps of h.
TEST(Substeps, AFreeFallIsThatOfItsStepLength) {
    for (const std::uint32_t substeps : {1U, 3U, 16U}) {
        DynamicsBench bench({}, 8);
        BodyDefinition usual = ball(0.1, vec(0, 0, 0));
        BodyDefinition own = ball(0.1, vec(5, 0, 0));
        own.substeps = substeps;
        const BodyRow first = bench.add(usual);
        const BodyRow second = bench.add(own);
        bench.run(30);
        const auto fallen = [](double count) {
            const double h = 1 / (60.0 * count);
            const double steps = 30 * count;
            return 9.81 * h * h * steps * (steps + 1) / 2;
        };
        EXPECT_NEAR(-bench.position(first, 1), fallen(4), 1e-4);
        EXPECT_NEAR(-bench.position(second, 1), fallen(substeps), 1e-4);
    }
}

using Build = std::function<void(DynamicsBench&)>;

/// Rows from `first` of `whole` are the rows of `part`, to the bit.
void expect_same_rows(DynamicsBench& part, DynamicsBench& whole, BodyRow first) {
    for (BodyRow row = 0; row < part.state().motion_count; ++row) {
        BodyMotion other = whole.motion(first + row);
        other.id = part.motion(row).id;
        ASSERT_EQ(std::memcmp(&part.motion(row), &other, sizeof other), 0) << row;
    }
}

/// Three groups of 4 (the settings'), 1 and 16 substeps: in one world, and each in its own.
TEST(Substeps, MixedIslandsDoAsTheyDoAlone) {
    const Build builds[] = {
        [](DynamicsBench& bench) {
            bench.add(fixed(box(8, 1, 8, vec(0, -1, 0))));
            add_pile(bench, 0, 0);
        },
        [](DynamicsBench& bench) {
            bench.add(fixed(box(8, 1, 8, vec(100, -1, 0))));
            add_pile(bench, 100, 1);
        },
        [](DynamicsBench& bench) {
            bench.add(fixed(box(8, 1, 8, vec(200, -1, 0))));
            add_pile(bench, 200, 16);
            add_chain(bench, 210, 16);
        },
    };
    DynamicsBench whole({}, 128);
    std::vector<std::unique_ptr<DynamicsBench>> parts;
    std::vector<BodyRow> first;
    for (const Build& build : builds) {
        first.push_back(whole.state().motion_count);
        parts.push_back(std::make_unique<DynamicsBench>(WorldSettings{}, 128));
        build(*parts.back());
    }
    // Joints name bodies by row: the chain comes first in its own world, so it is added last here.
    for (const Build& build : builds) {
        first[static_cast<std::size_t>(&build - builds)] = whole.state().motion_count;
        build(whole);
    }
    std::size_t hits = 0;
    for (int tick = 0; tick < 200; ++tick) {
        whole.step();
        std::size_t of_parts = 0;
        for (std::size_t part = 0; part < parts.size(); ++part) {
            parts[part]->step();
            of_parts += parts[part]->dynamics().contact_hits().size();
            expect_same_rows(*parts[part], whole, first[part]);
            if (HasFatalFailure()) {
                FAIL() << "part " << part << " tick " << tick;
            }
        }
        hits += of_parts;
        ASSERT_EQ(whole.dynamics().contact_hits().size(), of_parts);
    }
    EXPECT_GT(hits, 30U);
}

/// A kinematic platform that carries two islands of different substeps moves once.
TEST(Substeps, WhatCarriesSeveralClassesMovesOnce) {
    DynamicsBench bench({}, 16);
    BodyDefinition platform = box(10, 0.5, 10, vec(0, -0.5, 0));
    platform.mode = BodyMode::kinematic;
    platform.linear_velocity = vec(1, 0, 0);
    const BodyRow carrier = bench.add(platform);
    std::vector<BodyRow> loads;
    for (const std::uint32_t substeps : {1U, 4U, 9U, 16U}) {
        BodyDefinition load = cube(0.5, vec(3.0 * static_cast<double>(loads.size()) - 5, 0.5, 0));
        load.substeps = substeps;
        load.linear_velocity = vec(1, 0, 0);
        loads.push_back(bench.add(load));
    }
    bench.run(120);
    EXPECT_NEAR(bench.position(carrier, 0), 2, 1e-6);
    for (const BodyRow load : loads) {
        EXPECT_NEAR(bench.velocity(load, 0), 1, 1e-3);
        EXPECT_NEAR(bench.position(load, 1), 0.5, 0.01);
    }
}

} // namespace
} // namespace lockwind
