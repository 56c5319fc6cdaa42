#include "scene/scene.h"

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

// The generators below are the oracle: the benchmark scenes as the peers were measured with, in the
// float arithmetic that made them.

namespace lockwind {
namespace {

struct Pose {
    float x, y, z;
    float qx = 0, qy = 0, qz = 0, qw = 1;
};

class FloatDraws {
public:
    float symmetric() {
        state_ = state_ * 1664525U + 1013904223U;
        return 2 * static_cast<float>(state_ / 4294967296.0) - 1;
    }

private:
    std::uint32_t state_ = 12345;
};

std::vector<Pose> float_grid(float pitch, float jitter) {
    std::vector<Pose> poses;
    FloatDraws draws;
    for (int index = 0; index < 1000; ++index) {
        const auto x = static_cast<float>(index % 10);
        const auto y = static_cast<float>(index / 100);
        const auto z = static_cast<float>(index / 10 % 10);
        const float jitter_x = draws.symmetric() * jitter;
        const float jitter_z = draws.symmetric() * jitter;
        poses.push_back(
            {(x - 4.5F) * pitch + jitter_x, 1.0F + y * pitch, (z - 4.5F) * pitch + jitter_z});
    }
    return poses;
}

std::vector<Pose> float_pyramid() {
    std::vector<Pose> poses;
    for (int row = 0; row < 20; ++row) {
        for (int index = 0; index < 20 - row; ++index) {
            const float middle = static_cast<float>(20 - row - 1) * 0.5F;
            poses.push_back(
                {(static_cast<float>(index) - middle) * 1.05F, 0.5F + static_cast<float>(row), 0});
        }
    }
    return poses;
}

std::vector<Pose> float_heap(int count) {
    const int side = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(count)) - 1e-9));
    const float middle = static_cast<float>(side - 1) * 0.5F;
    std::vector<Pose> poses;
    FloatDraws draws;
    for (int index = 0; index < count; ++index) {
        Pose pose{(static_cast<float>(index % side) - middle) * 1.75F,
                  1.5F + static_cast<float>(index / (side * side)) * 1.75F,
                  (static_cast<float>(index / side % side) - middle) * 1.75F};
        const float a = draws.symmetric();
        const float b = draws.symmetric();
        const float c = draws.symmetric();
        const float d = draws.symmetric();
        const float length = std::sqrt(a * a + b * b + c * c + d * d);
        pose.qx = a / length;
        pose.qy = b / length;
        pose.qz = c / length;
        pose.qw = d / length;
        poses.push_back(pose);
    }
    return poses;
}

double to_double(Real value) {
    return static_cast<double>(value.raw()) / 4294967296.0;
}

WorldDefinition load(const std::string& name, std::uint32_t players = 0) {
    SceneOptions options;
    options.players = players;
    Result<WorldDefinition> world = load_scene(name, options);
    EXPECT_TRUE(world.ok()) << name << ": " << (world.ok() ? "" : world.error().message);
    return world.ok() ? std::move(world).value() : WorldDefinition{};
}

/// The dynamic bodies stand as `poses` do, in order, with the ids behind the fixed ones'.
void expect_stands_as(const std::string& name, const std::vector<Pose>& poses) {
    const WorldDefinition world = load(name);
    ASSERT_GT(world.bodies.size(), poses.size());
    const std::size_t fixed_count = world.bodies.size() - poses.size();
    for (std::size_t index = 0; index < world.bodies.size(); ++index) {
        const BodyDefinition& body = world.bodies[index];
        ASSERT_EQ(body.id, index + 1);
        EXPECT_EQ(body.friction, Real(0.5));
        EXPECT_EQ(body.restitution, Real(0));
        if (index < fixed_count) {
            EXPECT_EQ(body.mode, BodyMode::fixed);
            continue;
        }
        const Pose& pose = poses[index - fixed_count];
        SCOPED_TRACE(name + " body " + std::to_string(body.id));
        EXPECT_EQ(body.mode, BodyMode::dynamic);
        EXPECT_EQ(body.mass, Real(1));
        EXPECT_NEAR(to_double(body.position.x), pose.x, 1e-6);
        EXPECT_NEAR(to_double(body.position.y), pose.y, 1e-6);
        EXPECT_NEAR(to_double(body.position.z), pose.z, 1e-6);
        EXPECT_NEAR(to_double(body.orientation.x), pose.qx, 1e-6);
        EXPECT_NEAR(to_double(body.orientation.y), pose.qy, 1e-6);
        EXPECT_NEAR(to_double(body.orientation.z), pose.qz, 1e-6);
        EXPECT_NEAR(to_double(body.orientation.w), pose.qw, 1e-6);
    }
}

TEST(BuiltInScenes, BenchmarkScenesStandAsMeasured) {
    expect_stands_as("box_grid_1000", float_grid(1.1F, 0));
    expect_stands_as("pyramid_210", float_pyramid());
    expect_stands_as("spheres_1000", float_grid(1.15F, 0.05F));
    expect_stands_as("heap_1000", float_heap(1000));
    expect_stands_as("heap_8000", float_heap(8000));
}

