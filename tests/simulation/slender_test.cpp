#include "tests/simulation/draws.h"
#include "tests/simulation/measures.h"

#include <gtest/gtest.h>

// Bodies near the longest for their thickness.
namespace lockwind::test {
namespace {

constexpr double kPushOut = 3; // m/s, the fastest that overlaps come apart

/// Capsule, box or prism of six sides, 5 to 9.5 times as long as thick.
ShapeDefinition random_rod(Draws& draws, double half_length, WorldDefinition& scene) {
    const double thick = std::max(0.0101, half_length / draws.uniform(5, 9.5));
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
        for (int point = 0; point < 12; ++point) {
            const double angle = point * std::numbers::pi / 3;
            prism.points.push_back(vec(thick * std::cos(angle) * draws.uniform(0.95, 1.05),
                                       (point < 6 ? -0.9 : 0.9) * half_length,
                                       thick * std::sin(angle) * draws.uniform(0.95, 1.05)));
        }
        shape.type = ShapeType::hull;
        shape.hull = static_cast<std::uint32_t>(scene.hulls.size());
        scene.hulls.push_back(prism);
    }
    }
    return shape;
}

/// A thin plate, fixed or not, that two rods pass through any way. Nothing pulls.
WorldDefinition plate_with_rods(std::uint64_t seed) {
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
        rod.shape = random_rod(draws, half_length, scene);
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
        const WorldPtr world = make_world(plate_with_rods(seed));
        const double most = 1.5 * (speed_energy(*world) + push_out_energy(*world));
        for (int tick = 0; tick < 200; ++tick) {
            step_idle(*world);
            ASSERT_LT(speed_energy(*world), most) << "scene " << seed << " tick " << tick;
        }
    }
}

} // namespace
} // namespace lockwind::test
