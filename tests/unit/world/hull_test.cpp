#include "dynamics/body.h"
#include "dynamics/contact.h"
#include "tests/support/code_scenes.h"
#include "world/state.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

double value(Real real) {
    return static_cast<double>(real.raw()) * 0x1p-32;
}

Real real(double metres) {
    return Real::from_raw(std::llround(metres * 0x1p32));
}

BodyDefinition hull(BodyId id, const Vec3& position, std::uint32_t index) {
    BodyDefinition body;
    body.id = id;
    body.shape.type = ShapeType::hull;
    body.shape.hull = index;
    body.position = position;
    return body;
}

HullDefinition cube(Real half) {
    HullDefinition result;
    for (int corner = 0; corner < 8; ++corner) {
        result.points.push_back({(corner & 1) != 0 ? half : -half,
                                 (corner & 2) != 0 ? half : -half,
                                 (corner & 4) != 0 ? half : -half});
    }
    return result;
}

/// Its centre of mass lies off its origin, and its principal axes off its own.
HullDefinition lopsided() {
    return {{{1, 0, 0}, {2, 0.5, 0}, {1, 1.5, 0.25}, {1.25, 0.25, 1}, {2, 1, 1.5}}};
}

HullDefinition tetrahedron(Real half) {
    return {{{half, half, half}, {half, -half, -half}, {-half, half, -half}, {-half, -half, half}}};
}

template <class Row>
Row* rows(World& world, std::uint32_t section) {
    return reinterpret_cast<Row*>(world.section_bytes(section).data());
}

/// Deepest overlap of the contacts when they were found, m.
double deepest(World& world) {
    const auto* manifolds = rows<Manifold>(world, section::kManifold);
    std::int32_t lowest = 0;
    for (std::uint32_t row = 0; row < world.row_count(section::kManifold); ++row) {
        for (std::uint32_t point = 0; point < manifolds[row].point_count; ++point) {
            lowest = std::min(lowest, manifolds[row].separation[point]);
        }
    }
    return -lowest * 0x1p-22;
}

TEST(HullBody, ReadsBackWhereItWasPut) {
    WorldDefinition scene;
    scene.hulls = {cube(0.5), lopsided()};
    BodyDefinition body = hull(1, {3, 4, -5}, 1);
    body.orientation = {0.5, -0.5, 0.5, 0.5};
    body.linear_velocity = {1, 2, 3};
    scene.bodies = {body};
    const WorldPtr world = make_world(scene);
    const BodyView view = world->body_at(0);
    EXPECT_EQ(view.shape.type, ShapeType::hull);
    EXPECT_EQ(view.shape.hull, 1U);
    EXPECT_EQ(view.linear_velocity, (Vec3{1, 2, 3}));
    const double found[7] = {value(view.position.x),
                             value(view.position.y),
                             value(view.position.z),
                             value(view.orientation.x),
                             value(view.orientation.y),
                             value(view.orientation.z),
                             value(view.orientation.w)};
    const double expected[7] = {3, 4, -5, 0.5, -0.5, 0.5, 0.5};
    for (int index = 0; index < 7; ++index) {
        EXPECT_NEAR(found[index], expected[index], 1e-8) << index;
    }
    // Rays see it there: its corner (2, 1, 1.5) is turned to (1.5, -2, -1) by that orientation.
    const auto* motion = rows<BodyMotion>(*world, section::kBody);
    EXPECT_GT(std::abs(static_cast<double>(motion->position[0]) * 0x1p-32 - 3), 0.5);
}

TEST(HullBody, CubeFallsAndRestsWhereTheBoxWould) {
    WorldDefinition scene;
    scene.hulls = {cube(0.5)};
    scene.bodies = {ground(1), hull(2, {0, 0.6, 0}, 0), box(3, {5, 0.6, 0}, {0.5, 0.5, 0.5})};
    const WorldPtr world = make_world(scene);
    step_idle(*world, 120);
    EXPECT_NEAR(value(world->body_at(1).position.y), value(world->body_at(2).position.y), 1e-4);
    EXPECT_NEAR(value(world->body_at(1).position.y), 0.5, 2e-3);
    EXPECT_EQ(world->counts().contacts, 8U);
}

