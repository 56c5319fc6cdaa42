#include "tests/simulation/draws.h"
#include "tests/simulation/measures.h"

#include <gtest/gtest.h>
#include <iostream>
#include <numbers>

// Random scenes of all shapes, sizes and materials in a pit of planes. Nothing may gain energy,
// leave, or stay in another.
namespace lockwind::test {
namespace {

constexpr double kPit = 25; // m from the middle to each wall
constexpr int kBodies = 24;
constexpr int kTicks = 600;
constexpr double kPushOut = 3; // m/s, the fastest that overlaps come apart

/// Reach of 0.05 to 5 m, no side below a fifth of it.
ShapeDefinition random_shape(Draws& draws) {
    ShapeDefinition shape;
    const double size = draws.scale(0.05, 5);
    const auto side = [&] { return real(std::max(0.02, size * draws.uniform(0.2, 0.577))); };
    switch (static_cast<int>(draws.uniform(0, 3))) {
    case 0:
        shape.type = ShapeType::sphere;
        shape.radius = real(size);
        break;
    case 1:
        shape.type = ShapeType::capsule;
        shape.radius = side();
        shape.half_height = real(std::max(0.02, size * draws.uniform(0.1, 0.4)));
        break;
    default:
        shape.type = ShapeType::box;
        shape.half_extents = {side(), side(), side()};
    }
    return shape;
}

/// Five planes that look inwards: a floor at y = 0 and four walls.
void add_pit(WorldDefinition& scene, double friction) {
    const double quarter = std::numbers::pi / 2;
    const Vector axes[] = {{1, 0, 0}, {0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}};
    const Vector places[] = {{}, {-kPit, 0, 0}, {kPit, 0, 0}, {0, 0, -kPit}, {0, 0, kPit}};
    for (std::size_t index = 0; index < 5; ++index) {
        BodyDefinition plane = ground(1 + index);
        plane.orientation = turn(axes[index], index == 0 ? 0 : quarter);
        plane.position = vec(places[index]);
        plane.friction = real(friction);
        scene.bodies.push_back(plane);
    }
}

/// Bodies in a lattice whose cells hold the largest of them, or heaped together into one another.
WorldDefinition random_scene(std::uint64_t seed, bool overlaps) {
    Draws draws(seed);
    WorldDefinition scene;
    scene.settings.bounds = 500;
    scene.settings.sleep_seconds = draws.chance(0.5) ? Real(0.5) : Real(0);
    add_pit(scene, draws.uniform(0, 1));
    const bool bounces = draws.chance(0.5);
    const double spread = draws.uniform(0.2, 1);
    for (int index = 0; index < kBodies; ++index) {
        BodyDefinition body;
        body.id = 10 + static_cast<BodyId>(index);
        body.shape = random_shape(draws);
        body.density = real(draws.scale(100, 5000));
        body.friction = real(draws.uniform(0, 1.2));
        body.restitution = real(bounces ? draws.uniform(0, 1) : 0);
        body.orientation = turn(draws.direction(), draws.uniform(0, 3));
        body.linear_velocity = vec(draws.direction() * draws.uniform(0, 10));
        body.angular_velocity = vec(draws.direction() * draws.uniform(0, 5));
        const Vector cell{index % 3 * 11.0 - 11, index / 9 * 11.0 + 6, index / 3 % 3 * 11.0 - 11};
        const Vector heap{draws.uniform(-5, 5), draws.uniform(3, 8), draws.uniform(-5, 5)};
        body.position = vec(overlaps ? heap * spread + Vector{0, 2, 0} : cell);
        scene.bodies.push_back(body);
    }
    return scene;
}

/// Points of the body whose surface is within a radius of them: corners, or ends of the segment.
std::vector<Vector> corners_of(const BodyView& body) {
    std::vector<Vector> points;
    const Vector place = vector_of(body.position);
    if (body.shape.type == ShapeType::box) {
        const Vector half = vector_of(body.shape.half_extents);
        for (unsigned corner = 0; corner < 8; ++corner) {
            points.push_back(place + turned(body.orientation,
                                            {(corner & 1U) != 0 ? half.x : -half.x,
                                             (corner & 2U) != 0 ? half.y : -half.y,
                                             (corner & 4U) != 0 ? half.z : -half.z}));
        }
        return points;
    }
    const double half =
        body.shape.type == ShapeType::capsule ? to_double(body.shape.half_height) : 0;
    constexpr int kParts = 8;
    for (int part = 0; part <= kParts; ++part) {
        const double at = half * (2.0 * part / kParts - 1);
        points.push_back(place + turned(body.orientation, {0, at, 0}));
    }
    return points;
}

double radius_of(const BodyView& body) {
    return body.shape.type == ShapeType::box ? 0 : to_double(body.shape.radius);
}

/// From a point to the body's surface, negative inside.
double distance_to(const BodyView& body, const Vector& point) {
    const Vector local = turned_back(body.orientation, point - vector_of(body.position));
    if (body.shape.type == ShapeType::plane) {
        return local.y;
    }
    if (body.shape.type == ShapeType::box) {
        const Vector half = vector_of(body.shape.half_extents);
        const Vector off{
            std::abs(local.x) - half.x, std::abs(local.y) - half.y, std::abs(local.z) - half.z};
        const Vector out{std::max(off.x, 0.0), std::max(off.y, 0.0), std::max(off.z, 0.0)};
        return length(out) + std::min(std::max({off.x, off.y, off.z}), 0.0);
    }
    const double half =
        body.shape.type == ShapeType::capsule ? to_double(body.shape.half_height) : 0;
    return length(local - Vector{0, std::clamp(local.y, -half, half), 0}) - radius_of(body);
}

/// How deep corners and ends of one are in the other, m; 0 where they are apart.
double depth(const BodyView& a, const BodyView& b) {
    double least = 0;
    if (a.shape.type != ShapeType::plane) {
        for (const Vector& point : corners_of(a)) {
            least = std::min(least, distance_to(b, point) - radius_of(a));
        }
    }
    if (b.shape.type != ShapeType::plane) {
        for (const Vector& point : corners_of(b)) {
            least = std::min(least, distance_to(a, point) - radius_of(b));
        }
    }
    return -least;
}

struct Outcome {
    double gain = 0;    // the largest rise of the energy over the initial one, as part of it
    double depth = 0;   // m, at the end
    double outside = 0; // m beyond a wall or the floor, of centres, at any tick
    std::uint64_t contacts = 0;
};

double deepest(const World& world) {
    double deepest = 0;
    for (BodyRow a = 0; a < world.body_count(); ++a) {
        for (BodyRow b = a + 1; b < world.body_count(); ++b) {
            const BodyView body_b = world.body_at(b);
            if (body_b.mode != BodyMode::fixed) {
                deepest = std::max(deepest, depth(world.body_at(a), body_b));
            }
        }
    }
    return deepest;
}

/// Kinetic and potential energy, and what overlaps may add that come apart: the push-out speed of
/// every body, and its weight lifted by as much as the deepest overlap.
double energy_scale(const World& world, bool overlaps) {
    double mass = 0;
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        mass += to_double(world.body_at(row).mass);
    }
    const double lift = kGravity * deepest(world);
    return energy(world) + (overlaps ? mass * (kPushOut * kPushOut / 2 + lift) : 0);
}

void measure_places(const World& world, Outcome& outcome) {
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        const BodyView body = world.body_at(row);
        if (body.mode == BodyMode::dynamic) {
            const Vector place = vector_of(body.position);
            outcome.outside = std::max(
                {outcome.outside, std::abs(place.x) - kPit, std::abs(place.z) - kPit, -place.y});
        }
    }
}

