#include "tests/unit/geometry/hull_points.h"
#include "tests/unit/world/query_scene.h"

#include <gtest/gtest.h>
#include <memory>

namespace lockwind::test {
namespace {

using reference::Solid;
using reference::Vec;

constexpr double kError = 2e-6; // m, as world.h states
constexpr double kGap = 15.3e-6;
constexpr double kGapMost = 19.1e-6;

Vec to_vec(const Vec3& v) {
    return {to_double(v.x), to_double(v.y), to_double(v.z)};
}

Vec turned(const RealQuat& q, const Vec& v) {
    const double raw[4] = {to_double(q.x), to_double(q.y), to_double(q.z), to_double(q.w)};
    return reference::rotated(raw, v);
}

/// A shape in the world in double precision, from its definition alone.
struct Placed {
    ShapeDefinition shape;
    Vec position;
    RealQuat orientation;
    std::shared_ptr<const Solid> solid = nullptr; // of a hull, in the world

    Placed(const ShapeDefinition& of, const Vec3& at, const RealQuat& turn)
        : shape(of), position(to_vec(at)), orientation(turn) {
        if (shape.type == ShapeType::hull) {
            std::vector<Vec> points;
            for (const Vec3& point : wedge().points) {
                points.push_back(position + turned(turn, to_vec(point)));
            }
            solid = std::make_shared<const Solid>(std::move(points));
        }
    }
    double distance(const Vec& point) const {
        if (solid != nullptr) {
            return solid->distance(point);
        }
        const Vec local = turned(conjugate(orientation), point - position);
        switch (shape.type) {
        case ShapeType::sphere:
            return reference::length(local) - to_double(shape.radius);
        case ShapeType::capsule: {
            const double half = to_double(shape.half_height);
            return reference::length(local - Vec{0, std::clamp(local[1], -half, half), 0}) -
                   to_double(shape.radius);
        }
        case ShapeType::box:
            return reference::box_distance(to_vec(shape.half_extents), local);
        default:
            return local[1];
        }
    }
};

std::vector<Placed> placed_bodies(const World& world) {
    std::vector<Placed> all;
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        const BodyView body = world.body_at(row);
        all.emplace_back(body.shape, body.position, body.orientation);
    }
    return all;
}

/// Row and distance of the body nearest to a point.
std::pair<BodyRow, double> nearest(const std::vector<Placed>& bodies, const Vec& point) {
    std::pair<BodyRow, double> best{0, 1e9};
    for (BodyRow row = 0; row < bodies.size(); ++row) {
        const double distance = bodies[row].distance(point);
        if (distance < best.second) {
            best = {row, distance};
        }
    }
    return best;
}

ShapeDefinition ball(Real radius) {
    ShapeDefinition shape;
    shape.radius = radius;
    return shape;
}

TEST(WorldClosestPoint, AgreesWithDoublePrecision) {
    const WorldPtr world = make_world(query_scene(60, 4));
    step_idle(*world, 3);
    const std::vector<Placed> bodies = placed_bodies(*world);
    QueryDraws draws(1);
    int outside = 0;
    for (int round = 0; round < 400; ++round) {
        const Vec3 point = draws.vector(6);
        const auto found = world->closest_point(point, 100);
        ASSERT_TRUE(found);
        const auto [row, distance] = nearest(bodies, to_vec(point));
        EXPECT_NEAR(to_double(found->distance), std::max(distance, 0.0), kError);
        if (distance < kError) {
            EXPECT_TRUE(distance > -kError || found->distance == 0);
            continue;
        }
        ++outside;
        EXPECT_EQ(found->body, world->body_at(row).id);
        EXPECT_NEAR(bodies[row].distance(to_vec(found->point)), 0, kError);
        const Vec way = to_vec(found->point) + to_vec(found->normal) * distance - to_vec(point);
        EXPECT_NEAR(reference::length(way), 0, 2 * kError);
        EXPECT_FALSE(world->closest_point(point, found->distance - Real::ulp()));
        EXPECT_EQ(world->closest_point(point, found->distance), found);
    }
    EXPECT_GT(outside, 200);
}

TEST(WorldClosestPoint, IsZeroAndWithoutNormalInside) {
    const WorldPtr world = make_world(query_scene(0, 4));
    ASSERT_TRUE(world->create_body(box(7, {0, 0, 0}, {1, 1, 1})).ok());
    ASSERT_TRUE(world->create_body(sphere(5, {0.5, 0, 0}, 1)).ok());
    const Vec3 point{0.25, 0.5, 0};
    EXPECT_EQ(world->closest_point(point, 1), (ClosestPoint{5, 0, point, {}}));
    EXPECT_EQ(world->closest_point(point, 0, {.ignore = 5}), (ClosestPoint{7, 0, point, {}}));
    EXPECT_EQ(world->closest_point({0, -5, 0}, 1), (ClosestPoint{1, 0, {0, -5, 0}, {}})) << "below";
}

TEST(WorldOverlap, AgreesWithDoublePrecisionForSpheres) {
    const WorldPtr world = make_world(query_scene(60, 4));
    step_idle(*world, 3);
    const std::vector<Placed> bodies = placed_bodies(*world);
    QueryDraws draws(2);
    std::size_t overlaps = 0;
    for (int round = 0; round < 300; ++round) {
        const Vec3 place = draws.vector(6);
        const Real radius = draws.within(0.05, 2);
        const std::vector<BodyId> found = world->overlap(ball(radius), place, {});
        EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
        overlaps += found.size();
        for (BodyRow row = 0; row < bodies.size(); ++row) {
            const double apart = bodies[row].distance(to_vec(place)) - to_double(radius);
            const BodyId id = world->body_at(row).id;
            if (std::abs(apart) > kError) {
                EXPECT_EQ(std::binary_search(found.begin(), found.end(), id), apart < 0) << apart;
            }
        }
    }
    EXPECT_GT(overlaps, 300U);
}

TEST(WorldShapeCast, SpheresStopAtTheGapOfTheFirstBody) {
    const WorldPtr world = make_world(query_scene(60, 4));
    step_idle(*world, 3);
    const std::vector<Placed> bodies = placed_bodies(*world);
    QueryDraws draws(3);
    int hits = 0;
    for (int round = 0; round < 300; ++round) {
        const Vec3 from = draws.vector(6);
        const Vec3 way = draws.vector(6) - from;
        const Real radius = draws.within(0.02, 0.5);
        const auto clear = [&](double fraction) {
            return nearest(bodies, to_vec(from) + to_vec(way) * fraction).second -
                   to_double(radius);
        };
        const auto hit = world->shape_cast(ball(radius), from, {}, way);
        const double end = hit ? to_double(hit->fraction) : 1;
        if (clear(0) <= kGapMost + kError) {
            EXPECT_TRUE(clear(0) > -kError || (hit && hit->fraction == 0 && hit->normal == Vec3{}));
            continue;
        }
        // Nothing is met on the way.
        for (int step = 0; step <= 200; ++step) {
            EXPECT_GT(clear(end * step / 200), kGap - kError);
        }
        if (hit) {
            ++hits;
            EXPECT_LT(clear(end), kGapMost + kError);
            const Placed body(world->body(hit->body)->shape,
                              world->body(hit->body)->position,
                              world->body(hit->body)->orientation);
            EXPECT_NEAR(body.distance(to_vec(hit->point)), 0, kError);
        }
    }
    EXPECT_GT(hits, 80);
}

TEST(WorldShapeCast, HullsStandInTheFrameOfTheirPoints) {
    WorldDefinition scene;
    scene.hulls = {wedge()};
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(box(2, {5, 0.5, 0}, {0.5, 0.5, 0.5}));
    const WorldPtr world = make_world(scene);
    ShapeDefinition shape;
    shape.type = ShapeType::hull;
    // Upside down about x: its tip, at y = 1, looks down.
    const RealQuat over{1, 0, 0, 0};
    const auto down = world->shape_cast(shape, {20, 4, 0}, over, {0, -8, 0});
    ASSERT_TRUE(down);
    EXPECT_EQ(down->body, 1U);
    EXPECT_NEAR(to_double(down->fraction), 3.0 / 8, 1e-5);
    EXPECT_NEAR(to_double(down->point.x), 20, 1e-5);
    EXPECT_NEAR(to_double(down->point.z), -0.25, 1e-5);
    EXPECT_EQ(world->overlap(shape, {20, 1.0001, 0}, over), std::vector<BodyId>{});
    EXPECT_EQ(world->overlap(shape, {20, 0.9999, 0}, over), std::vector<BodyId>{1});
    // On its feet beside the box: x from 0 to 1.
    EXPECT_EQ(world->overlap(shape, {3.4999, 0.5, 0}, {}), std::vector<BodyId>{});
    EXPECT_EQ(world->overlap(shape, {3.5001, 0.5, 0}, {}), std::vector<BodyId>{2});
}

TEST(WorldRayCastAll, TellsEachBodyOnceByFractionThenId) {
    WorldDefinition scene;
    scene.bodies.push_back(box(9, {0, 0, 5}, {1, 1, 1}));
    scene.bodies.push_back(box(4, {1.5, 0, 5}, {1, 1, 1}));
    scene.bodies.push_back(sphere(3, {0.75, 0, 8}, 1));
    scene.bodies.push_back(sphere(2, {0.75, 0, 2}, 1));
    scene.bodies.push_back(sphere(1, {0.75, 3, 2}, 1));
    const WorldPtr world = make_world(scene);
    const std::vector<RayHit> hits = world->ray_cast_all({0.75, 0, 0}, {0.75, 0, 10});
    ASSERT_EQ(hits.size(), 4U);
    const BodyId ids[] = {2, 4, 9, 3};
    const double fractions[] = {0.1, 0.4, 0.4, 0.7};
    for (std::size_t index = 0; index < 4; ++index) {
        EXPECT_EQ(hits[index].body, ids[index]);
        EXPECT_NEAR(to_double(hits[index].fraction), fractions[index], 1e-7);
    }
    EXPECT_EQ(world->ray_cast({0.75, 0, 0}, {0.75, 0, 10}), hits[0]);
    const std::vector<RayHit> back = world->ray_cast_all({0.75, 0, 10}, {0.75, 0, 0});
    ASSERT_EQ(back.size(), 4U);
    const BodyId ids_back[] = {3, 4, 9, 2};
    for (std::size_t index = 0; index < 4; ++index) {
        EXPECT_EQ(back[index].body, ids_back[index]);
    }
    EXPECT_EQ(world->shape_cast(ball(0.1), {0.75, 0, 3.5}, {}, {0, 0, 9})->body, 4U) << "a tie";
}

TEST(WorldQueryFilter, ChoosesLayersSensorsAndWhomToIgnore) {
    WorldDefinition scene;
    for (BodyId id = 1; id <= 4; ++id) {
        BodyDefinition body = sphere(id, {0, 0, Real(3 * id)}, 1);
        body.layer = static_cast<std::uint32_t>(id);
        body.sensor = id == 2;
        scene.bodies.push_back(body);
    }
    const WorldPtr world = make_world(scene);
    const auto ids = [&](const QueryFilter& filter) {
        std::vector<BodyId> found;
        for (const RayHit& hit : world->ray_cast_all({}, {0, 0, 20}, filter)) {
            found.push_back(hit.body);
        }
        EXPECT_EQ(world->overlap(ball(30), {}, {}, filter), found);
        const BodyId first = found.empty() ? 0 : found[0];
        const auto ray = world->ray_cast({}, {0, 0, 20}, filter);
        EXPECT_EQ(ray ? ray->body : 0, first);
        const auto near = world->closest_point({}, 20, filter);
        EXPECT_EQ(near ? near->body : 0, first);
        const auto cast = world->shape_cast(ball(0.5), {}, {}, {0, 0, 20}, filter);
        EXPECT_EQ(cast ? cast->body : 0, first);
        return found;
    };
    using Ids = std::vector<BodyId>;
    EXPECT_EQ(ids({}), (Ids{1, 2, 3, 4}));
    EXPECT_EQ(ids({.layers = 0b10100}), (Ids{2, 4}));
    EXPECT_EQ(ids({.sensors = false}), (Ids{1, 3, 4}));
    EXPECT_EQ(ids({.ignore = 1}), (Ids{2, 3, 4}));
    EXPECT_EQ(ids({.layers = 0b01110, .sensors = false, .ignore = 1}), (Ids{3}));
    EXPECT_EQ(ids({.layers = 0}), (Ids{}));
}

TEST(WorldQueries, HaveResultsForEveryArgument) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    scene.bodies.push_back(sphere(2, {0, 3, 0}, 1));
    const WorldPtr world = make_world(scene);
    EXPECT_TRUE(world->ray_cast_all({0, 3, 0}, {0, 3, 0}).empty()) << "no length";
    const auto still = world->shape_cast(ball(1), {0, 4, 0}, {}, {});
    ASSERT_TRUE(still) << "overlaps, without a way";
    EXPECT_EQ(*still, (ShapeCastHit{2, 0, {0, 4, 0}, {}}));
    EXPECT_FALSE(world->shape_cast(ball(1), {0, 6, 0}, {}, {}));
    EXPECT_FALSE(world->closest_point({0, 9, 0}, -1));
    EXPECT_TRUE(world->closest_point({0, 9, 0}, Real::highest()));
    // A turn of 0 is none.
    EXPECT_EQ(world->overlap(ball(1), {0, 4, 0}, {0, 0, 0, 0}), std::vector<BodyId>{2});
    const Real huge = Real::highest();
    for (const Vec3& far : {Vec3{70000, 0, 0}, Vec3{0, -huge, 0}, Vec3{huge, huge, huge}}) {
        EXPECT_FALSE(world->ray_cast(far, {}));
        EXPECT_TRUE(world->ray_cast_all({}, far).empty());
        EXPECT_TRUE(world->overlap(ball(1), far, {}).empty());
        EXPECT_FALSE(world->closest_point(far, huge));
        EXPECT_FALSE(world->shape_cast(ball(1), far, {}, {}));
        EXPECT_FALSE(world->shape_cast(ball(1), {0, 9, 0}, {}, far));
    }
    const auto long_fall = world->shape_cast(ball(1), {9, 65000, 9}, {}, {0, -65000, 0});
    ASSERT_TRUE(long_fall);
    EXPECT_EQ(long_fall->body, 1U);
}