/// Kinetic friction on an incline: a = g (sin - mu cos), and rest below the angle of friction.
TEST(HullBody, SlidesDownAWedgeAtTheAnalyticRate) {
    for (const double degrees : {20.0, 35.0}) {
        const double angle = degrees * 3.14159265358979323846 / 180;
        const Real rise = real(20 * std::tan(angle));
        WorldDefinition scene;
        HullDefinition wedge;
        for (const Real z : {Real(-3), Real(3)}) {
            wedge.points.insert(wedge.points.end(), {{0, 0, z}, {20, 0, z}, {0, rise, z}});
        }
        scene.hulls = {cube(0.25), wedge};
        BodyDefinition ramp = hull(1, {0, 0, 0}, 1);
        ramp.mode = BodyMode::fixed;
        // Halfway up, flat on the slope, which falls towards +x.
        BodyDefinition block = hull(2, {}, 0);
        block.position = {real(8 + 0.25 * std::sin(angle)),
                          real(12 * std::tan(angle) + 0.25 * std::cos(angle)),
                          0};
        block.orientation = {0, 0, real(-std::sin(angle / 2)), real(std::cos(angle / 2))};
        scene.bodies = {ramp, block};
        const WorldPtr world = make_world(scene);
        step_idle(*world, 30);
        const double from = value(world->body_at(1).position.x);
        const double speed = value(world->body_at(1).linear_velocity.x) / std::cos(angle);
        step_idle(*world, 60);
        const double way = (value(world->body_at(1).position.x) - from) / std::cos(angle);
        const double rate = 9.81 * (std::sin(angle) - 0.5 * std::cos(angle));
        const double expected = rate > 0 ? speed + rate / 2 : 0;
        EXPECT_NEAR(way, expected, 0.03 * expected + 0.002) << degrees;
    }
}

TEST(HullBody, PyramidOfCubesStandsAsOneOfBoxes) {
    WorldDefinition scene;
    scene.hulls = {cube(0.5)};
    scene.bodies = {ground(1)};
    BodyId id = 2;
    for (int row = 0; row < 10; ++row) {
        for (int index = 0; index < 10 - row; ++index) {
            const Real x = (Real(2 * index) - Real(9 - row)) * Real(1.05) / Real(2);
            scene.bodies.push_back(hull(id++, {x, Real(row) + Real(0.5), 0}, 0));
        }
    }
    const WorldPtr world = make_world(scene);
    step_idle(*world, 600);
    double drift = 0;
    for (BodyRow row = 1; row < world->body_count(); ++row) {
        const Vec3 way = world->body_at(row).position - scene.bodies[row].position;
        drift = std::max(drift, std::hypot(value(way.x), value(way.y), value(way.z)));
    }
    EXPECT_LT(drift, 0.035); // the bound that boxes are held to
}

TEST(HullBody, HeapOfTetrahedraSettles) {
    WorldDefinition scene;
    scene.hulls = {tetrahedron(0.4)};
    scene.bodies = {ground(1)};
    for (std::uint32_t index = 0; index < 60; ++index) {
        BodyDefinition body = hull(2 + index,
                                   {Real(index % 4) * Real(1.4) - Real(2.1),
                                    Real(index / 16) * Real(1.4) + Real(1),
                                    Real(index / 4 % 4) * Real(1.4) - Real(2.1)},
                                   0);
        body.orientation = random_orientation(7, index);
        scene.bodies.push_back(body);
    }
    const WorldPtr world = make_world(scene);
    // m^2/s^2: none can be faster than its fall made it, nor deeper than it moves in a tick.
    const double fall = 9.81 * 6;
    for (int tick = 0; tick < 600; ++tick) {
        step_idle(*world, 1);
        for (BodyRow row = 1; row < world->body_count(); ++row) {
            const BodyView body = world->body_at(row);
            ASSERT_GT(value(body.position.y), 0.1) << "body " << body.id << " tick " << tick;
            ASSERT_LT(value(dot(body.linear_velocity, body.linear_velocity)), 2 * fall);
        }
        ASSERT_LT(deepest(*world), std::sqrt(2 * fall) / 60) << tick;
    }
    double energy = 0;
    for (BodyRow row = 1; row < world->body_count(); ++row) {
        const BodyView body = world->body_at(row);
        energy += value(dot(body.linear_velocity, body.linear_velocity)) / 2;
        for (const Vec3& corner : scene.hulls[0].points) {
            EXPECT_GT(value((body.position + rotate(body.orientation, corner)).y), -0.01)
                << body.id;
        }
    }
    EXPECT_LT(energy / 60, 0.01); // J/kg: 0.14 m/s
    EXPECT_GT(world->counts().contacts, 150U);
    EXPECT_TRUE(world->check().ok());
}

/// Anchors and axes are given in the frame of the points, not in that of the principal axes.
TEST(HullBody, HangsByAnAnchorAmongItsPoints) {
    for (const JointKind kind : {JointKind::ball, JointKind::fixed}) {
        WorldDefinition scene;
        scene.hulls = {lopsided()};
        BodyDefinition post = box(1, {0, 5, 0}, {0.1, 0.1, 0.1});
        post.mode = BodyMode::fixed;
        BodyDefinition body = hull(2, {0.5, 3, 0.25}, 0);
        body.orientation = {0.5, -0.5, 0.5, 0.5};
        scene.bodies = {post, body};
        JointDefinition joint;
        joint.id = 1;
        joint.kind = kind;
        joint.body_a = 1;
        joint.body_b = 2;
        joint.anchor_b = {2, 1, 1.5};
        const Vec3 anchor = body.position + rotate(body.orientation, joint.anchor_b);
        joint.anchor_a = anchor - post.position;
        joint.frame_a = body.orientation;
        scene.joints = {joint};
        const WorldPtr world = make_world(scene);
        double farthest = 0; // of the body's origin from where it began
        for (int tick = 0; tick < 120; ++tick) {
            step_idle(*world, 1);
            const BodyView view = world->body_at(1);
            const Vec3 off = view.position + rotate(view.orientation, joint.anchor_b) - anchor;
            ASSERT_LT(std::hypot(value(off.x), value(off.y), value(off.z)), 1e-3) << tick;
            const Vec3 way = view.position - body.position;
            farthest = std::max(farthest, std::hypot(value(way.x), value(way.y), value(way.z)));
        }
        EXPECT_EQ(farthest > 0.1, kind == JointKind::ball) << farthest;
        EXPECT_EQ(farthest < 0.01, kind == JointKind::fixed) << farthest;
    }
}