Outcome run(std::uint64_t seed, bool overlaps) {
    const WorldPtr world = make_world(random_scene(seed, overlaps));
    const double scale = energy_scale(*world, overlaps);
    Outcome outcome;
    for (int tick = 1; tick <= kTicks; ++tick) {
        step_idle(*world);
        measure_places(*world, outcome);
        outcome.gain = std::max(outcome.gain, energy(*world) / scale - 1);
        outcome.contacts += world->counts().contacts;
        if (tick % 60 == 0) {
            const Status status = world->check();
            EXPECT_TRUE(status.ok()) << "scene " << seed << ": " << status.error().message;
        }
    }
    EXPECT_EQ(world->counts().bodies, kBodies + 5U) << "scene " << seed << ": somebody left";
    outcome.depth = deepest(*world);
    return outcome;
}

class Chaos : public testing::TestWithParam<bool> {};

TEST_P(Chaos, GainsNoEnergyAndKeepsEverybodyInAndApart) {
    const std::uint64_t scenes = long_tests() ? 500 : 30;
    Outcome worst;
    for (std::uint64_t seed = 0; seed < scenes; ++seed) {
        const Outcome outcome = run(seed, GetParam());
        if (long_tests()) {
            std::cout << "scene " << seed << " gain " << outcome.gain << " depth " << outcome.depth
                      << " outside " << outcome.outside << "\n";
        }
        worst.gain = std::max(worst.gain, outcome.gain);
        worst.depth = std::max(worst.depth, outcome.depth);
        worst.outside = std::max(worst.outside, outcome.outside);
        worst.contacts += outcome.contacts;
    }
    std::cout << scenes << " scenes: energy rises by at most " << worst.gain * 100
              << " %; deepest at the end " << worst.depth << " m; farthest out " << worst.outside
              << " m; " << worst.contacts / (scenes * kTicks) << " contact points a tick\n";
    EXPECT_LT(worst.gain, 0.001);
    EXPECT_LT(worst.depth, 0.75); // under a thousand times its mass
    EXPECT_LT(worst.outside, 1);
    EXPECT_GT(worst.contacts, scenes * kTicks * 10);
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         Chaos,
                         testing::Bool(),
                         [](const testing::TestParamInfo<bool>& start) {
                             return start.param ? "Overlapping" : "Apart";
                         });

} // namespace
} // namespace lockwind::test
