#include "scene/scene.h"

#include "lockwind/world.h"

#include <gtest/gtest.h>
#include <string>

namespace lockwind {
namespace {

WorldDefinition parse(const std::string& text) {
    Result<WorldDefinition> world = parse_scene(text, "t.textproto");
    EXPECT_TRUE(world.ok()) << (world.ok() ? "" : world.error().message);
    return world.ok() ? std::move(world).value() : WorldDefinition{};
}

std::string error_of(const std::string& shapes) {
    const Result<WorldDefinition> world =
        parse_scene("name: \"t\"\n" + shapes + "\n", "t.textproto");
    return world.ok() ? "(no error)" : world.error().message;
}

TEST(SceneShapes, ReadsCompoundsFieldsAndMeshes) {
    const WorldDefinition world = parse(
        "name: \"t\" "
        "body { mode: fixed mesh: \"m\" } body { mode: fixed height_field: \"f\" } "
        "body { compound: \"c\" position { y: 3 } } "
        "compound { name: \"c\" child { sphere { radius: 0.25 } position { x: 1 } density: 2 } "
        "child { box { half_extents { x: 1 y: 0.5 z: 0.25 } } rotation { axis { y: 1 } degrees: 90 "
        "} } } "
        "height_field { name: \"f\" columns: 3 rows: 2 spacing_x: 0.5 spacing_z: 2 "
        "height: [0, 1, 0.25, -1, 2, 0] hole: 1 } "
        "mesh { name: \"m\" vertex { x: 1 } vertex { y: 0.5 } vertex { z: 1 } index: [0, 1, 2] }");
    ASSERT_EQ(world.compounds.size(), 1U);
    ASSERT_EQ(world.compounds[0].children.size(), 2U);
    EXPECT_EQ(world.compounds[0].children[0].shape.radius, Real(0.25));
    EXPECT_EQ(world.compounds[0].children[0].position, (Vec3{1, 0, 0}));
    EXPECT_EQ(world.compounds[0].children[0].density, Real(2));
    EXPECT_EQ(world.compounds[0].children[1].shape.half_extents, (Vec3{1, 0.5, 0.25}));
    EXPECT_GT(world.compounds[0].children[1].orientation.y, Real(0.7));
    ASSERT_EQ(world.height_fields.size(), 1U);
    EXPECT_EQ(world.height_fields[0].columns, 3U);
    EXPECT_EQ(world.height_fields[0].spacing_z, Real(2));
    EXPECT_EQ(world.height_fields[0].heights, (std::vector<Real>{0, 1, Real(0.25), -1, 2, 0}));
    EXPECT_EQ(world.height_fields[0].holes, std::vector<std::uint32_t>{1});
    ASSERT_EQ(world.meshes.size(), 1U);
    EXPECT_EQ(world.meshes[0].vertices[1], (Vec3{0, 0.5, 0}));
    EXPECT_EQ(world.meshes[0].indices, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(world.bodies[0].shape.type, ShapeType::mesh);
    EXPECT_EQ(world.bodies[1].shape.type, ShapeType::height_field);
    EXPECT_EQ(world.bodies[2].shape.type, ShapeType::compound);
    EXPECT_TRUE(World::create(world).ok());
}

TEST(SceneShapes, ErrorsTellThePlace) {
    EXPECT_EQ(error_of("compound { child { sphere { radius: 1 } } }"),
              "t.textproto:2:1: compound[0].name is missing; bodies name their compound");
    EXPECT_EQ(error_of("compound { name: \"c\" }"),
              "t.textproto:2:1: compound[0] \"c\" has 0 children; give 1 .. 32");
    EXPECT_EQ(error_of("compound { name: \"c\"\n  child { position { x: 1 } } }"),
              "t.textproto:3:3: compound[0].child[0] has no shape; give sphere, capsule, box or "
              "hull");
    EXPECT_EQ(error_of("compound { name: \"c\"\n  child { hull: \"h\" } }"),
              "t.textproto:3:11: compound[0].child[0].hull \"h\" is not defined; the scene has no "
              "hulls");
    EXPECT_EQ(error_of("height_field { name: \"f\" columns: 2 rows: 2 spacing_x: 1 spacing_z: 1 "
                       "height: [0, 0, 0] }"),
              "t.textproto:2:1: height_field[0] \"f\" has 3 heights; its columns and rows are 4 "
              "samples");
    EXPECT_EQ(error_of("height_field { name: \"f\" columns: 2 rows: 2 spacing_x: 1 spacing_z: 1 "
                       "height: [0, 0, 501, 0] }"),
              "t.textproto:2:1: height_field[0].height [2] is 501 m; give -500 .. 500 m");
    EXPECT_EQ(error_of("mesh { name: \"m\" vertex { x: 1 } index: [0, 1, 0] }"),
              "t.textproto:2:1: mesh[0] \"m\" has index 1 in triangle 0; there are 1 vertices");
    EXPECT_EQ(
        error_of("mesh { name: \"m\" vertex {} vertex { x: 1 } vertex { z: -1 } index: [0, 1, "
                 "2] }\nbody { mesh: \"m\" }"),
        "t.textproto:3:8: body[0].mesh has no inside and cannot move; add `mode: fixed`");
    EXPECT_EQ(error_of("body { mesh: \"m\" mode: fixed }"),
              "t.textproto:2:8: body[0].mesh \"m\" is not defined; the scene has no meshes");
}

} // namespace
} // namespace lockwind