TEST(WorldQueries, RefuseWhatNoBodyThatMovesCouldBe) {
    const WorldPtr world = make_world(query_scene(0, 4));
    const auto refusal = [&](const ShapeDefinition& shape) {
        const Status checked = world->check_query_shape(shape);
        return checked ? std::string() : checked.error().message;
    };
    EXPECT_EQ(refusal(ball(1)), "");
    EXPECT_NE(refusal(ball(0)).find("query: shape.radius is 0.0"), std::string::npos);
    EXPECT_NE(refusal(ball(76)).find("75.0 m"), std::string::npos);
    ShapeDefinition shape;
    shape.type = ShapeType::plane;
    EXPECT_NE(refusal(shape).find("plane"), std::string::npos);
    shape.type = ShapeType::hull;
    EXPECT_EQ(refusal(shape), "");
    shape.hull = 1;
    EXPECT_NE(refusal(shape).find("there are 1 hulls"), std::string::npos);
}

TEST(WorldQueriesDeathTest, AssertTheirShape) {
    const WorldPtr world = make_world(query_scene(0, 4));
    EXPECT_DEATH((void)world->overlap(ball(0), {}, {}), "check_query_shape");
    EXPECT_DEATH((void)world->shape_cast(ball(-1), {}, {}, {}), "check_query_shape");
}

TEST(WorldShapeCast, NeverPassesAThinWall) {
    WorldDefinition scene;
    BodyDefinition wall = box(1, {0, 0, 0}, {75, 75, 0.01});
    wall.mode = BodyMode::fixed;
    scene.bodies.push_back(wall);
    scene.hulls = {wedge()};
    const WorldPtr world = make_world(scene);
    QueryDraws draws(6);
    for (int round = 0; round < 300; ++round) {
        const ShapeDefinition shape = draws.shape(0.01, 0.2);
        Vec3 from = draws.vector(30);
        from.z = draws.within(-200, -3);
        Vec3 way = draws.vector(20);
        way.z = draws.within(210, 30000);
        from = from - way * (from.z + Real(3)) / way.z; // starts three metres before
        const auto hit = world->shape_cast(shape, from, draws.orientation(), way);
        ASSERT_TRUE(hit) << round;
        EXPECT_NEAR(to_double(hit->point.z), -0.01, kError);
        EXPECT_LT(to_double(hit->normal.z), -0.99);
    }
}

} // namespace
} // namespace lockwind::test
