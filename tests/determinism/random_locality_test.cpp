#include "dynamics/body.h"
#include "dynamics/contact.h"
#include "tests/support/code_scenes.h"
#include "world/state.h"

#include <cstdlib>
#include <cstring>
#include <gtest/gtest.h>
#include <iostream>

// Two groups half a kilometre apart, in one world and each in its own: the same bits, whatever is
// shot, created, destroyed, put to sleep and woken in either.
namespace lockwind::test {
namespace {

constexpr Tick kTicks = 300;

/// One group: its floor's middle, its ids, and its own draws.
struct Group {
    std::uint64_t seed;
    BodyId first_id;
    Real offset; // m along x

    std::uint32_t draw(std::uint64_t counter, std::uint32_t bound) const {
        return random_below(seed, first_id, counter, bound);
    }
    BodyDefinition body(BodyId id, std::uint64_t counter, const Vec3& place) const {
        const Real size = Real(0.2) + random_unit(seed, id, counter) * Real(0.3);
        switch (draw(counter, 3)) {
        case 0:
            return box(id, place, {size, Real(0.3), size});
        case 1:
            return sphere(id, place, size);
        default:
            return capsule(id, place, Real(0.25), size);
        }
    }
};

/// A floor, stacks that come to rest, bodies that fall onto each other, a pod and a paddle that
/// sweeps.
void add_group(WorldDefinition& scene, const Group& group) {
    const Real x = group.offset;
    BodyDefinition floor = box(group.first_id, {x, -0.5, 0}, {20, 0.5, 20});
    floor.mode = BodyMode::fixed;
    scene.bodies.push_back(floor);
    BodyId id = group.first_id + 1;
    for (std::uint32_t stack = 0; stack < 1 + group.draw(0, 3); ++stack) {
        for (std::uint32_t level = 0; level < 1 + group.draw(1 + stack, 4); ++level) {
            const Vec3 place{x + Real(stack) * Real(2) - Real(8), Real(level) + Real(0.5), Real(8)};
            scene.bodies.push_back(box(id++, place, {0.5, 0.5, 0.5}));
        }
    }
    const std::uint32_t falling = 4 + group.draw(10, 8);
    for (std::uint32_t index = 0; index < falling; ++index) {
        const Vec3 place{x + Real(index % 2) * Real(0.7),
                         Real(index / 2) * Real(1.1) + Real(0.8),
                         random_symmetric(group.seed, id, 1) * Real(0.3)};
        scene.bodies.push_back(group.body(id++, 20 + index, place));
        BodyDefinition& body = scene.bodies.back();
        body.restitution = group.draw(40 + index, 4) == 0 ? Real(0.6) : Real(0);
        body.collision_mode = static_cast<CollisionMode>(group.draw(70 + index, 4));
        body.substeps = group.draw(90 + index, 6) == 0 ? group.draw(110 + index, 17) : 0;
        body.linear_velocity.z = group.draw(100 + index, 4) == 0 ? Real(70) : Real(0);
    }
    BodyDefinition paddle = box(group.first_id + 60, {x - Real(14), 0.5, 8}, {0.3, 0.3, 3});
    paddle.mode = BodyMode::kinematic;
    paddle.linear_velocity.x = Real(1) + Real(group.draw(60, 3));
    scene.bodies.push_back(paddle);
    add_pod(scene, group.first_id + 70, {x, 0.3, -6});
}

/// What the host does before the tick, to this group only.
void play_script(World& world, const Group& group, Tick tick) {
    const std::uint64_t draw = random_u64(group.seed ^ 0x5eedU, group.first_id, tick);
    const BodyId id = group.first_id + 1 + (draw >> 8U) % 12;
    switch (draw % 40) {
    case 0: {
        const Vec3 place{group.offset - Real(8) + Real(tick % 5), 6, Real(8)};
        const BodyDefinition body = group.body(group.first_id + 1000 + tick, tick, place);
        ASSERT_TRUE(world.create_body(body).ok());
        break;
    }
    case 1:
        world.destroy_body(id);
        break;
    case 2:
        if (const auto body = world.body(id)) {
            world.apply_impulse(id, {body->mass, body->mass, 0}, body->position);
        }
        break;
    default:
        break;
    }
}

template <class Row>
std::span<const Row> rows_of(World& world, std::uint32_t section) {
    const auto bytes = world.section_bytes(section);
    return {reinterpret_cast<const Row*>(bytes.data()), world.row_count(section)};
}

struct Tables {
    explicit Tables(World& world)
        : motion(rows_of<BodyMotion>(world, section::kBody)),
          kinds(rows_of<BodyProperties>(world, section::kBodyKind)),
          lives(rows_of<BodyLife>(world, section::kBodyLife)),
          sleep(rows_of<BodySleep>(world, section::kBodySleep)),
          pairs(rows_of<Pair>(world, section::kPair)),
          manifolds(rows_of<Manifold>(world, section::kManifold)),
          impulses(rows_of<ContactImpulse>(world, section::kContactImpulse)) {}

