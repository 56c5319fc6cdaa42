#include "scene/scene.h"
#include "tests/support/code_scenes.h"

#include "lockwind/hash_tree.h"

#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

namespace lockwind::test {
namespace {

/// A run whose states never change on purpose without notice: README.md tells how to rewrite them.
struct GoldenRun {
    const char* scene;
    std::uint32_t players;
    std::vector<Tick> checkpoints;
};

// NOLINTNEXTLINE(readability-identifier-naming): the name GoogleTest looks for
void PrintTo(const GoldenRun& run, std::ostream* out) {
    *out << run.scene;
}

const std::vector<GoldenRun>& golden_runs() {
    static const std::vector<GoldenRun> runs{
        {"empty", 0, {0, 10}},
        {"swarm_small", 8, {0, 60, 600}},
        {"arena", 4, {0, 60, 300}},
        {"box_grid_1000", 0, {0, 30, 60}},
        {"pyramid_210", 0, {0, 60, 120}},
        {"spheres_1000", 0, {0, 30, 60}},
        {"heap_1000", 0, {0, 30, 60}},
        {"joints", 0, {0, 60, 300}},
        {"hulls", 4, {0, 60, 300}},
        {"bullets", 0, {0, 60, 300}},
        {"shapes", 4, {0, 60, 300}},
        {"lod", 2, {0, 60, 150, 300}},
    };
    return runs;
}

std::string goldens_path() {
    return LOCKWIND_SOURCE_DIR "/tests/determinism/goldens.txt";
}

/// One line a checkpoint.
std::string checkpoint_line(const GoldenRun& run, const World& world) {
    std::vector<std::byte> bytes;
    world.save(bytes);
    std::ostringstream line;
    line << run.scene << " players " << run.players << " tick " << world.tick() << " bytes "
         << bytes.size() << std::hex << std::setfill('0') << " state_hash " << std::setw(16)
         << world.state_hash() << " event_hash " << std::setw(16) << world.event_hash();
    return line.str();
}

std::vector<std::string> lines_of(const GoldenRun& run) {
    SceneOptions options;
    options.players = run.players;
    const Result<WorldDefinition> scene = load_scene(run.scene, options);
    if (!scene) {
        return {scene.error().message};
    }
    const WorldPtr world = make_world(scene.value());
    std::vector<std::string> lines;
    for (const Tick checkpoint : run.checkpoints) {
        while (world->tick() < checkpoint) {
            step_busy(*world);
        }
        lines.push_back(checkpoint_line(run, *world));
    }
    return lines;
}

std::vector<std::string> golden_lines(const GoldenRun& run) {
    std::ifstream file(goldens_path());
    std::vector<std::string> lines;
    std::string line;
    while (std::getline(file, line)) {
        if (line.find(std::string(run.scene) + " ") == 0) {
            lines.push_back(line);
        }
    }
    return lines;
}

bool is_rewriting() {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): the test program has one thread
    return std::getenv("LOCKWIND_REWRITE_GOLDENS") != nullptr;
}

class Goldens : public testing::TestWithParam<GoldenRun> {};

TEST_P(Goldens, StatesAreThoseOfTheFile) {
    if (is_rewriting()) {
        GTEST_SKIP() << "rewriting";
    }
    EXPECT_EQ(lines_of(GetParam()), golden_lines(GetParam()));
}

std::string run_name(const testing::TestParamInfo<GoldenRun>& run) {
    return run.param.scene;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Goldens, testing::ValuesIn(golden_runs()), run_name);

/// Fails after rewriting, so that no run passes against what it wrote itself.
TEST(GoldensFile, IsRewrittenOnlyOnPurpose) {
    if (!is_rewriting()) {
        std::ifstream file(goldens_path());
        EXPECT_TRUE(file.good()) << goldens_path();
        return;
    }
    std::ofstream file(goldens_path());
    for (const GoldenRun& run : golden_runs()) {
        for (const std::string& line : lines_of(run)) {
            file << line << "\n";
        }
    }
    FAIL() << "rewrote " << goldens_path() << ": look at the difference, then run again without "
           << "LOCKWIND_REWRITE_GOLDENS";
}

} // namespace
} // namespace lockwind::test
