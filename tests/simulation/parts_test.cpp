#include "measures.h"
#include "tests/support/part_scenes.h"

#include <gtest/gtest.h>

// Compounds, height fields and meshes in motion.
namespace lockwind::test {
namespace {

BodyView view_of(World& world, BodyId id) {
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        if (world.body_at(row).id == id) {
            return world.body_at(row);
        }
    }
    ADD_FAILURE() << "no body " << id;
    return {};
}

/// Every convex shape and compound, `count` of them in a column of layers over the ground, about
/// `size` m large each.
void add_heap(WorldDefinition& scene, std::uint32_t count, double size, double low, double speed) {
    const Real unit = real(size);
    scene.hulls = {
        {{{unit, 0, 0}, {-unit, 0, 0}, {0, unit, 0}, {0, -unit, 0}, {0, 0, unit}, {0, 0, -unit}}}};
    scene.compounds = {
        {{box_child({unit, unit * Real(0.4), unit * Real(0.4)}, {unit * Real(0.6), 0, 0}),
          box_child({unit * Real(0.4), unit, unit * Real(0.4)}, {0, unit * Real(0.6), 0})}},
        {{ball_child(unit * Real(0.7), {unit * Real(0.6), 0, 0}),
          ball_child(unit * Real(0.7), {unit * Real(-0.6), 0, 0})}}};
    for (std::uint32_t index = 0; index < count; ++index) {
        constexpr ShapeType kTypes[] = {ShapeType::sphere,
                                        ShapeType::box,
                                        ShapeType::capsule,
                                        ShapeType::hull,
                                        ShapeType::compound,
                                        ShapeType::compound};
        const double pitch = 3.2 * size;
        BodyDefinition body = body_of(
            100 + index,
            kTypes[index % 6],
            vec((index % 3 - 1.0) * pitch, low + index / 9 * pitch, (index / 3 % 3 - 1.0) * pitch));
        body.shape.hull = 0;
        body.shape.compound = index % 6 == 4 ? 0 : 1;
        body.shape.radius = unit * Real(0.8);
        body.shape.half_height = unit * Real(0.6);
        body.shape.half_extents = {unit, unit * Real(0.7), unit * Real(0.8)};
        body.orientation = random_orientation(3, index);
        body.linear_velocity = vec(0, -speed, 0);
        scene.bodies.push_back(body);
    }
}

/// A bowl, so that nothing rolls off its border, with hills in it.
double bowl(double x, double z) {
    const double r = std::hypot(x, z);
    return 0.4 * hills(x, z) + 0.02 * r * r;
}

struct Fall {
    ShapeType ground;
    double size;
    double low;
    double speed;
};

class HeapOnGround : public testing::TestWithParam<Fall> {};

TEST_P(HeapOnGround, SettlesAndNothingFallsThrough) {
    const Fall& fall = GetParam();
    WorldDefinition scene;
    scene.height_fields = {field_over(40, 20, bowl)};
    scene.meshes = {mesh_of(scene.height_fields[0])};
    scene.bodies = {ground_of(1, fall.ground)};
    add_heap(scene, 36, fall.size, fall.low, fall.speed);
    const WorldPtr world = make_world(scene);
    for (int tick = 0; tick < 600; ++tick) {
        step_idle(*world, 1);
        for (BodyRow row = 1; row < world->body_count(); ++row) {
            const Vector place = vector_of(world->body_at(row).position);
            ASSERT_GT(place.y, bowl(place.x, place.z) - 0.3 * fall.size)
                << "body " << world->body_at(row).id << " tick " << tick;
        }
    }
    EXPECT_EQ(world->body_count(), scene.bodies.size());
    double energy = 0;
    for (BodyRow row = 1; row < world->body_count(); ++row) {
        const Vector velocity = vector_of(world->body_at(row).linear_velocity);
        energy += dot(velocity, velocity) / 2;
    }
    EXPECT_LT(energy / 36, 0.1); // J/kg; some still roll
    EXPECT_GT(world->counts().contacts, 60U);
    EXPECT_TRUE(world->check().ok());
}

INSTANTIATE_TEST_SUITE_P(Grounds,
                         HeapOnGround,
                         testing::Values(Fall{ShapeType::height_field, 0.3, 3, 0},
                                         Fall{ShapeType::mesh, 0.3, 3, 0},
                                         // Half a metre a tick: what is larger is held.
                                         Fall{ShapeType::height_field, 0.9, 3, 30},
                                         Fall{ShapeType::mesh, 0.9, 3, 30}));

/// Slides a shape over a ground at 5 m/s; how fast it is after 90 ticks, and how far it went up.
struct Slide {
    double speed;
    double rise;
    double spin;
};

Slide slide_over(BodyDefinition ground_body,
                 const WorldDefinition& with,
                 ShapeType type,
                 double angle) {
    WorldDefinition scene = with;
    ground_body.id = 1;
    scene.bodies = {ground_body};
    BodyDefinition body = body_of(2, type, {});
    body.shape.radius = 0.3;
    body.shape.half_height = 0.4;
    body.shape.half_extents = {0.4, 0.3, 0.35};
    body.friction = 0.2;
    body.linear_velocity = vec(5 * std::cos(angle), 0, 5 * std::sin(angle));
    body.position = vec(-6 * std::cos(angle) + 0.13, 0.3, -6 * std::sin(angle) + 0.07);
    if (type == ShapeType::capsule) { // lying, along its way
        body.orientation = turn(Vector{std::sin(angle), 0, -std::cos(angle)}, M_PI / 2);
    }
    scene.bodies.push_back(body);
    const WorldPtr world = make_world(scene);
    Slide slide{0, 0, 0};
    for (int tick = 0; tick < 90; ++tick) {
        step_idle(*world, 1);
        slide.rise = std::max(slide.rise, to_double(view_of(*world, 2).position.y) - 0.3);
    }
    slide.speed = length(vector_of(view_of(*world, 2).linear_velocity));
    slide.spin = length(vector_of(view_of(*world, 2).angular_velocity));
    return slide;
}

TEST(GhostCollisions, NothingIsStoppedByEdgesWithinAFlatFloor) {
    WorldDefinition scene;
    scene.height_fields = {field_over(40, 20, [](double, double) { return 0.0; })};
    scene.meshes = {mesh_of(scene.height_fields[0])};
    CompoundDefinition tiles; // of 2.5 m, 0.5 m thick
    for (int x = -2; x <= 2; ++x) {
        for (int z = -2; z <= 2; ++z) {
            tiles.children.push_back(
                box_child({1.25, 0.25, 1.25}, {Real(2.5) * Real(x), -0.25, Real(2.5) * Real(z)}));
        }
    }
    scene.compounds = {tiles};
    for (const ShapeType type : {ShapeType::box, ShapeType::sphere, ShapeType::capsule}) {
        for (const double angle : {0.0, 0.3, 0.7853, 2.0}) {
            const Slide plane = slide_over(ground(1), scene, type, angle);
            for (const ShapeType floor :
                 {ShapeType::height_field, ShapeType::mesh, ShapeType::compound}) {
                const Slide slide = slide_over(ground_of(1, floor), scene, type, angle);
                // A thousandth of the speed where it touches in one or two points. A box's points
                // are born anew at each edge that it crosses, with no impulse yet: 1.4 %.
                const double part = type == ShapeType::box ? 0.02 : 1e-3;
                EXPECT_NEAR(slide.speed, plane.speed, part * 5)
                    << static_cast<int>(type) << " on " << static_cast<int>(floor) << " at "
                    << angle;
                EXPECT_LT(slide.rise, 1e-3);
            }
        }
    }
}

TEST(CompoundBody, DumbbellTurnsByItsClosedFormInertia) {
    // Free, about an axis between its line and across: the moments of the closed form keep angular
    // momentum and energy, others would not; and the line precesses at L / I across.
    WorldDefinition scene;
    scene.settings.gravity = {0, 0, 0};
    scene.compounds = {dumbbell_piece()};
    BodyDefinition body = body_of(1, ShapeType::compound, {});
    body.density = 1000;
    body.angular_velocity = {3, 2, 0};
    scene.bodies = {body};
    const WorldPtr world = make_world(scene);
    const double along = 0.4 * 0.0625;
    const double across = along + 0.25;
    const double mass = 2 * 1000 * 4.0 / 3 * M_PI * 0.015625;
    EXPECT_NEAR(to_double(world->body_at(0).mass) / mass, 1, 1e-6);
    const Vector momentum{along * 3, across * 2, 0};
    // It precesses about L by |L| / I_across: after one turn its line lies as at first.
    const double period = 2 * M_PI * across / length(momentum);
    const int ticks = static_cast<int>(std::lround(period * 60));
    step_idle(*world, ticks);
    const BodyView after = world->body_at(0);
    const Vector line = turned(after.orientation, {1, 0, 0});
    const double angle = (ticks / 60.0 - period) * length(momentum) / across;
    EXPECT_LT(length(line - Vector{1, 0, 0}), std::abs(angle) + 0.01);
    const Vector spin = turned_back(after.orientation, vector_of(after.angular_velocity));
    const Vector now =
        turned(after.orientation, Vector{along * spin.x, across * spin.y, across * spin.z});
    EXPECT_LT(length(now - momentum), 2e-3 * length(momentum));
}

TEST(CompoundBody, RestsOnItsParts) {
    WorldDefinition scene;
    scene.compounds = {angle_piece(), table_piece()};
    BodyDefinition piece = body_of(2, ShapeType::compound, {0, 0.152, 0}, 0);
    BodyDefinition table = body_of(3, ShapeType::compound, {5, 0.002, 0}, 1);
    // One box on the table's top, one under it: the hollow between the legs is hollow.
    BodyDefinition above = box(4, {5, 1.3, 0}, {0.2, 0.25, 0.2});
    BodyDefinition below = box(5, {5, 0.3, 0}, {0.3, 0.3, 0.3});
    scene.bodies = {ground(1), piece, table, above, below};
    const WorldPtr world = make_world(scene);
    step_idle(*world, 300);
    const Vector angle = vector_of(view_of(*world, 2).position);
    EXPECT_NEAR(angle.y, 0.15, 0.01);
    EXPECT_NEAR(angle.x, 0, 0.01);
    EXPECT_NEAR(to_double(view_of(*world, 3).position.y), 0, 0.01);
    EXPECT_NEAR(to_double(view_of(*world, 4).position.y), 1.3, 0.02);
    EXPECT_NEAR(to_double(view_of(*world, 5).position.y), 0.3, 0.01);
    EXPECT_NEAR(to_double(view_of(*world, 5).position.x), 5, 0.01);
    for (const BodyId id : {BodyId{2}, BodyId{3}, BodyId{4}, BodyId{5}}) {
        EXPECT_TRUE(view_of(*world, id).asleep) << id;
    }
}

TEST(CompoundBody, AnglePiecesPileUp) {
    WorldDefinition scene;
    scene.compounds = {angle_piece()};
    scene.bodies = {ground(1)};
    for (std::uint32_t index = 0; index < 30; ++index) {
        BodyDefinition body =
            body_of(2 + index,
                    ShapeType::compound,
                    vec((index % 2) * 1.2 - 0.6, 1 + index / 4 * 1.3, (index / 2 % 2) * 1.2 - 0.6));
        body.orientation = random_orientation(5, index);
        scene.bodies.push_back(body);
    }
    const WorldPtr world = make_world(scene);
    step_idle(*world, 900);
    double highest = 0;
    double energy = 0;
    for (BodyRow row = 1; row < world->body_count(); ++row) {
        const BodyView body = world->body_at(row);
        const Vector velocity = vector_of(body.linear_velocity);
        energy += dot(velocity, velocity) / 2;
        for (const Vector& tip : {Vector{1.05, 0, 0}, Vector{0, 1.05, 0}, Vector{0, 0, 0}}) {
            const Vector place = vector_of(body.position) + turned(body.orientation, tip);
            EXPECT_GT(place.y, -0.02);
            highest = std::max(highest, place.y);
        }
    }
    EXPECT_GT(highest, 1.2); // they lie on each other
    EXPECT_LT(energy / 30, 0.01);
}

/// Bars through a heavy hub: a push at a tip turns them far more than one through the centre moves
/// them, which rows must bear.
TEST(CompoundBody, HubsWithLongBarsGainNoEnergy) {
    for (const double half : {0.6, 0.8, 1.0, 1.2}) {
        WorldDefinition scene;
        scene.settings.sleep_seconds = 0;
        CompoundDefinition spindle;
        spindle.children = {box_child({metres(half), 0.03, 0.03}, {0, 0, 0}),
                            ball_child(0.3, {0, 0, 0})};
        scene.compounds = {spindle};
        scene.bodies = {ground(1)};
        for (std::uint32_t index = 0; index < 24; ++index) {
            BodyDefinition body =
                body_of(2 + index,
                        ShapeType::compound,
                        vec((index % 3) * 0.9 - 0.9, 1 + index * 0.7, (index / 3 % 2) * 0.8 - 0.4));
            body.orientation = random_orientation(6, index);
            scene.bodies.push_back(body);
        }
        const WorldPtr world = make_world(scene);
        const double first = energy(*world);
        double last = first;
        for (int tick = 0; tick < 400; ++tick) {
            step_idle(*world, 1);
            last = energy(*world);
            ASSERT_LT(last, 1.02 * first) << half << ", tick " << tick; // some start in others
        }
        EXPECT_LT(last, first / 2);
    }
}

TEST(SurfaceBody, StackStandsOnAMeshAsOnABox) {
    const auto drift_on = [](const WorldDefinition& with, const BodyDefinition& floor) {
        WorldDefinition scene = with;
        scene.bodies = {floor};
        for (std::uint32_t index = 0; index < 8; ++index) {
            scene.bodies.push_back(box(2 + index, vec(0.21, 0.5 + index, 0.13), {0.5, 0.5, 0.5}));
        }
        const WorldPtr world = make_world(scene);
        step_idle(*world, 600);
        double drift = 0;
        for (BodyRow row = 1; row < world->body_count(); ++row) {
            drift = std::max(drift,
                             length(vector_of(world->body_at(row).position) -
                                    vector_of(scene.bodies[row].position)));
        }
        EXPECT_EQ(world->counts().awake, 0U);
        return drift;
    };
    WorldDefinition scene;
    scene.height_fields = {field_over(20, 8, [](double, double) { return 0.0; })};
    scene.meshes = {mesh_of(scene.height_fields[0])};
    BodyDefinition slab = box(1, {0, -1, 0}, {8, 1, 8});
    slab.mode = BodyMode::fixed;
    const double on_box = drift_on(scene, slab);
    const double on_mesh = drift_on(scene, ground_of(1, ShapeType::mesh));
    const double on_field = drift_on(scene, ground_of(1, ShapeType::height_field));
    EXPECT_LT(on_mesh, on_box + 0.01);
    EXPECT_LT(on_field, on_box + 0.01);
    EXPECT_LT(on_box, 0.06);
}

/// How many of the shots, at 900 m/s and more from all sides, end up below the ground.
int shots_below(const WorldDefinition& ground, CollisionMode mode, ShapeType shape) {
    constexpr std::uint32_t kShots = 200;
    WorldDefinition scene = ground;
    scene.settings.linear_speed_max = 1000;
    scene.settings.gravity = {0, 0, 0};
    scene.settings.bounds_policy = BoundsPolicy::destroy;
    for (std::uint32_t shot = 0; shot < kShots; ++shot) {
        const auto draw = [&](std::uint32_t which) {
            return 2 * random_below(17, 1, 8 * shot + which, 10001) / 10000.0 - 1;
        };
        BodyDefinition bullet =
            body_of(100 + shot, shape, metres_of(6 * draw(0), 5 + draw(1), 6 * draw(2)));
        bullet.shape.radius = 0.05;
        bullet.linear_velocity = metres_of(120 * draw(3), -900, 120 * draw(4));
        bullet.collision_mode = mode;
        bullet.layer = 1;
        scene.bodies.push_back(bullet);
    }
    scene.settings.layer_masks[1] = ~2U; // shots do not meet each other
    const WorldPtr world = make_world(scene);
    step_idle(*world, 3);
    int below = 0;
    for (std::uint32_t shot = 0; shot < kShots; ++shot) {
        const auto body = world->body(100 + shot);
        below += !body || vector_of(body->position).y < -1 ? 1 : 0;
    }
    return below;
}

TEST(SweptBodies, PassNoSurfaceAndNoCompound) {
    const HeightFieldDefinition field = field_over(24, 12, hills);
    CompoundDefinition plates; // 10 cm thick, turned by a hand's breadth
    for (int x = -2; x <= 2; ++x) {
        for (int z = -2; z <= 2; ++z) {
            plates.children.push_back(
                box_child({2.2, 0.05, 2.2},
                          {Real(4) * Real(x), Real(0.02) * Real(x + z), Real(4) * Real(z)}));
        }
    }
    for (const ShapeType ground : {ShapeType::height_field, ShapeType::mesh, ShapeType::compound}) {
        WorldDefinition scene;
        scene.height_fields = {field};
        scene.meshes = {mesh_of(field)};
        scene.compounds = {plates,
                           {{ball_child(0.05, {0.1, 0, 0}), ball_child(0.05, {-0.1, 0, 0})}}};
        scene.bodies = {ground_of(1, ground)};
        const int type = static_cast<int>(ground);
        EXPECT_EQ(shots_below(scene, CollisionMode::swept, ShapeType::sphere), 0) << type;
        EXPECT_GT(shots_below(scene, CollisionMode::discrete, ShapeType::sphere), 100) << type;
        std::swap(scene.compounds[0], scene.compounds[1]);
        scene.bodies = {ground_of(1, ground, ground == ShapeType::compound ? 1 : 0)};
        EXPECT_EQ(shots_below(scene, CollisionMode::swept, ShapeType::compound), 0) << type;
        EXPECT_GT(shots_below(scene, CollisionMode::discrete, ShapeType::compound), 100) << type;
    }
}

} // namespace
} // namespace lockwind::test
