#include "scene/scene.h"
#include "tests/support/code_scenes.h"

#include <gtest/gtest.h>
#include <string>

namespace lockwind::test {
namespace {

struct Run {
    const char* scene;
    std::uint32_t players;
    int ticks;
};

// NOLINTNEXTLINE(readability-identifier-naming): the name GoogleTest looks for
void PrintTo(const Run& run, std::ostream* out) {
    *out << run.scene;
}

std::string run_name(const testing::TestParamInfo<Run>& run) {
    return run.param.scene;
}

WorldPtr world_of(const Run& run) {
    SceneOptions options;
    options.players = run.players;
    const Result<WorldDefinition> scene = load_scene(run.scene, options);
    EXPECT_TRUE(scene.ok()) << scene.error().message;
    return make_world(scene.value());
}

class LongRun : public testing::TestWithParam<Run> {};

/// What a step leaves, a peer that joins accepts.
TEST_P(LongRun, LeavesStatesThatCanBeLoaded) {
    const WorldPtr world = world_of(GetParam());
    for (int tick = 0; tick < GetParam().ticks; ++tick) {
        step_busy(*world);
        if (tick % 10 == 0) {
            const Status status = world->check();
            ASSERT_TRUE(status.ok()) << "tick " << world->tick() << ": " << status.error().message;
        }
    }
    EXPECT_EQ(world->tick(), static_cast<Tick>(GetParam().ticks));
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         LongRun,
                         testing::Values(Run{"arena", 4, 900},
                                         Run{"swarm_small", 8, 1800},
                                         Run{"pyramid_210", 0, 120},
                                         Run{"heap_1000", 0, 90},
                                         Run{"spheres_1000", 0, 90}),
                         run_name);

TEST(Arena, IsAsBusyAsAMatchNeeds) {
    const WorldPtr world = world_of({"arena", 4, 0});
    std::uint64_t contacts = 0;
    for (int tick = 0; tick < 600; ++tick) {
        step_busy(*world);
        contacts += world->counts().contacts;
    }
    EXPECT_GE(contacts / 600, 400U) << "contact points a tick";
    EXPECT_GE(world->counts().created_total, 100U);
    EXPECT_GE(world->counts().destroyed_total, 50U);
    EXPECT_GT(world->score(0) + world->score(1) + world->score(2) + world->score(3), 0U);
    for (Slot slot = 0; slot < 4; ++slot) {
        ASSERT_TRUE(world->pod(slot).has_value());
        const Vec3 up = rotate(world->pod(slot)->orientation, Vec3{0, 1, 0});
        EXPECT_GT(to_double(up.y), 0.5) << "pod " << slot << " lies on its side";
    }
}

} // namespace
} // namespace lockwind::test