TEST(BuiltInScenes, HeapNHoldsNBoxes) {
    expect_stands_as("heap_1", float_heap(1));
    expect_stands_as("heap_100", float_heap(100));
    expect_stands_as("heap_10007", float_heap(10007));
    EXPECT_EQ(load("heap_37").name, "heap_37");
}

TEST(BuiltInScenes, HeapNRefusesWhatIsNoCount) {
    for (const char* name : {"heap_", "heap_x", "heap_0", "heap_01", "heap_-3", "heap_5x"}) {
        EXPECT_FALSE(load_scene_text(name).ok()) << name;
    }
    const Result<WorldDefinition> world = load_scene("heap_100001");
    ASSERT_FALSE(world.ok());
    EXPECT_NE(world.error().message.find("body[1].heap.count is 100001"), std::string::npos)
        << world.error().message;
}

TEST(BuiltInScenes, GroundsAreAsMeasured) {
    const WorldDefinition grid = load("box_grid_1000");
    EXPECT_EQ(grid.bodies[0].position, (Vec3{0, -1, 0}));
    EXPECT_EQ(grid.bodies[0].shape.half_extents, (Vec3{100, 1, 100}));
    EXPECT_EQ(grid.bodies[1].shape.half_extents, (Vec3{0.5, 0.5, 0.5}));

    const WorldDefinition spheres = load("spheres_1000");
    EXPECT_EQ(spheres.bodies[1].position, (Vec3{7, 15, 0}));
    EXPECT_EQ(spheres.bodies[1].shape.half_extents, (Vec3{0.5, 15, 8}));
    EXPECT_EQ(spheres.bodies[4].position, (Vec3{0, 15, -7}));
    EXPECT_EQ(spheres.bodies[4].shape.half_extents, (Vec3{8, 15, 0.5}));
    EXPECT_EQ(spheres.bodies[5].shape.type, ShapeType::sphere);
    EXPECT_EQ(spheres.bodies[5].shape.radius, Real(0.5));
}

TEST(BuiltInScenes, ArenaHasManyBodiesOfEveryShape) {
    const WorldDefinition world = load("arena", 4);
    std::size_t boxes = 0;
    std::size_t spheres = 0;
    std::size_t capsules = 0;
    for (const BodyDefinition& body : world.bodies) {
        const bool moves = body.mode == BodyMode::dynamic;
        boxes += moves && body.shape.type == ShapeType::box ? 1 : 0;
        spheres += moves && body.shape.type == ShapeType::sphere ? 1 : 0;
        capsules += moves && body.shape.type == ShapeType::capsule ? 1 : 0;
    }
    EXPECT_GE(boxes, 100U);
    EXPECT_GE(spheres, 30U);
    EXPECT_GE(capsules, 30U);
    EXPECT_GE(boxes + spheres + capsules - world.pods.size(), 200U);
}

TEST(BuiltInScenes, SwarmSmallHasTwelveBodiesAndEightSeats) {
    EXPECT_EQ(load("swarm_small").bodies.size(), 12U);
    EXPECT_EQ(load("swarm_small", 8).pods.size(), 8U);
    EXPECT_FALSE(load_scene("swarm_small", {9, 1, 0}).ok());
}

TEST(BuiltInScenes, PodsStandOnARingAndFaceItsMiddle) {
    for (std::uint32_t players = 1; players <= kScenePlayersMax; ++players) {
        const WorldDefinition world = load("arena", players);
        ASSERT_EQ(world.pods.size(), players);
        for (std::size_t slot = 0; slot < players; ++slot) {
            const BodyDefinition& body = world.bodies[world.bodies.size() - players + slot];
            ASSERT_EQ(world.pods[slot].body, body.id);
            const double angle = 6.283185307179586 * static_cast<double>(slot) / players;
            EXPECT_NEAR(to_double(body.position.x), 15 * std::sin(angle), 1e-7);
            EXPECT_NEAR(to_double(body.position.z), 15 * std::cos(angle), 1e-7);
            // A turn about y takes +z to (sin a, 0, cos a), with sin(a / 2) = y and cos(a / 2) = w.
            const double y = to_double(body.orientation.y);
            const double w = to_double(body.orientation.w);
            EXPECT_NEAR(2 * y * w, -std::sin(angle), 1e-7);
            EXPECT_NEAR(w * w - y * y, -std::cos(angle), 1e-7);
        }
    }
}

TEST(BuiltInScenes, AddingPlayersChangesNoOtherBody) {
    const WorldDefinition none = load("arena", 0);
    const WorldDefinition many = load("arena", 16);
    ASSERT_EQ(many.bodies.size(), none.bodies.size() + 16);
    for (std::size_t index = 0; index < none.bodies.size(); ++index) {
        EXPECT_EQ(none.bodies[index].id, many.bodies[index].id);
        EXPECT_EQ(none.bodies[index].position, many.bodies[index].position);
        EXPECT_EQ(none.bodies[index].orientation, many.bodies[index].orientation);
    }
}

TEST(BuiltInScenes, EveryOneParsesUnderItsOwnName) {
    EXPECT_GE(built_in_scenes().size(), 8U);
    for (const BuiltInScene& scene : built_in_scenes()) {
        EXPECT_EQ(load(std::string(scene.name), kEverySeat).name, scene.name);
    }
}

} // namespace
} // namespace lockwind
