#include "tests/simulation/draws.h"
#include "tests/simulation/measures.h"

#include <gtest/gtest.h>

// Bodies near the longest for their thickness.
namespace lockwind::test {
namespace {

constexpr double kPushOut = 3; // m/s, the fastest that overlaps come apart

/// Capsule, box or prism of six sides, 5 to `slenderness` times as long as thick.
ShapeDefinition
random_rod(Draws& draws, double half_length, double slenderness, WorldDefinition& scene) {
    const double thick = std::max(0.0101, half_length / draws.uniform(5, slenderness));
    ShapeDefinition shape;
    switch (static_cast<int>(draws.uniform(0, 3))) {
    case 0:
        shape.type = ShapeType::capsule;
        shape.radius = real(thick);
        shape.half_height = real(half_length - thick);
        break;
    case 1:
        shape.type = ShapeType::box;
        shape.half_extents = vec(thick, 0.9 * half_length, thick * draws.uniform(1, 3));
        break;
    default: {
        HullDefinition prism;
        const double radius = std::max(0.013, thick); // faces at least 2 cm apart
        for (int point = 0; point < 12; ++point) {
            const double angle = point * std::numbers::pi / 3;
            prism.points.push_back(vec(radius * std::cos(angle) * draws.uniform(0.95, 1.05),
                                       (point < 6 ? -0.9 : 0.9) * half_length,
                                       radius * std::sin(angle) * draws.uniform(0.95, 1.05)));
        }
        shape.type = ShapeType::hull;
        shape.hull = static_cast<std::uint32_t>(scene.hulls.size());
        scene.hulls.push_back(prism);
    }
    }
    return shape;
}

/// A thin plate, fixed or not, that two rods pass through any way. Nothing pulls.
WorldDefinition plate_with_rods(std::uint64_t seed, double slenderness) {
    Draws draws(seed);
    WorldDefinition scene;
    scene.settings.bounds = 500;
    scene.settings.sleep_seconds = 0;
    scene.settings.gravity = {};
    const double half = draws.scale(0.2, 4);
    const bool fixed = draws.chance(0.33);
    const double thin = fixed ? draws.uniform(0.01, 0.1) : half * draws.uniform(0.15, 0.3);
    BodyDefinition plate = box(1, {}, vec(half, thin, half * draws.uniform(0.5, 1)));
    plate.mode = fixed ? BodyMode::fixed : BodyMode::dynamic;
    plate.density = real(draws.scale(100, 5000));
    plate.friction = real(draws.uniform(0, 2));
    scene.bodies.push_back(plate);
    for (BodyId id = 2; id < 4; ++id) {
        const double half_length = draws.scale(0.3, 5);
        BodyDefinition rod;
        rod.id = id;
        rod.shape = random_rod(draws, half_length, slenderness, scene);
        rod.density = real(draws.scale(100, 5000));
        rod.friction = real(draws.uniform(0, 2));
        rod.orientation = turn(draws.direction(), draws.uniform(0, 3.14));
        rod.position = vec(draws.direction() * draws.uniform(0, 0.8 * half_length));
        rod.linear_velocity = vec(draws.direction() * draws.uniform(0, 20));
        const Vector spin = draws.direction() * draws.uniform(0, 10);
        rod.angular_velocity = rod.shape.type == ShapeType::hull ? Vec3{} : vec(spin);
        scene.bodies.push_back(rod);
    }
    return scene;
}

/// J; of hulls, which start without spin, what their speed has.
double speed_energy(const World& world) {
    double sum = 0;
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        const BodyView body = world.body_at(row);
        const Vector velocity = vector_of(body.linear_velocity);
        if (body.mode == BodyMode::dynamic) {
            sum += body.shape.type == ShapeType::hull
                       ? to_double(body.mass) * dot(velocity, velocity) / 2
                       : kinetic_energy(body);
        }
    }
    return sum;
}

/// What overlaps may give: every body the push-out speed.
double push_out_energy(const World& world) {
    double mass = 0;
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        mass += to_double(world.body_at(row).mass);
    }
    return mass * kPushOut * kPushOut / 2;
}

TEST(SlenderBodies, DeepInThinPlatesStayWithinTheFormats) {
    // A checked build traps what leaves a format; elsewhere it shows as a blow of many times the
    // energy.
    const std::uint64_t scenes = long_tests() ? 5000 : 300;
    for (std::uint64_t seed = 0; seed < scenes; ++seed) {
        const WorldPtr world = make_world(plate_with_rods(seed, 9.5));
        const double most = 1.5 * (speed_energy(*world) + push_out_energy(*world));
        for (int tick = 0; tick < 200; ++tick) {
            step_idle(*world);
            ASSERT_LT(speed_energy(*world), most) << "scene " << seed << " tick " << tick;
        }
    }
}

