#include "tests/unit/world/query_scene.h"

#include <algorithm>
#include <gtest/gtest.h>

// Every query must find, to the bit, what asking each body alone finds. A body alone is a world
// of which all others have been destroyed: nothing to look up there.
namespace lockwind::test {
namespace {

class Alone {
public:
    Alone(const WorldDefinition& definition, const World& world) {
        std::vector<std::byte> state;
        world.save(state);
        for (BodyRow kept = 0; kept < world.body_count(); ++kept) {
            WorldPtr alone = make_world(definition);
            EXPECT_TRUE(alone->load(state).ok());
            for (BodyRow row = 0; row < world.body_count(); ++row) {
                if (row != kept) {
                    alone->destroy_body(world.body_at(row).id);
                }
            }
            EXPECT_EQ(alone->body_count(), 1U);
            worlds_.push_back(std::move(alone));
        }
    }

    /// What each world finds, in the order of ids.
    template <class Query>
    auto all(const Query& query) const {
        std::vector<typename decltype(query(*worlds_[0]))::value_type> found;
        for (const WorldPtr& world : worlds_) {
            for (const auto& one : listed(query(*world))) {
                found.push_back(one);
            }
        }
        return found;
    }

private:
    template <class T>
    static std::vector<T> listed(const std::optional<T>& found) {
        return found ? std::vector<T>{*found} : std::vector<T>{};
    }
    template <class T>
    static std::vector<T> listed(const std::vector<T>& found) {
        return found;
    }