    const BodyProperties& properties(BodyRow row) const { return kinds[lives[row].body_kind]; }

    std::span<const BodyMotion> motion;
    std::span<const BodyProperties> kinds;
    std::span<const BodyLife> lives;
    std::span<const BodySleep> sleep;
    std::span<const Pair> pairs;
    std::span<const Manifold> manifolds;
    std::span<const ContactImpulse> impulses;
};

template <class Row>
bool same_bits(const Row& a, const Row& b) {
    return std::memcmp(&a, &b, sizeof(Row)) == 0;
}

/// A pair's contact without the numbers that depend on the world's rows.
Manifold without_rows(const Tables& tables, const Pair& pair) {
    Manifold manifold{};
    if (pair.point_count != 0) {
        manifold = tables.manifolds[pair.manifold];
        manifold.row_a = 0;
        manifold.row_b = 0;
    }
    return manifold;
}

ContactImpulse impulse_of(const Tables& tables, const Pair& pair) {
    return pair.point_count != 0 ? tables.impulses[pair.manifold] : ContactImpulse{};
}

/// How many pairs of `part` are in `whole` to the bit; `twin` gives a body's row in `whole`.
std::size_t
shared_pairs(const Tables& part, const Tables& whole, const std::vector<BodyRow>& twin) {
    std::size_t shared = 0;
    std::size_t next = 0;
    for (const Pair& pair : part.pairs) {
        const auto place = std::pair(twin[pair.row_a], twin[pair.row_b]);
        while (next < whole.pairs.size() &&
               std::pair(whole.pairs[next].row_a, whole.pairs[next].row_b) < place) {
            ++next;
        }
        if (next == whole.pairs.size()) {
            break;
        }
        const Pair& other = whole.pairs[next];
        const bool same = std::pair(other.row_a, other.row_b) == place && other.axis == pair.axis &&
                          other.point_count == pair.point_count &&
                          same_bits(without_rows(part, pair), without_rows(whole, other)) &&
                          same_bits(impulse_of(part, pair), impulse_of(whole, other));
        shared += same ? 1 : 0;
    }
    return shared;
}

struct Shared {
    std::size_t bodies = 0;
    std::size_t pairs = 0;
};

/// How many bodies and contacts of `part` are in `whole`, bit for bit; both are sorted by id.
Shared shared_rows(World& part_world, World& whole_world) {
    const Tables part(part_world);
    const Tables whole(whole_world);
    Shared shared;
    std::vector<BodyRow> twin(part.motion.size());
    BodyRow other = 0;
    for (BodyRow row = 0; row < part.motion.size(); ++row) {
        while (other + 1 < whole.motion.size() && whole.motion[other].id < part.motion[row].id) {
            ++other;
        }
        twin[row] = other;
        const bool same = same_bits(part.motion[row], whole.motion[other]) &&
                          same_bits(part.properties(row), whole.properties(other)) &&
                          same_bits(part.sleep[row], whole.sleep[other]);
        EXPECT_TRUE(same) << "body " << part.motion[row].id << ", tick " << part_world.tick();
        shared.bodies += same ? 1 : 0;
    }
    shared.pairs = shared_pairs(part, whole, twin);
    return shared;
}

/// What happened, so that it is known to have happened.
struct Happened {
    std::uint64_t slept = 0;
    std::uint64_t woke = 0;
    std::uint64_t created = 0;
    std::uint64_t destroyed = 0;
    std::uint64_t contacts = 0;
    std::uint64_t simplified = 0; // bodies, summed over the ticks
    std::uint64_t frozen = 0;