TEST(SlenderBodies, SlenderestOnesDeepInThinPlatesStayWithinTheFormats) {
    // For a checked build. What overlaps so deep may gain energy: rows of two contacts couple 60
    // times as strongly as they carry mass.
    const std::uint64_t scenes = long_tests() ? 5000 : 300;
    for (std::uint64_t seed = 0; seed < scenes; ++seed) {
        const WorldPtr world = make_world(plate_with_rods(seed, 27));
        step_idle(*world, 200);
        ASSERT_TRUE(world->check().ok()) << "scene " << seed;
    }
}

/// 2.4 m long and 10 cm thick.
BodyDefinition pole(BodyId id, ShapeType type) {
    return type == ShapeType::box ? box(id, {}, {0.05, 1.2, 0.05}) : capsule(id, {}, 0.05, 1.15);
}

class Poles : public testing::TestWithParam<ShapeType> {};

TEST_P(Poles, FallOverLieStillAndSleep) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    BodyDefinition body = pole(2, GetParam());
    body.orientation = turn({0, 0, 1}, 0.1);
    body.position = {0, 1.25, 0};
    scene.bodies.push_back(body);
    const WorldPtr world = make_world(scene);
    double most = energy(*world);
    for (int tick = 0; tick < 900; ++tick) {
        step_idle(*world);
        ASSERT_LT(energy(*world), most + 1e-6 * most) << tick;
        most = std::min(most, energy(*world) + 0.02 * most);
    }
    const BodyView view = world->body(2).value();
    EXPECT_NEAR(to_double(view.position.y), 0.05, 0.006);
    EXPECT_NEAR(turned(view.orientation, {0, 1, 0}).y, 0, 0.003);
    EXPECT_EQ(world->counts().awake, 0U);
}

TEST_P(Poles, StandOnARampAcrossItsSlope) {
    // A ramp of 20 degrees is a floor under gravity that leans; the pole lies down the slope.
    const double slope = 20 * std::numbers::pi / 180;
    WorldDefinition scene;
    scene.settings.gravity = vec(kGravity * std::sin(slope), -kGravity * std::cos(slope), 0);
    scene.bodies.push_back(ground(1));
    BodyDefinition body = pole(2, GetParam());
    body.orientation = turn({0, 0, 1}, std::numbers::pi / 2);
    body.position = {0, 0.05, 0};
    body.friction = 0.8;
    scene.bodies.push_back(body);
    scene.bodies[0].friction = 0.8;
    const WorldPtr world = make_world(scene);
    step_idle(*world, 60);
    const Vector before = vector_of(world->body(2)->position);
    step_idle(*world, 300);
    EXPECT_LT(length(vector_of(world->body(2)->position) - before), 1e-3);
}

TEST_P(Poles, KeepTheirMomentumInFreeFlight) {
    WorldDefinition scene;
    scene.settings.gravity = {};
    scene.settings.bounds = 500;
    BodyDefinition body = pole(1, GetParam());
    body.angular_velocity = {3, 4, 1};
    scene.bodies.push_back(body);
    const WorldPtr world = make_world(scene);
    const Vector before = angular_momentum(world->body_at(0));
    const double energy_before = kinetic_energy(*world);
    for (int tick = 0; tick < 600; ++tick) {
        step_idle(*world);
        const Vector now = angular_momentum(world->body_at(0));
        ASSERT_LT(length(now - before), 0.002 * length(before)) << tick;
        // Of second order in the tick, without drift.
        ASSERT_NEAR(kinetic_energy(*world), energy_before, 0.05 * energy_before) << tick;
    }
}

INSTANTIATE_TEST_SUITE_P(Shapes,
                         Poles,
                         testing::Values(ShapeType::box, ShapeType::capsule),
                         [](const testing::TestParamInfo<ShapeType>& shape) {
                             return shape.param == ShapeType::box ? "Box" : "Capsule";
                         });

TEST(SlenderBodies, PoleRollsDownARampAsASolidCylinderDoes) {
    // a = g sin / (1 + I / m r^2): about its long axis, too, it has its true moment of inertia.
    const double slope = 10 * std::numbers::pi / 180;
    WorldDefinition scene;
    scene.settings.gravity = vec(0, -kGravity * std::cos(slope), kGravity * std::sin(slope));
    scene.settings.sleep_seconds = 0;
    scene.bodies.push_back(ground(1));
    BodyDefinition body = pole(2, ShapeType::capsule);
    body.orientation = turn({0, 0, 1}, std::numbers::pi / 2);
    body.position = {0, 0.05, 0};
    scene.bodies.push_back(body);
    const WorldPtr world = make_world(scene);
    step_idle(*world, 60);
    const double start = to_double(world->body(2)->linear_velocity.z);
    step_idle(*world, 120);
    const double gained = to_double(world->body(2)->linear_velocity.z) - start;
    const double k = inertia_of(body.shape, 1).y / (0.05 * 0.05);
    EXPECT_NEAR(gained, 2 * kGravity * std::sin(slope) / (1 + k), 0.01 * gained);
}

} // namespace
} // namespace lockwind::test