    std::vector<WorldPtr> worlds_;
};

/// The least by `key`; of equal ones the first.
template <class T, class Key>
std::optional<T> least(const std::vector<T>& found, Key key) {
    const auto best = std::min_element(
        found.begin(), found.end(), [&](const T& a, const T& b) { return a.*key < b.*key; });
    return best == found.end() ? std::nullopt : std::optional<T>(*best);
}

struct Found {
    int rays = 0;
    int overlaps = 0;
    int closest = 0;
    int casts = 0;
};

/// Compares `count` queries of each kind; counts those that find something.
Found expect_equal(const World& world, const Alone& alone, int count, std::uint64_t seed) {
    Found counts;
    QueryDraws draws(seed);
    for (int round = 0; round < count; ++round) {
        SCOPED_TRACE(round);
        const Vec3 from = draws.vector(6);
        const Vec3 to = draws.vector(round % 8 == 0 ? 2000 : 6);
        const ShapeDefinition shape = draws.shape(0.05, 1.5);
        const RealQuat turn = draws.orientation();
        QueryFilter filter;
        filter.layers = round % 2 == 0 ? kAllLayers : static_cast<std::uint32_t>(draws.bits());
        filter.sensors = round % 3 != 0;
        filter.ignore = 10 + draws.bits() % 40;

        const auto ray = [&](const World& in) { return in.ray_cast(from, to, filter); };
        std::vector<RayHit> hits = alone.all(ray);
        EXPECT_EQ(ray(world), least(hits, &RayHit::fraction));
        std::stable_sort(hits.begin(), hits.end(), [](const RayHit& a, const RayHit& b) {
            return a.fraction < b.fraction;
        });
        EXPECT_EQ(world.ray_cast_all(from, to, filter), hits);
        counts.rays += hits.size() > 1 ? 1 : 0; // an order to keep

        const auto overlap = [&](const World& in) { return in.overlap(shape, from, turn, filter); };
        EXPECT_EQ(overlap(world), alone.all(overlap));
        counts.overlaps += overlap(world).empty() ? 0 : 1;

        const Real reach = draws.within(0, round % 4 == 0 ? 400 : 4);
        const auto near = [&](const World& in) { return in.closest_point(to, reach, filter); };
        EXPECT_EQ(near(world), least(alone.all(near), &ClosestPoint::distance));
        counts.closest += near(world) ? 1 : 0;

        const auto cast = [&](const World& in) {
            return in.shape_cast(shape, from, turn, to - from, filter);
        };
        EXPECT_EQ(cast(world), least(alone.all(cast), &ShapeCastHit::fraction));
        counts.casts += cast(world) && cast(world)->fraction > 0 ? 1 : 0;
    }
    return counts;
}

TEST(WorldQueries, FindWhatEachBodyAloneWouldGive) {
    const WorldDefinition scene = query_scene(60, 4);
    const WorldPtr world = make_world(scene);
    for (const int ticks : {0, 1, 20}) {
        SCOPED_TRACE(ticks);
        step_idle(*world, ticks);
        const Found found = expect_equal(*world, Alone(scene, *world), 200, 100 + world->tick());
        EXPECT_GT(found.rays, 12);
        EXPECT_GT(found.overlaps, 20);
        EXPECT_GT(found.closest, 60);
        EXPECT_GT(found.casts, 30);
    }
}

TEST(WorldQueries, SeeEveryChangeOfTheBodiesAtOnce) {
    const WorldDefinition scene = query_scene(0, 50);
    const WorldPtr world = make_world(scene);
    const auto seen = [&] {
        const auto hit = world->ray_cast({0, 0, -9}, {0, 0, 9});
        return hit ? hit->body : 0;
    };
    std::vector<std::byte> empty;
    world->save(empty);
    EXPECT_EQ(seen(), 0U);
    BodyDefinition ball = sphere(9, {0, 0, 0}, 0.5);
    ball.linear_velocity = {0, 60, 0};
    ASSERT_TRUE(world->create_body(ball).ok());
    EXPECT_EQ(seen(), 9U) << "created";
    std::vector<std::byte> full;
    world->save(full);
    KeptState kept;
    world->keep(kept);
    step_idle(*world, 2);
    EXPECT_EQ(seen(), 0U) << "moved on by two metres";
    EXPECT_TRUE(world->ray_cast({0, 2, -9}, {0, 2, 9}).has_value());
    world->restore(kept);
    EXPECT_EQ(seen(), 9U) << "restored";
    ASSERT_TRUE(world->load(empty).ok());
    EXPECT_EQ(seen(), 0U) << "loaded";
    ASSERT_TRUE(world->load(full).ok());
    ASSERT_EQ(seen(), 9U);
    ASSERT_TRUE(world->destroy_body(9));
    EXPECT_EQ(seen(), 0U) << "destroyed";
}

TEST(WorldQueries, ChangeNothing) {
    const WorldDefinition scene = query_scene(30, 8);
    const WorldPtr asked = make_world(scene);
    const WorldPtr quiet = make_world(scene);
    for (int tick = 0; tick < 5; ++tick) {
        static_cast<void>(expect_equal(*asked, Alone(scene, *asked), 3, asked->tick()));
        step_idle(*asked);
        step_idle(*quiet);
        ASSERT_EQ(asked->state_hash(), quiet->state_hash());
    }
}

TEST(WorldQueries, SameBitsTenKilometresAway) {
    const Vec3 far{10000, -10000, 10000};
    const WorldPtr here = make_world(query_scene(60, 4));
    const WorldPtr there = make_world(query_scene(60, 4, far));
    QueryDraws draws(5);
    int found = 0;
    for (int round = 0; round < 200; ++round) {
        const Vec3 from = draws.vector(6);
        const Vec3 to = draws.vector(6);
        const ShapeDefinition shape = draws.shape(0.05, 1);
        const RealQuat turn = draws.orientation();
        std::vector<RayHit> rays = here->ray_cast_all(from, to);
        for (RayHit& hit : rays) {
            hit.point += far;
        }
        EXPECT_EQ(rays, there->ray_cast_all(from + far, to + far));
        EXPECT_EQ(here->overlap(shape, from, turn), there->overlap(shape, from + far, turn));
        std::optional<ClosestPoint> near = here->closest_point(from, 3);
        if (near) {
            near->point += far;
        }
        EXPECT_EQ(near, there->closest_point(from + far, 3));
        std::optional<ShapeCastHit> cast = here->shape_cast(shape, from, turn, to - from);
        if (cast) {
            ++found;
            cast->point += far;
        }
        EXPECT_EQ(cast, there->shape_cast(shape, from + far, turn, to - from));
    }
    EXPECT_GT(found, 80);
}

} // namespace
} // namespace lockwind::test