    void add(const World& world) {
        for (const Event& event : world.events()) {
            slept += event.type == EventType::fell_asleep ? 1 : 0;
            woke += event.type == EventType::woke ? 1 : 0;
            created += event.type == EventType::created ? 1 : 0;
            destroyed += event.type == EventType::destroyed ? 1 : 0;
        }
        contacts += world.counts().contacts;
        for (BodyRow row = 0; row < world.body_count(); ++row) {
            const BodyLevel level = world.body_at(row).level;
            simplified += level == BodyLevel::simplified ? 1 : 0;
            frozen += level == BodyLevel::frozen ? 1 : 0;
        }
    }
};

void compare(std::uint64_t seed, Happened& happened) {
    const Group groups[] = {{2 * seed, 100'000, -250}, {2 * seed + 1, 200'000, 250}};
    WorldDefinition alone[2];
    WorldDefinition both;
    for (WorldDefinition* scene : {&alone[0], &alone[1], &both}) {
        scene->settings.seed = seed;
        scene->settings.body_capacity = 400;
        scene->settings.level_of_detail = {seed % 2 == 0, 10, 18, 2};
    }
    for (int group = 0; group < 2; ++group) {
        add_group(alone[group], groups[group]);
        add_group(both, groups[1 - group]); // slot 0 is the second group's
    }
    const WorldPtr whole = make_world(both);
    const WorldPtr part[] = {make_world(alone[0]), make_world(alone[1])};
    for (Tick tick = 1; tick <= kTicks; ++tick) {
        const std::vector<SlotInput> inputs = busy_inputs(tick, 2, seed);
        Shared shared;
        for (std::size_t group = 0; group < 2; ++group) {
            play_script(*part[group], groups[group], tick);
            play_script(*whole, groups[group], tick);
            ASSERT_TRUE(part[group]->step({&inputs[1 - group], 1}).ok());
        }
        ASSERT_TRUE(whole->step(inputs).ok());
        for (const WorldPtr& each : part) {
            const Shared of_part = shared_rows(*each, *whole);
            shared.bodies += of_part.bodies;
            shared.pairs += of_part.pairs;
        }
        ASSERT_EQ(shared.bodies, whole->body_count()) << "tick " << tick;
        ASSERT_EQ(shared.pairs, whole->counts().pairs) << "tick " << tick;
        happened.add(*whole);
    }
}

/// A quarter of the hundred, unless the long tests are asked for.
TEST(Locality, OfRandomScenesWithSleepShotsAndScripts) {
    const std::uint64_t scenes = std::getenv("LOCKWIND_LONG_TESTS") != nullptr ? 100 : 25;
    Happened all;
    for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
        Happened happened;
        compare(seed, happened);
        ASSERT_FALSE(HasFailure()) << "scene " << seed;
        EXPECT_GT(happened.slept, 0U) << "scene " << seed;
        EXPECT_GT(happened.created, 0U) << "scene " << seed;
        all.slept += happened.slept;
        all.woke += happened.woke;
        all.created += happened.created;
        all.destroyed += happened.destroyed;
        all.contacts += happened.contacts;
        all.simplified += happened.simplified;
        all.frozen += happened.frozen;
    }
    std::cout << scenes << " scenes: " << all.slept << " bodies fell asleep, " << all.woke
              << " were woken, " << all.created << " shot, " << all.destroyed << " vanished, "
              << all.contacts / (scenes * kTicks) << " contact points, "
              << all.simplified / (scenes * kTicks) << " simplified and "
              << all.frozen / (scenes * kTicks) << " frozen bodies a tick\n";
    EXPECT_GT(all.woke, 5U * scenes);
    EXPECT_GT(all.destroyed, scenes);
    EXPECT_GT(all.simplified, scenes * kTicks);
    EXPECT_GT(all.frozen, scenes * kTicks);
}

} // namespace
} // namespace lockwind::test
