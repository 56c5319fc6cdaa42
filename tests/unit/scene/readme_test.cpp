#include "scene/scene.h"

#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

namespace lockwind {
namespace {

std::string readme() {
    std::ifstream file(LOCKWIND_SOURCE_DIR "/sim-core/scenes/README.md");
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

std::vector<std::string> examples() {
    const std::string text = readme();
    const std::string fence = "```textproto\n";
    std::vector<std::string> blocks;
    std::size_t at = text.find(fence);
    while (at != std::string::npos) {
        const std::size_t begin = at + fence.size();
        const std::size_t end = text.find("```", begin);
        blocks.push_back(text.substr(begin, end - begin));
        at = text.find(fence, end);
    }
    return blocks;
}

TEST(SceneReadme, ExamplesParse) {
    const std::vector<std::string> blocks = examples();
    ASSERT_FALSE(blocks.empty());
    for (const std::string& block : blocks) {
        const Result<WorldDefinition> world = parse_scene(block, "README.md", {4, 1, 0});
        ASSERT_TRUE(world.ok()) << world.error().message;
        EXPECT_EQ(world.value().bodies.size(), 3U + 15U + 4U);
        EXPECT_EQ(world.value().pods[0].thrust_acceleration, Real(30));
    }
}

TEST(SceneReadme, TellsTheBodyCountsOfBuiltInScenes) {
    const std::string text = readme();
    for (const char* row :
         {"arena", "swarm_small", "empty", "pyramid_210", "hulls", "bullets", "shapes", "lod"}) {
        const Result<WorldDefinition> world = load_scene(row);
        ASSERT_TRUE(world.ok());
        const std::string line =
            "| `" + std::string(row) + "` | " + std::to_string(world.value().bodies.size()) + " |";
        EXPECT_NE(text.find(line), std::string::npos) << line;
    }
}

} // namespace
} // namespace lockwind
