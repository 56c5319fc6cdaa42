#include "base/arena.h"
#include "base/state_schema.h"
#include "tests/support/code_scenes.h"
#include "world/state.h"

#include "lockwind/world_simulation.h"

#include <cstring>
#include <gtest/gtest.h>
#include <set>
#include <string>

namespace lockwind::test {
namespace {

TEST(StateLayout, ClaimsEveryByteOfEveryRowOnce) {
    const Status status = check_schema(World::schema());
    EXPECT_TRUE(status.ok()) << (status ? "" : status.error().message);
}

TEST(StateLayout, SectionsAreThoseThatTheirNumbersName) {
    const std::pair<std::uint32_t, std::string_view> names[] = {
        {section::kArena, "arena"},
        {section::kGlobals, "globals"},
        {section::kBody, "body"},
        {section::kBodyKind, "body_kind"},
        {section::kBodyLife, "body_life"},
        {section::kBodySleep, "body_sleep"},
        {section::kManifold, "manifold"},
        {section::kContactImpulse, "contact_impulse"},
        {section::kJoint, "joint"},
        {section::kPlayer, "player"},
        {section::kPair, "pair"},
    };
    ASSERT_EQ(World::schema().size(), std::size(names));
    for (const auto& [number, name] : names) {
        EXPECT_EQ(World::schema()[number].name, name);
    }
}

TEST(StateLayout, ABusyWorldHasRowsInEverySection) {
    WorldDefinition definition = busy_scene(20, 2);
    add_joints(definition, 1000, {0, 30, 0});
    const WorldPtr world = make_world(definition);
    for (int tick = 0; tick < 60; ++tick) {
        step_busy(*world);
    }
    for (std::uint32_t section = 0; section < World::schema().size(); ++section) {
        EXPECT_GT(world->row_count(section), 0U) << World::schema()[section].name;
        EXPECT_EQ(world->section_bytes(section).size(),
                  std::size_t{world->row_count(section)} * World::schema()[section].stride_bytes);
    }
}

TEST(StateLayout, SnapshotHoldsTheLiveRowsAndNothingElse) {
    const WorldPtr world = make_world(busy_scene(20, 2));
    step_busy(*world);
    std::size_t size = 0;
    for (std::uint32_t section = 0; section < section::kStateCount; ++section) {
        size += world->section_bytes(section).size();
    }
    std::vector<std::byte> bytes;
    world->save(bytes);
    EXPECT_EQ(bytes.size(), size);
}

} // namespace
} // namespace lockwind::test
