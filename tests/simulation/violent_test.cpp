#include "tests/simulation/draws.h"
#include "tests/support/code_scenes.h"

#include <gtest/gtest.h>

// Motors and springs far too strong for what they move, between bodies that overlap. What contacts
// and joints make of that must stay in the solver's formats: a CHECKED build traps what leaves
// them.
namespace lockwind::test {
namespace {

constexpr int kScenes = 60;
constexpr int kTicks = 150;

BodyDefinition random_body(Draws& draws, BodyId id) {
    const double size = draws.scale(0.1, 3);
    const auto side = [&] { return real(size * draws.uniform(0.3, 1)); };
    BodyDefinition body =
        draws.chance(0.3) ? sphere(id, {}, side()) : box(id, {}, {side(), side(), side()});
    if (draws.chance(0.2)) { // a rod, whose ends are far from its centre
        body.shape.half_extents = {0.05, 0.05, real(draws.uniform(0.5, 1.2))};
        body.shape.type = ShapeType::box;
    }
    body.orientation = turn(draws.direction(), draws.uniform(0, 3));
    body.friction = real(draws.uniform(0, 4));
    body.restitution = real(draws.chance(0.5) ? draws.uniform(0, 1) : 0);
    body.linear_velocity = vec(draws.direction() * draws.uniform(0, 80));
    if (draws.chance(0.3)) {
        body.mass = real(draws.scale(0.01, 100000));
    }
    return body;
}

JointDefinition random_joint(Draws& draws, JointId id, BodyId a, BodyId b) {
    constexpr JointKind kKinds[] = {JointKind::hinge,
                                    JointKind::slider,
                                    JointKind::wheel,
                                    JointKind::distance,
                                    JointKind::ball,
                                    JointKind::grab};
    JointDefinition joint;
    joint.id = id;
    joint.kind = kKinds[static_cast<int>(draws.uniform(0, 6))];
    joint.body_a = joint.kind == JointKind::grab ? 0 : a;
    joint.body_b = b;
    joint.anchor_a = vec(draws.direction() * draws.uniform(0, 1));
    joint.anchor_b = vec(draws.direction() * draws.uniform(0, 1));
    joint.frame_a = turn(draws.direction(), draws.uniform(0, 3));
    joint.frame_b = turn(draws.direction(), draws.uniform(0, 3));
    joint.collide_connected = draws.chance(0.5);
    joint.has_motor = joint.kind == JointKind::hinge || joint.kind == JointKind::slider ||
                      joint.kind == JointKind::wheel;
    joint.motor_speed = real(draws.uniform(-1000, 1000));
    joint.motor_max = real(draws.scale(100, 1e9));
    joint.has_spring = joint.kind == JointKind::distance;
    joint.spring_hertz = real(draws.uniform(5, 60));
    joint.rest_length = real(draws.uniform(0, 20));
    joint.target = joint.anchor_a;
    return joint;
}

/// Ids from 1000 on, about `place`.
void add_violence(WorldDefinition& scene, std::uint64_t seed, const Vector& place) {
    Draws draws(seed);
    const auto count = static_cast<BodyId>(draws.uniform(6, 20));
    const double spread = draws.uniform(0.2, 1.5);
    for (BodyId index = 0; index < count; ++index) {
        BodyDefinition body = random_body(draws, 1000 + index);
        body.position = vec(place + draws.direction() * spread);
        scene.bodies.push_back(body);
    }
    for (BodyId index = 1; index < count; ++index) {
        const auto other = static_cast<BodyId>(draws.uniform(0, static_cast<double>(index)));
        scene.joints.push_back(random_joint(draws, index, 1000 + other, 1000 + index));
    }
}

WorldDefinition ground_scene() {
    WorldDefinition scene;
    scene.settings.linear_speed_max = 500;
    scene.settings.angular_speed_max = 1000;
    scene.settings.body_capacity = 64;
    scene.settings.bounds = 8000;
    scene.bodies.push_back(ground(1));
    return scene;
}

/// Throws one of the bodies as fast and with as much spin as there is.
void throw_one(Draws& draws, World& world) {
    const auto count = static_cast<double>(world.body_count());
    const BodyView body = world.body_at(static_cast<BodyRow>(draws.uniform(0, count)));
    const auto draw = [&](double most) { return real(draws.uniform(-most, most)); };
    world.set_velocity(
        body.id, {draw(500), draw(500), draw(500)}, {draw(1000), draw(1000), draw(1000)});
}

TEST(Violence, LeavesAStateThatIsValid) {
    int fast = 0;
    for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
        Draws draws(1000 + seed);
        WorldDefinition scene = ground_scene();
        scene.settings.tick_rate_hz = static_cast<std::uint32_t>(draws.uniform(10, 241));
        scene.settings.substeps = static_cast<std::uint32_t>(draws.uniform(1, 9));
        add_violence(scene, seed, {0, 2, 0});
        const WorldPtr world = make_world(scene);
        for (int tick = 0; tick < kTicks; ++tick) {
            if (seed % 2 == 0 && tick % 5 == 0) {
                throw_one(draws, *world);
            }
            step_idle(*world);
            ASSERT_TRUE(world->check().ok()) << seed << " at " << tick;
            for (const ContactView& contact : world->contacts()) {
                const Vector velocity = vector_of(world->body(contact.body_b)->linear_velocity);
                fast += length(velocity) > 200 ? 1 : 0;
            }
        }
    }
    EXPECT_GT(fast, 1000);
}

TEST(Violence, ChangesNoBitOfWhatIsFarAway) {
    const auto add_pile = [](WorldDefinition& scene) {
        for (BodyId index = 0; index < 24; ++index) {
            const Vec3 place{Real(index % 3) * Real(0.9), Real(index / 6 + 1) * Real(1.2), 0};
            scene.bodies.push_back(index % 2 == 0 ? box(10 + index, place, {0.4, 0.4, 0.4})
                                                  : capsule(10 + index, place, 0.3, 0.2));
        }
    };
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        WorldDefinition alone = ground_scene();
        WorldDefinition both = ground_scene();
        add_pile(alone);
        add_pile(both);
        add_violence(both, seed, {3000, 2, 0});
        const WorldPtr a = make_world(alone);
        const WorldPtr b = make_world(both);
        for (int tick = 0; tick < kTicks; ++tick) {
            step_idle(*a);
            step_idle(*b);
            for (BodyId id = 10; id < 34; ++id) {
                ASSERT_EQ(a->body(id)->position, b->body(id)->position) << tick;
                ASSERT_EQ(a->body(id)->linear_velocity, b->body(id)->linear_velocity) << tick;
                ASSERT_EQ(a->body(id)->angular_velocity, b->body(id)->angular_velocity) << tick;
            }
        }
    }
}

} // namespace
} // namespace lockwind::test
