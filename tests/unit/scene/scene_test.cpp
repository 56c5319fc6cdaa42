#include "scene/scene.h"

#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

namespace lockwind {
namespace {

const std::string kFloor = "name: \"t\"\nbody { mode: fixed plane {} }\n";

WorldDefinition parse(const std::string& text, const SceneOptions& options = {}) {
    Result<WorldDefinition> world = parse_scene(text, "t.textproto", options);
    EXPECT_TRUE(world.ok()) << (world.ok() ? "" : world.error().message);
    return world.ok() ? std::move(world).value() : WorldDefinition{};
}

std::string error_of(const std::string& text, const SceneOptions& options = {}) {
    const Result<WorldDefinition> world = parse_scene(text, "t.textproto", options);
    return world.ok() ? "(no error)" : world.error().message;
}

/// The one body of a scene whose line 2 is `body`.
std::string body_error(const std::string& body) {
    return error_of("name: \"t\"\n" + body + "\n");
}

TEST(Scene, ReadsSettingsAndKeepsDefaults) {
    const WorldDefinition plain = parse("name: \"plain\"");
    EXPECT_EQ(plain.name, "plain");
    EXPECT_EQ(plain.settings.tick_rate_hz, 60U);
    EXPECT_EQ(plain.settings.substeps, 4U);
    EXPECT_EQ(plain.settings.gravity, (Vec3{0, -9.81, 0}));
    EXPECT_EQ(plain.settings.bounds, Real(1000));

    const WorldDefinition moon =
        parse("name: \"moon\" settings { tick_rate_hz: 120 substeps: 8 gravity { y: -1.62 } "
              "linear_speed_max: 50 angular_speed_max: 20 bounds: 64.5 body_capacity: 5 "
              "pair_capacity: 6 manifold_capacity: 7 }");
    EXPECT_EQ(moon.settings.tick_rate_hz, 120U);
    EXPECT_EQ(moon.settings.substeps, 8U);
    EXPECT_EQ(moon.settings.gravity, (Vec3{0, -1.62, 0}));
    EXPECT_EQ(moon.settings.linear_speed_max, Real(50));
    EXPECT_EQ(moon.settings.angular_speed_max, Real(20));
    EXPECT_EQ(moon.settings.bounds, Real(64.5));
    EXPECT_EQ(moon.settings.body_capacity, 5U);
    EXPECT_EQ(moon.settings.pair_capacity, 6U);
    EXPECT_EQ(moon.settings.manifold_capacity, 7U);
}

TEST(Scene, TakesSeedAndTickRateFromTheMatch) {
    SceneOptions options;
    options.seed = 77;
    options.tick_rate_hz = 30;
    const WorldDefinition world = parse("name: \"t\" settings { tick_rate_hz: 120 }", options);
    EXPECT_EQ(world.settings.seed, 77U);
    EXPECT_EQ(world.settings.tick_rate_hz, 30U);
}

TEST(Scene, ReadsEveryFieldOfABody) {
    const WorldDefinition world =
        parse("name: \"t\" body { mode: kinematic position { x: 1 y: 2.5 z: -3 } "
              "orientation { y: 0.5 w: 0.5 } linear_velocity { x: 4 } angular_velocity { z: 5 } "
              "capsule { radius: 0.25 half_height: 0.75 } mass: 8 friction: 0.9 "
              "restitution: 0.25 }");
    ASSERT_EQ(world.bodies.size(), 1U);
    const BodyDefinition& body = world.bodies[0];
    EXPECT_EQ(body.id, 1U);
    EXPECT_EQ(body.mode, BodyMode::kinematic);
    EXPECT_EQ(body.position, (Vec3{1, 2.5, -3}));
    EXPECT_EQ(body.linear_velocity, (Vec3{4, 0, 0}));
    EXPECT_EQ(body.angular_velocity, (Vec3{0, 0, 5}));
    EXPECT_EQ(body.shape.type, ShapeType::capsule);
    EXPECT_EQ(body.shape.radius, Real(0.25));
    EXPECT_EQ(body.shape.half_height, Real(0.75));
    EXPECT_EQ(body.mass, Real(8));
    EXPECT_EQ(body.friction, Real(0.9));
    EXPECT_EQ(body.restitution, Real(0.25));
    const double half = 0.70710678118654752;
    EXPECT_NEAR(static_cast<double>(body.orientation.y.raw()), half * 4294967296.0, 2);
    EXPECT_NEAR(static_cast<double>(body.orientation.w.raw()), half * 4294967296.0, 2);
}

TEST(Scene, TurnsRightHandedAboutAnAxisOfAnyLength) {
    const WorldDefinition world =
        parse("name: \"t\" body { rotation { axis { z: 0.1 } degrees: 90 } sphere { radius: 1 } }");
    const RealQuat& turn = world.bodies.at(0).orientation;
    EXPECT_NEAR(static_cast<double>(turn.z.raw()), 0.70710678118654752 * 4294967296.0, 4);
    EXPECT_NEAR(static_cast<double>(turn.w.raw()), 0.70710678118654752 * 4294967296.0, 4);
    EXPECT_EQ(turn.x, Real(0));
}

TEST(Scene, CombineRulesComeFromMaterialsAndBodies) {
    const WorldDefinition scene =
        parse("name: \"t\" material { name: \"ice\" friction_rule: minimum } "
              "body { sphere { radius: 1 } } "
              "body { material: \"ice\" restitution_rule: average sphere { radius: 1 } } "
              "body { material: \"ice\" friction_rule: multiply sphere { radius: 1 } }");
    EXPECT_EQ(scene.bodies[0].friction_rule, CombineRule::geometric_mean);
    EXPECT_EQ(scene.bodies[0].restitution_rule, CombineRule::maximum);
    EXPECT_EQ(scene.bodies[1].friction_rule, CombineRule::minimum);
    EXPECT_EQ(scene.bodies[1].restitution_rule, CombineRule::average);
    EXPECT_EQ(scene.bodies[2].friction_rule, CombineRule::multiply);
}

TEST(Scene, CollisionModesAreRead) {
    const WorldDefinition scene =
        parse("name: \"t\" body { sphere { radius: 1 } } "
              "body { collision_mode: swept sphere { radius: 1 } } "
              "body { collision_mode: continuous sphere { radius: 1 } } "
              "body { collision_mode: speculative sphere { radius: 1 } }");
    EXPECT_EQ(scene.bodies[0].collision_mode, CollisionMode::discrete);
    EXPECT_EQ(scene.bodies[1].collision_mode, CollisionMode::swept);
    EXPECT_EQ(scene.bodies[2].collision_mode, CollisionMode::continuous);
    EXPECT_EQ(scene.bodies[3].collision_mode, CollisionMode::speculative);
    EXPECT_EQ(body_error("body { collision_mode: fast sphere { radius: 1 } }"),
              "t.textproto:2:24: collision_mode cannot be \"fast\"; it is one of: discrete, swept, "
              "continuous, speculative");
}

TEST(Scene, SubstepsOfABodyAreRead) {
    const WorldDefinition scene = parse(
        "name: \"t\" body { sphere { radius: 1 } } body { substeps: 16 sphere { radius: 1 } }");
    EXPECT_EQ(scene.bodies[0].substeps, 0U);
    EXPECT_EQ(scene.bodies[1].substeps, 16U);
    EXPECT_NE(body_error("body { substeps: 17 sphere { radius: 1 } }").find("body[0].substeps"),
              std::string::npos);
}

TEST(Scene, SettingsOfSleepAndBoundsAreRead) {
    const WorldDefinition scene =
        parse("name: \"t\" settings { sleep_speed: 0.25 sleep_seconds: 2 bounds_policy: wrap }");
    EXPECT_EQ(scene.settings.sleep_speed, Real(0.25));
    EXPECT_EQ(scene.settings.sleep_seconds, Real(2));
    EXPECT_EQ(scene.settings.bounds_policy, BoundsPolicy::wrap);
    EXPECT_EQ(parse("name: \"t\"").settings.bounds_policy, BoundsPolicy::destroy);
    EXPECT_NE(error_of("name: \"t\"\nsettings { sleep_seconds: -1 }").find("t.textproto:2:"),
              std::string::npos);
}

TEST(Scene, LevelOfDetailIsReadWhereItIsGiven) {
    EXPECT_FALSE(parse("name: \"t\" settings {}").settings.level_of_detail.enabled);
    const LevelOfDetail usual =
        parse("name: \"t\" settings { level_of_detail {} }").settings.level_of_detail;
    EXPECT_TRUE(usual.enabled);
    EXPECT_EQ(usual.full_within, Real(50));
    EXPECT_EQ(usual.simplified_within, Real(200));
    EXPECT_EQ(usual.simplified_substeps, 2U);
    const LevelOfDetail own = parse("name: \"t\" settings { level_of_detail { full_within: 12.5 "
                                    "simplified_within: 30 simplified_substeps: 1 } }")
                                  .settings.level_of_detail;
    EXPECT_EQ(own.full_within, Real(12.5));
    EXPECT_EQ(own.simplified_within, Real(30));
    EXPECT_EQ(own.simplified_substeps, 1U);
}

TEST(Scene, LevelOfDetailOutOfRangeIsAnErrorAtItsPlace) {
    const auto error_in = [](const std::string& fields) {
        return error_of("name: \"t\"\nsettings {\n  level_of_detail { " + fields + " }\n}");
    };
    const std::string path = "settings.level_of_detail.";
    EXPECT_NE(error_in("full_within: 0.5").find("t.textproto:3:"), std::string::npos);
    EXPECT_NE(error_in("full_within: 0.5").find(path + "full_within"), std::string::npos);
    EXPECT_NE(error_in("full_within: 201").find(path + "full_within is above"), std::string::npos);
    EXPECT_NE(error_in("full_within: 9 simplified_within: 8")
                  .find(path + "simplified_within is below full_within"),
              std::string::npos);
    EXPECT_NE(error_in("simplified_substeps: 17").find(path + "simplified_substeps"),
              std::string::npos);
}

TEST(Scene, LayersBecomeNumbersAndMasks) {
    const WorldDefinition scene =
        parse("name: \"t\" layer { name: \"debris\" ignores: \"debris\" ignores: \"player\" } "
              "layer { name: \"player\" } "
              "body { sphere { radius: 1 } } "
              "body { layer: \"debris\" sphere { radius: 1 } } "
              "body { layer: \"player\" ignores: \"default\" sensor: true sphere { radius: 1 } }");
    EXPECT_EQ(scene.settings.layer_masks[0], kAllLayers);
    EXPECT_EQ(scene.settings.layer_masks[1], kAllLayers & ~0b110U);
    EXPECT_EQ(scene.settings.layer_masks[2], kAllLayers);
    EXPECT_EQ(scene.bodies[0].layer, 0U);
    EXPECT_EQ(scene.bodies[1].layer, 1U);
    EXPECT_EQ(scene.bodies[2].layer, 2U);
    EXPECT_EQ(scene.bodies[2].mask, kAllLayers & ~1U);
    EXPECT_TRUE(scene.bodies[2].sensor);
    EXPECT_FALSE(scene.bodies[1].sensor);
}

TEST(Scene, WrongLayersAreNamed) {
    EXPECT_EQ(body_error("body { layer: \"x\" sphere { radius: 1 } }"),
              "t.textproto:2:8: body[0].layer \"x\" is no layer of the scene; there is: default");
    EXPECT_EQ(error_of("name: \"t\" layer { name: \"a\" }\nlayer { name: \"a\" }"),
              "t.textproto:2:9: layer[1].name \"a\" is a layer already; \"default\" comes first");
    EXPECT_EQ(error_of("name: \"t\" layer { name: \"a\"\nignores: \"b\" }"),
              "t.textproto:1:11: layer[0].ignores \"b\" is no layer of the scene; there is: "
              "default, a");
    std::string many = "name: \"t\"";
    for (int index = 0; index < 32; ++index) {
        many += " layer { name: \"l" + std::to_string(index) + "\" }";
    }
    EXPECT_NE(error_of(many).find("there are more than 31 layers"), std::string::npos);
}

TEST(Scene, MaterialsGiveDefaultsThatABodyOverrides) {
    const WorldDefinition world =
        parse("name: \"t\" material { name: \"ice\" density: 917 friction: 0.02 restitution: 0.1 } "
              "body { material: \"ice\" sphere { radius: 1 } } "
              "body { material: \"ice\" friction: 0.3 sphere { radius: 1 } }");
    EXPECT_EQ(world.bodies.at(0).density, Real(917));
    EXPECT_EQ(world.bodies.at(0).friction, Real(0.02));
    EXPECT_EQ(world.bodies.at(0).restitution, Real(0.1));
    EXPECT_EQ(world.bodies.at(1).density, Real(917));
    EXPECT_EQ(world.bodies.at(1).friction, Real(0.3));
}

const std::string kGem = "hull { name: \"gem\" point { x: 1 } point { x: -1 } point { y: 1 } "
                         "point { y: -1 } point { z: 1 } point { z: -1 } }\n";

TEST(Scene, BodiesShareHullsByName) {
    const WorldDefinition world =
        parse("name: \"t\" body { hull: \"gem\" } body { hull: \"rod\" mass: 2 } "
              "body { hull: \"gem\" position { x: 5 } } " +
              kGem +
              "hull { name: \"rod\" point { x: 0.5 y: 0.25 } point { x: -0.5 } point { y: -0.5 } "
              "point { z: 0.5 } point { z: -0.125 } }");
    ASSERT_EQ(world.hulls.size(), 2U);
    EXPECT_EQ(world.hulls[0].points.size(), 6U);
    ASSERT_EQ(world.hulls[1].points.size(), 5U);
    EXPECT_EQ(world.hulls[1].points[0], (Vec3{0.5, 0.25, 0}));
    EXPECT_EQ(world.hulls[1].points[4], (Vec3{0, 0, -0.125}));
    ASSERT_EQ(world.bodies.size(), 3U);
    for (const BodyDefinition& body : world.bodies) {
        EXPECT_EQ(body.shape.type, ShapeType::hull);
    }
    EXPECT_EQ(world.bodies[0].shape.hull, 0U);
    EXPECT_EQ(world.bodies[1].shape.hull, 1U);
    EXPECT_EQ(world.bodies[2].shape.hull, 0U);
}

TEST(SceneErrors, NamePlaceAndFaultOfHulls) {
    const auto hull_error = [](const std::string& hull) {
        return error_of("name: \"t\"\n" + hull + "\n");
    };
    EXPECT_EQ(hull_error("hull { point { x: 1 } }"),
              "t.textproto:2:1: hull[0].name is missing; bodies name their hull");
    EXPECT_EQ(hull_error(kGem + kGem),
              "t.textproto:3:8: hull[1].name \"gem\" is the name of two hulls");
    EXPECT_EQ(hull_error("hull { name: \"a\"\n  point { x: 1 }\n  point { y: 300 } }"),
              "t.textproto:4:11: hull[0].point[1].y is 300 m; give -250 .. 250 m");
    EXPECT_EQ(
        hull_error("hull { name: \"a\" point { x: 1 } point { y: 1 } point { z: 1 } }"),
        "t.textproto:2:1: hull[0] \"a\" has 3 different points; give at least 4 that stand out "
        "of one plane");
    EXPECT_EQ(hull_error("hull { name: \"a\" point { x: 1 } point { y: 1 } point { z: 0 } "
                         "point { x: 1 y: 1 } }"),
              "t.textproto:2:1: hull[0] \"a\" is flat: its points need to stand out of one plane");
    EXPECT_EQ(hull_error(kGem + "body { hull: \"gen\" }"),
              "t.textproto:3:8: body[0].hull \"gen\" is not defined; there is: gem");
    EXPECT_EQ(hull_error("body { hull: \"gen\" }"),
              "t.textproto:2:8: body[0].hull \"gen\" is not defined; the scene has no hulls");
    EXPECT_EQ(hull_error(kGem + "body { hull: \"gem\" density: 0.01 mode: dynamic }"),
              "(no error)");
    EXPECT_EQ(
        hull_error("hull { name: \"a\" point { x: 0.02 } point { x: -0.02 } point { y: 0.02 } "
                   "point { y: -0.02 } point { z: 0.02 } point { z: -0.02 } }\n"
                   "body { hull: \"a\" density: 1 }"),
        "t.textproto:3:18: body[0].density makes the body weigh 1.07e-05 kg; a dynamic body "
        "weighs 0.001 .. 1000000 kg");
}

TEST(Scene, NumbersBodiesInTheOrderOfTheText) {
    const WorldDefinition world =
        parse(kFloor + "body { sphere { radius: 1 } position { y: 1 } "
                       "grid { count { x: 2 y: 1 z: 1 } pitch { x: 3 y: 1 z: 1 } } }\n"
                       "body { sphere { radius: 2 } position { y: 9 } }\n"
                       "pods { players_max: 2 ring_radius: 9 body { sphere { radius: 0.5 } } }",
              {2, 1, 0});
    ASSERT_EQ(world.bodies.size(), 6U);
    for (std::size_t index = 0; index < world.bodies.size(); ++index) {
        EXPECT_EQ(world.bodies[index].id, index + 1);
    }
    EXPECT_EQ(world.bodies[1].position, (Vec3{-1.5, 1, 0}));
    EXPECT_EQ(world.bodies[2].position, (Vec3{1.5, 1, 0}));
    EXPECT_EQ(world.bodies[3].shape.radius, Real(2));
    EXPECT_EQ(world.pods[0].body, 5U);
    EXPECT_EQ(world.pods[1].body, 6U);
}

TEST(Scene, ReadsEveryFieldOfAPod) {
    const WorldDefinition world =
        parse("name: \"t\" pods { players_max: 1 ring_radius: 2 body { sphere { radius: 0.5 } } "
              "thrust_acceleration: 1 speed_max: 2 turn_rate: 3 jump_speed: 4 ball_radius: 0.5 "
              "ball_density: 6 ball_speed: 7 ball_cooldown_ticks: 8 ball_lifetime_ticks: 9 }",
              {1, 1, 0});
    ASSERT_EQ(world.pods.size(), 1U);
    const PodDefinition& pod = world.pods[0];
    EXPECT_EQ(pod.thrust_acceleration, Real(1));
    EXPECT_EQ(pod.speed_max, Real(2));
    EXPECT_EQ(pod.turn_rate, Real(3));
    EXPECT_EQ(pod.jump_speed, Real(4));
    EXPECT_EQ(pod.ball_radius, Real(0.5));
    EXPECT_EQ(pod.ball_density, Real(6));
    EXPECT_EQ(pod.ball_speed, Real(7));
    EXPECT_EQ(pod.ball_cooldown_ticks, 8U);
    EXPECT_EQ(pod.ball_lifetime_ticks, 9U);
}

TEST(SceneErrors, NameThePlaceOfBrokenText) {
    EXPECT_EQ(error_of("name: \"t\"\nbody { sphere {\n  colour\n\n: 3\n} }\n"),
              "t.textproto:3:3: Sphere has no field \"colour\"; it has: radius");
    EXPECT_EQ(
        error_of("name: \"t\"\nbody {\n  mode: wooden\n  sphere { radius: 1 }\n}\n"),
        "t.textproto:3:9: mode cannot be \"wooden\"; it is one of: dynamic, fixed, kinematic");
    EXPECT_EQ(error_of("name: \"t\"\nbody { sphere { radius: big } }\n"),
              "t.textproto:2:25: Expected double, got: big");
    EXPECT_EQ(error_of("name: \"t\"\nbody { sphere { radius: 1 } box {} }\n"),
              "t.textproto:2:33: Field \"box\" is specified along with field \"sphere\", another "
              "member of oneof \"shape\".");
    EXPECT_EQ(error_of("name: \"t\"\nname: \"u\"\n"),
              "t.textproto:2:5: Non-repeated field \"name\" is specified multiple times.");
    EXPECT_EQ(error_of("body {\n"), "t.textproto:2:1: Expected identifier, got: ");
}

TEST(SceneErrors, NameFieldAndPlaceOfBadNumbers) {
    EXPECT_EQ(body_error("body {\n  sphere {\n    radius: 0\n  }\n}"),
              "t.textproto:4:5: body[0].sphere.radius is 0 m; give 0.01 .. 250 m");
    EXPECT_EQ(body_error("body { sphere { radius: 1 } mass: 0 }"),
              "t.textproto:2:29: body[0].mass is 0 kg; give 0.001 .. 1000000 kg");
    EXPECT_EQ(body_error("body { sphere { radius: 1 } mass: 1e12 }"),
              "t.textproto:2:29: body[0].mass is 1e+12 kg; give 0.001 .. 1000000 kg");
    EXPECT_EQ(body_error("body { sphere { radius: 1 } mass: -5 }"),
              "t.textproto:2:29: body[0].mass is -5 kg; give 0.001 .. 1000000 kg");
    EXPECT_EQ(body_error("body { sphere { radius: nan } }"),
              "t.textproto:2:17: body[0].sphere.radius is nan m; give 0.01 .. 250 m");
    EXPECT_EQ(body_error("body { position { x: inf } sphere { radius: 1 } }"),
              "t.textproto:2:19: body[0].position.x is inf m; give -1000 .. 1000 m");
    EXPECT_EQ(body_error("body { box { half_extents { x: 1 y: 1 } } }"),
              "t.textproto:2:14: body[0].box.half_extents.z is 0 m; give 0.01 .. 250 m");
    EXPECT_EQ(body_error("body { capsule { radius: 300 half_height: 1 } }"),
              "t.textproto:2:18: body[0].capsule.radius is 300 m; give 0.01 .. 250 m");
    EXPECT_EQ(body_error("body { sphere { radius: 1 } restitution: 1.5 }"),
              "t.textproto:2:29: body[0].restitution is 1.5; give 0 .. 1");
    EXPECT_EQ(body_error("body { sphere { radius: 1 } friction: -1 }"),
              "t.textproto:2:29: body[0].friction is -1; give 0 .. 4");
    EXPECT_EQ(body_error("body { linear_velocity { y: 401 } sphere { radius: 1 } }"),
              "t.textproto:2:26: body[0].linear_velocity.y is 401 m/s; give -400 .. 400 m/s");
}

TEST(SceneErrors, NameFieldAndPlaceInSettings) {
    EXPECT_EQ(error_of("name: \"t\"\nsettings {\n  tick_rate_hz: 9\n}"),
              "t.textproto:3:3: settings.tick_rate_hz is 9 Hz; give 10 .. 240 Hz");
    EXPECT_EQ(error_of("name: \"t\"\nsettings { substeps: 0 }"),
              "t.textproto:2:12: settings.substeps is 0; give 1 .. 16");
    EXPECT_EQ(error_of("name: \"t\"\nsettings { gravity { y: -5000 } }"),
              "t.textproto:2:22: settings.gravity.y is -5000 m/s^2; give -100 .. 100 m/s^2");
    EXPECT_EQ(error_of("name: \"t\"\nsettings { bounds: 0 }"),
              "t.textproto:2:12: settings.bounds is 0 m; give 1 .. 16000 m");
}

TEST(SceneErrors, RefuseBodiesThatCannotBe) {
    EXPECT_EQ(
        body_error("body { mass: 1 }"),
        "t.textproto:2:1: body[0] has no shape; give sphere, capsule, box, hull, compound, plane, "
        "height_field or mesh");
    EXPECT_EQ(body_error("body { box {} }"), "t.textproto:2:8: body[0].box has no half_extents");
    EXPECT_EQ(body_error("body { plane {} }"),
              "t.textproto:2:8: body[0].plane has no end and cannot move; add `mode: fixed`");
    EXPECT_EQ(body_error("body { sphere { radius: 1 } mass: 1 density: 1 }"),
              "t.textproto:2:29: body[0].mass and density are both given; give one");
    EXPECT_EQ(body_error("body { orientation {} sphere { radius: 1 } }"),
              "t.textproto:2:8: body[0].orientation is 0; give a quaternion, w: 1 for none");
    EXPECT_EQ(body_error("body { rotation { degrees: 5 } sphere { radius: 1 } }"),
              "t.textproto:2:8: body[0].rotation.axis is 0; give a direction, such as { y: 1 }");
    EXPECT_EQ(body_error("body { mode: fixed linear_velocity { x: 1 } sphere { radius: 1 } }"),
              "t.textproto:2:8: body[0].mode is fixed, but the body has a velocity; make it "
              "kinematic or dynamic");
    EXPECT_EQ(body_error("body { material: \"x\" sphere { radius: 1 } }"),
              "t.textproto:2:8: body[0].material \"x\" is not defined; the scene has no materials");
    EXPECT_EQ(error_of("name: \"t\" material { name: \"oak\" } material { name: \"ice\" }\n"
                       "body { material: \"oka\" sphere { radius: 1 } }"),
              "t.textproto:2:8: body[0].material \"oka\" is not defined; there is: oak, ice");
}

TEST(SceneErrors, RefuseMassesThatADensityMakesAbsurd) {
    EXPECT_EQ(body_error("body { box { half_extents { x: 100 y: 100 z: 100 } } }"),
              "t.textproto:2:1: body[0] weighs 2.15e+09 kg by its density; a dynamic body weighs "
              "0.001 .. 1000000 kg");
    EXPECT_EQ(body_error("body { sphere { radius: 0.01 } density: 1 }"),
              "t.textproto:2:32: body[0].density makes the body weigh 4.19e-06 kg; a dynamic "
              "body weighs 0.001 .. 1000000 kg");
    EXPECT_EQ(body_error("body { mode: fixed box { half_extents { x: 100 y: 100 z: 100 } } }"),
              "(no error)");
}

TEST(SceneErrors, RefuseArrangementsThatCannotBe) {
    const std::string sphere = "body { sphere { radius: 1 } ";
    EXPECT_EQ(body_error(sphere + "grid { count { x: 1 y: 1 z: 1 } } }"),
              "t.textproto:2:29: body[0].grid needs a count and a pitch, x y z each");
    EXPECT_EQ(body_error(sphere + "grid { count { x: 1 z: 1 } pitch { x: 1 y: 1 z: 1 } } }"),
              "t.textproto:2:36: body[0].grid.count.y is 0 bodies; give 1 .. 100000 bodies");
    EXPECT_EQ(body_error(sphere + "heap { count: 5 } }"),
              "t.textproto:2:29: body[0].heap.pitch is 0 m; give 0.01 .. 1000 m");
    EXPECT_EQ(body_error(sphere + "rotation { axis { x: 1 } } heap { count: 5 pitch: 2 } }"),
              "t.textproto:2:56: body[0].heap draws its bodies' orientations; leave out the "
              "body's own");
    EXPECT_EQ(body_error(sphere + "pyramid { base: 500 pitch_x: 1 pitch_y: 1 } }"),
              "t.textproto:2:29: body[0].pyramid makes more than 100000 bodies in all");
    EXPECT_EQ(body_error(sphere + "grid { count { x: 100000 y: 100000 z: 100000 } "
                                  "pitch { x: 1 y: 1 z: 1 } } }"),
              "t.textproto:2:29: body[0].grid makes more than 100000 bodies in all");
    EXPECT_EQ(body_error(sphere + "grid { count { x: 100 y: 1 z: 1 } "
                                  "pitch { x: 100 y: 1 z: 1 } } }"),
              "t.textproto:2:1: body[0] puts bodies outside settings.bounds");
}

TEST(SceneErrors, RefuseTooManySingleBodies) {
    const std::string heap = "name: \"t\" body { sphere { radius: 1 } heap { count: 100000 "
                             "pitch: 2 } }\n";
    EXPECT_EQ(parse(heap).bodies.size(), 100'000U);
    EXPECT_EQ(error_of(heap + "body { sphere { radius: 1 } }"),
              "t.textproto:2:1: body[1] makes more than 100000 bodies in all");
}

TEST(SceneErrors, RefusePodsThatCannotBe) {
    const SceneOptions two{2, 1, 0};
    EXPECT_EQ(error_of("name: \"t\"\n", two),
              "t.textproto: the scene seats no player: it has no `pods`, but 2 are to be seated");
    EXPECT_EQ(error_of("name: \"t\"\npods { players_max: 1 ring_radius: 3 body { sphere { radius: "
                       "1 } } }",
                       two),
              "t.textproto:2:8: pods.players_max is 1, but 2 players are to be seated");
    EXPECT_EQ(error_of("name: \"t\"\npods { players_max: 65 ring_radius: 3 }"),
              "t.textproto:2:8: pods.players_max is 65 players; give 1 .. 64 players");
    EXPECT_EQ(error_of("name: \"t\"\npods { players_max: 1 ring_radius: 3 body { mode: kinematic "
                       "sphere { radius: 1 } } }"),
              "t.textproto:2:45: pods.body.mode must be dynamic: a pod is driven by forces");
    EXPECT_EQ(error_of("name: \"t\"\npods { players_max: 1 ring_radius: 3 }"),
              "t.textproto:2:1: pods.body has no shape; give sphere, capsule, box, hull, compound, "
              "plane, "
              "height_field or mesh");
    EXPECT_EQ(error_of("name: \"t\"\npods { players_max: 1 ring_radius: 3 body { sphere { radius: "
                       "1 } heap { count: 2 pitch: 1 } } }"),
              "t.textproto:2:38: pods.body is placed and turned by the ring: it has no "
              "arrangement or turn");
}

TEST(SceneErrors, AskForAName) {
    EXPECT_EQ(error_of(""), "t.textproto: name is missing; begin the scene with one");
    EXPECT_EQ(error_of("\nname: \"" + std::string(65, 'n') + "\""),
              "t.textproto:2:1: name is longer than 64 bytes");
}

TEST(SceneErrors, SurviveHostileText) {
    std::string nested = "name: \"t\" ";
    for (int depth = 0; depth < 10'000; ++depth) {
        nested += "body { ";
    }
    EXPECT_NE(error_of(nested), "(no error)");
    EXPECT_NE(error_of(std::string(1000, '\0')), "(no error)");
    EXPECT_NE(error_of("name: \"\xff\xfe\" \x80"), "(no error)");
    EXPECT_NE(error_of(std::string(kSceneTextSizeBytesMax + 1, ' ')), "(no error)");
}

TEST(SceneFiles, MissingOnesSayWhatThereIs) {
    const Result<std::string> text = load_scene_text("no/such.textproto");
    ASSERT_FALSE(text.ok());
    EXPECT_EQ(text.error().message.find("no/such.textproto: No such file or directory; name a file "
                                        "or one of: arena, "),
              0U)
        << text.error().message;
    EXPECT_FALSE(load_scene_text(::testing::TempDir()).ok()) << "a folder is no scene";
}

TEST(SceneFiles, AreReadByPath) {
    const std::string path = ::testing::TempDir() + "lockwind_scene_test.textproto";
    std::ofstream(path) << kFloor;
    const Result<SceneReport> report = check_scene(path);
    std::remove(path.c_str());
    ASSERT_TRUE(report.ok()) << report.error().message;
    EXPECT_EQ(report.value().name, "t");
    EXPECT_EQ(report.value().bodies, 1U);
    EXPECT_EQ(report.value().bodies_dynamic, 0U);
    EXPECT_EQ(report.value().players_max, 0U);
}

TEST(SceneCheck, FindsEveryBuiltInSceneFitForAMatch) {
    for (const BuiltInScene& scene : built_in_scenes()) {
        const Result<SceneReport> report = check_scene(scene.name);
        ASSERT_TRUE(report.ok()) << scene.name << ": " << report.error().message;
        EXPECT_FALSE(report.value().description.empty()) << scene.name;
    }
}

} // namespace
} // namespace lockwind