TEST(HullBody, FacesItsPlayersWayAsAPod) {
    // The principal axes of this hull are none of its own: thrust must still go along its +z.
    WorldDefinition scene;
    scene.hulls = {{{{-0.5, -0.3, -0.7},
                     {0.7, -0.3, -0.6},
                     {-0.5, -0.3, 0.7},
                     {0.5, -0.3, 0.6},
                     {-0.5, 0.3, -0.7},
                     {0.2, 0.3, 0.9},
                     {0.4, 0.1, -0.2}}}};
    BodyDefinition body = hull(2, {0, 5, 0}, 0);
    body.density = 300;
    scene.bodies = {body};
    PodDefinition pod;
    pod.body = 2;
    scene.pods = {pod};
    scene.settings.gravity = {};
    const WorldPtr world = make_world(scene);
    std::vector<SlotInput> inputs(1);
    PlayerInput input;
    input.thrust = 32767;
    encode(input, inputs[0]);
    ASSERT_TRUE(world->step(inputs).ok());
    const Vec3 velocity = world->body_at(0).linear_velocity;
    EXPECT_NEAR(value(velocity.z), 25.0 / 60, 1e-3);
    EXPECT_NEAR(value(velocity.x), 0, 1e-4);
}

TEST(HullSnapshot, RefusesHullsAndAxesThatAreNot) {
    WorldDefinition scene;
    scene.hulls = {cube(0.5), tetrahedron(0.4)};
    scene.bodies = {ground(1), hull(2, {0, 0.5, 0}, 0), hull(3, {0, 1.3, 0}, 1)};
    const WorldPtr world = make_world(scene);
    step_idle(*world, 30);
    std::vector<std::byte> sound;
    world->save(sound);
    const auto refuses = [&](auto&& damage) {
        EXPECT_TRUE(world->load(sound).ok());
        damage();
        std::vector<std::byte> damaged;
        world->save(damaged);
        EXPECT_TRUE(world->load(sound).ok());
        return !world->load(damaged).ok();
    };
    const auto kind_of = [&](BodyRow row) -> BodyProperties& {
        const BodyLife* lives = rows<BodyLife>(*world, section::kBodyLife);
        return rows<BodyProperties>(*world, section::kBodyKind)[lives[row].body_kind];
    };
    const auto manifolds = [&] { return rows<Manifold>(*world, section::kManifold); };
    EXPECT_TRUE(refuses([&] { kind_of(1).shape_index = 2; }));
    EXPECT_TRUE(refuses([&] { kind_of(1).shape_index = 1; })); // another build
    EXPECT_TRUE(refuses([&] { kind_of(0).shape_index = 1; })); // a plane has none
    EXPECT_TRUE(refuses([&] { kind_of(1).shape = 2; }));
    EXPECT_TRUE(refuses([&] { kind_of(1).size[0] = 1; }));
    EXPECT_TRUE(refuses([&] { manifolds()[0].axis = 129; }));
    // What is in range but names no face is taken, and stepped.
    EXPECT_FALSE(refuses([&] {
        for (std::uint32_t row = 0; row < world->row_count(section::kManifold); ++row) {
            if (manifolds()[row].point_count != 0) {
                manifolds()[row].axis = 120;
            }
        }
    }));
    step_idle(*world, 5);
}

TEST(HullWorld, ErrorsNameHullAndBody) {
    WorldDefinition scene;
    scene.hulls = {cube(0.5), {{{0, 0, 0}, {1, 0, 0}}}};
    const Result<WorldPtr> flat = World::create(scene);
    ASSERT_FALSE(flat.ok());
    EXPECT_EQ(flat.error().message,
              "hull 1: has 2 different points; give at least 4 that stand out of one plane");
    scene.hulls.pop_back();
    scene.bodies = {hull(7, {0, 0, 0}, 1)};
    const Result<WorldPtr> unknown = World::create(scene);
    ASSERT_FALSE(unknown.ok());
    EXPECT_EQ(unknown.error().message, "body 7: shape.hull is 1; there are 1 hulls");
}

} // namespace
} // namespace lockwind::test
