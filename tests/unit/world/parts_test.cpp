#include "dynamics/contact.h"
#include "query_scene.h"
#include "tests/support/part_scenes.h"
#include "world/state.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <set>

namespace lockwind::test {
namespace {

double value(Real real) {
    return static_cast<double>(real.raw()) * 0x1p-32;
}

/// Hills under boxes, balls, capsules, rocks and compounds that fall.
WorldDefinition part_scene(ShapeType ground_type) {
    WorldDefinition scene;
    scene.height_fields = {field_over(16, 8, hills)};
    scene.meshes = {mesh_of(scene.height_fields[0])};
    scene.compounds = {angle_piece(), dumbbell_piece(), table_piece()};
    scene.hulls = {wedge()};
    scene.bodies = {ground_of(1, ground_type)};
    for (std::uint32_t index = 0; index < 16; ++index) {
        constexpr ShapeType kTypes[] = {ShapeType::compound,
                                        ShapeType::sphere,
                                        ShapeType::box,
                                        ShapeType::compound,
                                        ShapeType::hull,
                                        ShapeType::capsule};
        BodyDefinition body = body_of(
            2 + index,
            kTypes[index % 6],
            metres_of((index % 4) * 1.7 - 2.5, 1.5 + index / 8 * 1.8, (index / 4 % 2) * 2.2 - 1));
        body.shape.hull = 0;
        body.shape.compound = index % 3;
        body.shape.radius = 0.4;
        body.orientation = random_orientation(9, index);
        scene.bodies.push_back(body);
    }
    return scene;
}

class Parts : public testing::TestWithParam<ShapeType> {};

TEST_P(Parts, GoOnToTheSameBitsFromASnapshotAtAnyTick) {
    const WorldDefinition scene = part_scene(GetParam());
    const WorldPtr world = make_world(scene);
    const WorldPtr other = make_world(scene);
    for (int tick = 0; tick < 150; ++tick) {
        step_idle(*world, 1);
        std::vector<std::byte> state;
        world->save(state);
        if (tick % 10 == 0) {
            ASSERT_TRUE(other->load(state).ok()) << tick;
        } else {
            step_idle(*other, 1);
        }
        ASSERT_EQ(world->state_hash(), other->state_hash()) << tick;
        ASSERT_EQ(world->counts().pairs, other->counts().pairs) << tick;
    }
    EXPECT_GT(world->counts().contacts, 30U);
}

TEST_P(Parts, TouchByOneEventForTwoBodies) {
    const WorldPtr world = make_world(part_scene(GetParam()));
    std::map<std::pair<BodyId, BodyId>, bool> touching;
    int begun = 0;
    std::size_t rows_most = 0;
    for (int tick = 0; tick < 300; ++tick) {
        step_idle(*world, 1);
        for (const Event& event : world->events()) {
            if (event.type == EventType::contact_begin || event.type == EventType::contact_end) {
                bool& was = touching[{event.a, event.b}];
                const bool begins = event.type == EventType::contact_begin;
                ASSERT_NE(was, begins) << event.a << " and " << event.b << " tick " << tick;
                was = begins;
                begun += begins;
            }
        }
        // Who touches by what was told is who touches by the contacts that there are.
        std::map<std::pair<BodyId, BodyId>, std::size_t> seen;
        for (const ContactView& contact : world->contacts()) {
            rows_most = std::max(rows_most, ++seen[{contact.body_a, contact.body_b}]);
        }
        for (const auto& [pair, is_touching] : touching) {
            ASSERT_EQ(is_touching, seen.count(pair) == 1) << pair.first << " and " << pair.second;
        }
    }
    EXPECT_GT(begun, 16);
    EXPECT_GT(rows_most, 2U); // several parts of two bodies at once
}

/// How far a point lies outside of a child that is a box or ball, m.
double beyond_child(const BodyView& body, const CompoundChild& child, const Vec3& point) {
    const Vec3 local =
        rotate(conjugate(child.orientation),
               rotate(conjugate(body.orientation), point - body.position) - child.position);
    const double at[3] = {to_double(local.x), to_double(local.y), to_double(local.z)};
    if (child.shape.type == ShapeType::sphere) {
        return std::hypot(at[0], at[1], at[2]) - to_double(child.shape.radius);
    }
    const Vec3& half = child.shape.half_extents;
    return std::max({std::abs(at[0]) - to_double(half.x),
                     std::abs(at[1]) - to_double(half.y),
                     std::abs(at[2]) - to_double(half.z)});
}

/// How far a point of [-half, half]^2, seen from above, lies outside of a triangle of
/// field_over(cells, half, .) or of its mesh, whose diagonals go the other way.
double beyond_triangle(
    ShapeType type, std::uint32_t triangle, std::uint32_t cells, double half, const Vec3& point) {
    const double cell = 2 * half / cells;
    const double x = (to_double(point.x) + half) / cell - triangle / 2 % cells;
    const double z = (to_double(point.z) + half) / cell - triangle / 2 / cells;
    const bool first = triangle % 2 == 0;
    const double across =
        type == ShapeType::height_field ? (first ? x - z : z - x) : (first ? x + z - 1 : 1 - x - z);
    return std::max({-x, x - 1, -z, z - 1, across}) * cell;
}

TEST_P(Parts, AreNamedByTheirContacts) {
    WorldDefinition scene;
    scene.height_fields = {field_over(8, 8, [](double, double) { return 0.0; })};
    scene.meshes = {mesh_of(scene.height_fields[0])};
    scene.compounds = {table_piece(), dumbbell_piece()};
    scene.bodies = {ground_of(5, GetParam()),
                    body_of(2, ShapeType::compound, {0.3, 0.01, 0.2}),
                    body_of(7, ShapeType::compound, {0.5, 1.33, 0.3}, 1),
                    body_of(9, ShapeType::sphere, {-4.7, 0.5, 3.3})};
    scene.bodies[3].shape.radius = 0.5;
    const WorldPtr world = make_world(scene);
    step_idle(*world, 30);
    std::set<std::pair<BodyId, std::uint32_t>> legs;
    std::set<std::uint32_t> triangles;
    int simple = 0;
    for (const ContactView& contact : world->contacts()) {
        for (const auto& [id, part] : {std::pair{contact.body_a, contact.part_a},
                                       std::pair{contact.body_b, contact.part_b}}) {
            const BodyView body = world->body(id).value();
            if (body.shape.type == ShapeType::sphere) {
                EXPECT_EQ(part, 0U);
                ++simple;
                continue;
            }
            for (std::uint32_t point = 0; point < contact.point_count; ++point) {
                const Vec3& place = contact.points[point].position;
                if (body.shape.type == ShapeType::compound) {
                    const CompoundDefinition& compound = scene.compounds[body.shape.compound];
                    ASSERT_LT(part, compound.children.size());
                    EXPECT_LT(beyond_child(body, compound.children[part], place), 0.015);
                    legs.insert({id, part});
                } else {
                    ASSERT_LT(part, 128U);
                    EXPECT_LT(beyond_triangle(GetParam(), part, 8, 8, place), 0.01);
                    triangles.insert(part);
                }
            }
        }
    }
    EXPECT_EQ(legs.size(), 7U); // of a table, its top, and a dumbbell's balls
    EXPECT_GT(triangles.size(), 4U);
    EXPECT_GT(simple, 0);
}

TEST_P(Parts, FallAsleepAndWakeTogether) {
    WorldDefinition scene = part_scene(GetParam());
    scene.height_fields[0] =
        field_over(16, 8, [](double x, double z) { return 0.03 * (x * x + z * z); });
    scene.meshes[0] = mesh_of(scene.height_fields[0]);
    const WorldPtr world = make_world(scene);
    step_idle(*world, 1800);
    const std::uint32_t awake = world->counts().awake;
    EXPECT_LT(awake, 6U); // balls may still roll in the bowl
    const std::uint64_t contacts = world->counts().contacts;
    EXPECT_GT(contacts, 30U);
}

TEST_P(Parts, OfGroupsFarApartDoNotChangeEachOther) {
    WorldDefinition scene = part_scene(GetParam());
    const WorldPtr alone = make_world(scene);
    // The same again, 100 m off: other rows, other slots, more pairs.
    const std::size_t count = scene.bodies.size();
    for (std::size_t index = 0; index < count; ++index) {
        BodyDefinition body = scene.bodies[index];
        body.id += 1000;
        body.position.x += Real(100);
        scene.bodies.push_back(body);
    }
    std::rotate(scene.bodies.begin(), scene.bodies.begin() + 5, scene.bodies.end());
    const WorldPtr both = make_world(scene);
    step_idle(*alone, 120);
    step_idle(*both, 120);
    for (BodyRow row = 0; row < count; ++row) {
        const BodyView a = alone->body_at(row);
        const BodyView b = both->body_at(row);
        const BodyView far = both->body_at(row + static_cast<BodyRow>(count));
        ASSERT_EQ(a.id, b.id);
        EXPECT_EQ(a.position, b.position) << a.id;
        EXPECT_EQ(a.orientation, b.orientation) << a.id;
        const Vec3 moved = a.position + Vec3{100, 0, 0};
        EXPECT_EQ(moved, far.position) << a.id;
    }
}

TEST_P(Parts, RefusesPartsThatAreNot) {
    const WorldPtr world = make_world(part_scene(GetParam()));
    step_idle(*world, 60);
    std::vector<std::byte> sound;
    world->save(sound);
    const auto refuses = [&](auto&& damage) {
        EXPECT_TRUE(world->load(sound).ok());
        const auto manifolds =
            reinterpret_cast<Manifold*>(world->section_bytes(section::kManifold).data());
        for (std::uint32_t row = 0; row < world->row_count(section::kManifold); ++row) {
            if (manifolds[row].point_count != 0) {
                damage(manifolds[row]);
                break;
            }
        }
        std::vector<std::byte> damaged;
        world->save(damaged);
        EXPECT_TRUE(world->load(sound).ok());
        return !world->load(damaged).ok();
    };
    EXPECT_TRUE(refuses([](Manifold& manifold) { manifold.child = 0; }));
    EXPECT_TRUE(refuses([](Manifold& manifold) { manifold.child = 0xffffffff; }));
    EXPECT_TRUE(refuses([](Manifold& manifold) { manifold.child = 40000000; }));
    EXPECT_FALSE(refuses([](Manifold&) {}));
}

INSTANTIATE_TEST_SUITE_P(Grounds, Parts, testing::Values(ShapeType::height_field, ShapeType::mesh));

/// A hull that lies far to one side: its bounds, as long to both sides, go beyond the compound's
/// radius.
TEST(PartWorld, StateOfALopsidedCompoundCanBeLoaded) {
    WorldDefinition scene;
    HullDefinition nail;
    for (const Vec3& point : {metres_of(5, 0, 0),
                              metres_of(-0.5, 0, 0),
                              metres_of(0, 0.7, 0),
                              metres_of(0, -0.7, 0),
                              metres_of(0, 0, 0.7),
                              metres_of(0, 0, -0.7)}) {
        nail.points.push_back(point);
    }
    scene.hulls = {nail};
    CompoundDefinition hammer;
    ShapeDefinition head;
    head.type = ShapeType::sphere;
    head.radius = 2;
    ShapeDefinition handle;
    handle.type = ShapeType::hull;
    hammer.children = {{head, metres_of(5, 0, 0), {}, 1}, {handle, {}, {}, 1}};
    scene.compounds = {hammer};
    scene.bodies = {body_of(1, ShapeType::compound, metres_of(0, 5, 0))};
    const WorldPtr world = make_world(scene);
    step_idle(*world, 30);
    std::vector<std::byte> state;
    world->save(state);
    const Status loaded = make_world(scene)->load(state);
    EXPECT_TRUE(loaded.ok()) << loaded.error().message;
}

/// Along the principal axes a running surface may be faster than along any axis of the definition.
TEST(PartWorld, StateOfACompoundWhoseSurfaceRunsAtFullSpeedCanBeLoaded) {
    WorldDefinition scene;
    CompoundDefinition angle;
    angle.children.resize(2);
    for (CompoundChild& child : angle.children) {
        child.shape.type = ShapeType::box;
        child.shape.half_extents = metres_of(0.5, 0.15, 0.15);
    }
    angle.children[1].position = metres_of(0.35, 0.5, 0);
    angle.children[1].orientation = {0, 0, 0.6, 0.8};
    scene.compounds = {angle};
    BodyDefinition body = body_of(1, ShapeType::compound, metres_of(0, 5, 0));
    body.surface_velocity = {100, 100, 100};
    scene.bodies = {body};
    const WorldPtr world = make_world(scene);
    std::vector<std::byte> state;
    world->save(state);
    const Status loaded = world->load(state);
    EXPECT_TRUE(loaded.ok()) << loaded.error().message;
}

TEST(PartQueries, FindWhatABruteForceOverSimpleBodiesFinds) {
    // A compound's children as bodies of their own: every query must tell the same.
    QueryDraws draws(17);
    WorldDefinition whole;
    WorldDefinition apart;
    whole.hulls = apart.hulls = {wedge()};
    whole.settings.gravity = apart.settings.gravity = {0, 0, 0};
    std::map<BodyId, BodyId> whole_of;
    for (std::uint32_t index = 0; index < 20; ++index) {
        CompoundDefinition compound;
        const Vec3 place = draws.vector(12);
        const RealQuat turn = draws.orientation();
        for (std::uint32_t child = 0; child < 3; ++child) {
            CompoundChild part;
            part.shape = draws.shape(0.2, 0.9);
            part.position = draws.vector(1.5);
            part.orientation = draws.orientation();
            compound.children.push_back(part);
            BodyDefinition body;
            body.id = 100 + 10 * index + child;
            body.mode = BodyMode::fixed;
            body.shape = part.shape;
            body.position = place + rotate(turn, part.position);
            body.orientation = turn * part.orientation;
            whole_of[body.id] = 1 + index;
            apart.bodies.push_back(body);
        }
        whole.compounds.push_back(compound);
        BodyDefinition body = body_of(1 + index, ShapeType::compound, place, index);
        body.mode = BodyMode::fixed;
        body.orientation = turn;
        whole.bodies.push_back(body);
    }
    const WorldPtr a = make_world(whole);
    const WorldPtr b = make_world(apart);
    int hits = 0;
    for (int round = 0; round < 1000; ++round) {
        const Vec3 from = draws.vector(15);
        const Vec3 to = draws.vector(15);
        const auto ray_a = a->ray_cast(from, to);
        const auto ray_b = b->ray_cast(from, to);
        ASSERT_EQ(ray_a.has_value(), ray_b.has_value());
        if (ray_a) {
            ++hits;
            EXPECT_EQ(ray_a->body, whole_of[ray_b->body]);
            EXPECT_NEAR(value(ray_a->fraction), value(ray_b->fraction), 1e-6);
        }
        const auto near_a = a->closest_point(from, 5);
        const auto near_b = b->closest_point(from, 5);
        ASSERT_EQ(near_a.has_value(), near_b.has_value());
        if (near_a) {
            EXPECT_NEAR(value(near_a->distance), value(near_b->distance), 1e-5);
        }
        ShapeDefinition shape = draws.shape(0.1, 1);
        shape.hull = 0;
        const auto cast_a = a->shape_cast(shape, from, {}, to - from);
        const auto cast_b = b->shape_cast(shape, from, {}, to - from);
        ASSERT_EQ(cast_a.has_value(), cast_b.has_value());
        if (cast_a) {
            EXPECT_NEAR(value(cast_a->fraction), value(cast_b->fraction), 1e-5);
        }
        std::vector<BodyId> expected;
        for (const BodyId id : b->overlap(shape, from, {})) {
            expected.push_back(whole_of[id]);
        }
        std::sort(expected.begin(), expected.end());
        expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
        EXPECT_EQ(a->overlap(shape, from, {}), expected);
    }
    EXPECT_GT(hits, 50);
}

TEST(PartQueries, MeetHillsWhereTheyAre) {
    // The ground is flat within a cell's triangle: its height follows from three samples.
    WorldDefinition scene;
    scene.height_fields = {field_over(32, 8, hills)};
    scene.meshes = {mesh_of(scene.height_fields[0])};
    const HeightFieldDefinition& field = scene.height_fields[0];
    const auto height_at = [&](double x, double z) {
        const double u = (x + 8) / 0.5;
        const double v = (z + 8) / 0.5;
        const auto column = static_cast<std::uint32_t>(u);
        const auto row = static_cast<std::uint32_t>(v);
        const double s = u - column;
        const double t = v - row;
        const auto sample = [&](std::uint32_t c, std::uint32_t r) {
            return value(field.heights[r * field.columns + c]);
        };
        const double low = sample(column, row);
        const double high = sample(column + 1, row + 1);
        return s > t ? low + (sample(column + 1, row) - low) * s +
                           (high - sample(column + 1, row)) * t
                     : low + (sample(column, row + 1) - low) * t +
                           (high - sample(column, row + 1)) * s;
    };
    scene.bodies = {ground_of(1, ShapeType::height_field)};
    scene.bodies[0].position = {3, 5, -2};
    const WorldPtr world = make_world(scene);
    QueryDraws draws(23);
    for (int round = 0; round < 500; ++round) {
        const Vec3 on{draws.within(-7.9, 7.9), 0, draws.within(-7.9, 7.9)};
        const Vec3 above = on + Vec3{3, 15, -2};
        const Vec3 below = on + Vec3{3, -5, -2};
        const double height = 5 + height_at(value(on.x), value(on.z));
        const auto hit = world->ray_cast(above, below);
        ASSERT_TRUE(hit.has_value());
        EXPECT_NEAR(value(hit->point.y), height, 2e-6);
        EXPECT_GT(value(hit->normal.y), 0.3);
        EXPECT_FALSE(world->ray_cast(below, above).has_value()); // from behind
        // A ball that is let down stops above it; from below it passes.
        ShapeDefinition ball;
        ball.radius = 0.3;
        const auto cast = world->shape_cast(ball, above, {}, {0, -20, 0});
        ASSERT_TRUE(cast.has_value());
        EXPECT_GT(15 - 20 * value(cast->fraction), height + 0.29);
        EXPECT_FALSE(world->shape_cast(ball, below, {}, {0, 20, 0}).has_value());
        // What it overlaps at the start counts, even where it leaves.
        const Vec3 amid{hit->point.x, hit->point.y - Real(0.1), hit->point.z};
        const auto leaving = world->shape_cast(ball, amid, {}, {0, 20, 0});
        ASSERT_TRUE(leaving.has_value());
        EXPECT_EQ(leaving->fraction, Real(0));
        // The nearest place is no farther than straight down, and the cast's end is just clear.
        const Vec3 end = above + Vec3{0, Real(-20) * cast->fraction, 0};
        const auto nearest = world->closest_point(end, 1);
        ASSERT_TRUE(nearest.has_value());
        EXPECT_NEAR(value(nearest->distance), 0.3, 3e-5);
        EXPECT_TRUE(world->overlap(ball, end, {}).empty());
        EXPECT_EQ(world->overlap(ball, end - Vec3{0, 0.01, 0}, {}), std::vector<BodyId>{1});
    }
}

TEST(PartWorld, ErrorsNameWhatIsWrong) {
    WorldDefinition scene;
    const auto refusal = [&] {
        const Result<WorldPtr> world = World::create(scene);
        return world.ok() ? "" : world.error().message;
    };
    scene.compounds = {{}};
    EXPECT_EQ(refusal(), "compound 0: has 0 children; give 1 .. 32");
    scene.compounds.clear();
    scene.meshes = {{}};
    EXPECT_EQ(refusal(), "mesh 0: has 0 indices; give three for each triangle, and at least one");
    scene.meshes.clear();
    scene.height_fields = {{}};
    EXPECT_EQ(refusal(), "height field 0: has 0 heights; its columns and rows are 4 samples");
    scene.height_fields = {field_over(2, 1, hills)};
    scene.bodies = {body_of(7, ShapeType::height_field, {})};
    EXPECT_EQ(refusal(), "body 7: shape.type is a height field; only a fixed body may be one");
    scene.bodies = {ground_of(7, ShapeType::mesh)};
    EXPECT_EQ(refusal(), "body 7: shape.mesh is 0; there are 0 meshes");
    scene.bodies = {body_of(7, ShapeType::compound, {}, 3)};
    EXPECT_EQ(refusal(), "body 7: shape.compound is 3; there are 0 compounds");
}

} // namespace
} // namespace lockwind::test
