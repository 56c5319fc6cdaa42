#include "base/canonical.h"
#include "base/field_access.h"
#include "dynamics/contact.h"
#include "tests/support/code_scenes.h"
#include "world/state.h"

#include "lockwind/hash_tree.h"

#include <cstring>
#include <functional>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

/// A world in full swing, with a joint of each kind.
WorldPtr busy_world(int ticks = 100) {
    WorldPtr world = make_world(scene_of_all(40, 2));
    for (int tick = 0; tick < ticks; ++tick) {
        step_busy(*world);
    }
    return world;
}

template <class Row>
Row* rows(World& world, std::uint32_t section) {
    return reinterpret_cast<Row*>(world.section_bytes(section).data());
}

TEST(Snapshot, RestoringItsOwnGoesOnLikeLoadingIt) {
    const WorldPtr world = make_world(scene_of_all(40, 2));
    const WorldPtr loaded = make_world(scene_of_all(40, 2));
    for (int tick = 0; tick < 60; ++tick) {
        step_busy(*world);
    }
    std::vector<std::byte> bytes;
    world->save(bytes);
    KeptState kept;
    world->keep(kept);
    ASSERT_TRUE(loaded->load(bytes).ok());
    for (int tick = 0; tick < 100; ++tick) {
        step_busy(*world); // bodies come and go meanwhile
    }
    world->restore(kept);
    EXPECT_TRUE(world->events().empty());
    for (int tick = 0; tick < 300; ++tick) { // beyond the balls' lifetime
        step_busy(*world);
        step_busy(*loaded);
        ASSERT_EQ(world->state_hash(), loaded->state_hash()) << tick;
    }
    EXPECT_GT(world->counts().destroyed_total, 0U);
}

TEST(Snapshot, ABallThatWasGoneGoesAgainAfterRestoring) {
    WorldDefinition scene;
    scene.bodies.push_back(ground(1));
    add_pod(scene, 2, {0, 1, 0});
    const WorldPtr world = make_world(scene);
    PlayerInput shoot;
    shoot.buttons = PlayerInput::kShoot;
    ASSERT_TRUE(world->step(inputs_of({shoot})).ok());
    ASSERT_EQ(world->body_count(), 3U);
    KeptState kept;
    world->keep(kept);
    for (int run = 0; run < 2; ++run) {
        const std::uint32_t lifetime = scene.pods[0].ball_lifetime_ticks;
        step_idle(*world, static_cast<int>(lifetime) - 1);
        EXPECT_EQ(world->body_count(), 3U) << run;
        step_idle(*world, 20);
        EXPECT_EQ(world->body_count(), 2U) << run;
        world->restore(kept);
    }
}

TEST(Snapshot, RestoresEveryBit) {
    const WorldPtr world = busy_world();
    std::vector<std::byte> bytes;
    world->save(bytes);
    const std::uint64_t hash = world->state_hash();
    for (int tick = 0; tick < 20; ++tick) {
        step_busy(*world);
    }
    EXPECT_NE(world->state_hash(), hash);
    ASSERT_TRUE(world->load(bytes).ok());
    EXPECT_EQ(world->state_hash(), hash);
    std::vector<std::byte> again;
    world->save(again);
    EXPECT_EQ(bytes, again);
    EXPECT_TRUE(world->events().empty());
}

TEST(Snapshot, TreesRootIsTheStateHash) {
    const WorldPtr world = busy_world();
    EXPECT_EQ(world->hash_tree().root, world->state_hash());
}

/// Flips a bit of one component: the root, its section and its page must change, no other section.
void expect_hashed(World& world, const HashTree& before, const FieldPlace& place) {
    const SectionDescriptor& section = World::schema()[place.section];
    const FieldDescriptor& field = section.fields[place.field];
    const std::size_t offset =
        std::size_t{world.row_count(place.section) / 2} * section.stride_bytes;
    std::byte* row = world.section_bytes(place.section).data() + offset;
    const std::uint64_t raw = read_component(field, place.component, row);
    write_component(field, place.component, row, raw ^ 1U);
    const HashTree after = world.hash_tree();
    EXPECT_NE(after.root, before.root) << section.name << "." << field.name;
    EXPECT_EQ(after.root, world.state_hash());
    for (std::uint32_t other = 0; other < before.sections.size(); ++other) {
        EXPECT_EQ(after.sections[other] == before.sections[other], other != place.section);
    }
    // A row may lie in two pages.
    const std::size_t within =
        field.offset_bytes + place.component * component_size_bytes(field.type);
    const std::size_t page = (offset + within) / kHashPageBytes;
    EXPECT_NE(after.pages[place.section][page], before.pages[place.section][page]);
    write_component(field, place.component, row, raw);
}

TEST(Snapshot, EveryFieldOfEverySectionReachesTheHashThroughItsPage) {
    const WorldPtr world = busy_world();
    const HashTree before = world->hash_tree();
    // Not the row counts: others would show rows that are not there.
    for (std::uint32_t section = 1; section < section::kStateCount; ++section) {
        const std::span<const FieldDescriptor> fields = World::schema()[section].fields;
        for (std::uint32_t field = 0; field < fields.size(); ++field) {
            for (std::uint32_t c = 0; c < fields[field].components; ++c) {
                expect_hashed(*world, before, {section, field, c});
            }
        }
    }
    EXPECT_EQ(world->state_hash(), before.root);
}

TEST(Snapshot, RefusesWhatHasAnotherNumberOfSlots) {
    const WorldPtr two = busy_world(3);
    std::vector<std::byte> bytes;
    two->save(bytes);
    const WorldPtr one = make_world(scene_of_all(40, 1));
    const Status status = one->load(bytes);
    ASSERT_FALSE(status.ok());
    EXPECT_NE(status.error().message.find("player"), std::string::npos);
}

struct Damage {
    const char* name;
    std::function<void(World&)> apply;
};

/// Puts a damaged state into a snapshot and expects it refused, and the world as it was.
void expect_refused(const std::vector<std::byte>& sound, const Damage& damage) {
    const WorldPtr source = make_world(scene_of_all(40, 2));
    ASSERT_TRUE(source->load(sound).ok());
    damage.apply(*source);
    EXPECT_FALSE(source->check().ok()) << damage.name;
    std::vector<std::byte> bytes;
    source->save(bytes);
    const WorldPtr target = make_world(scene_of_all(40, 2));
    const std::uint64_t hash = target->state_hash();
    const Status status = target->load(bytes);
    EXPECT_FALSE(status.ok()) << damage.name;
    EXPECT_EQ(target->state_hash(), hash) << damage.name;
    step_idle(*target, 2);
}

BodyMotion& body(World& world) {
    return rows<BodyMotion>(world, section::kBody)[20];
}

BodyProperties& properties(World& world) {
    const std::uint32_t kind = rows<BodyLife>(world, section::kBodyLife)[20].body_kind;
    return rows<BodyProperties>(world, section::kBodyKind)[kind];
}

Manifold& manifold(World& world) {
    Manifold* found = rows<Manifold>(world, section::kManifold);
    while (found->point_count == 0) {
        ++found;
    }
    return *found;
}

ContactImpulse& impulse(World& world) {
    const std::ptrdiff_t row = &manifold(world) - rows<Manifold>(world, section::kManifold);
    return rows<ContactImpulse>(world, section::kContactImpulse)[row];
}

Player& player(World& world) {
    return rows<Player>(world, section::kPlayer)[1];
}

TEST(Snapshot, RefusesDamagedBodies) {
    const WorldPtr world = busy_world();
    std::vector<std::byte> sound;
    world->save(sound);
    const Damage damages[] = {
        {"id 0", [](World& w) { rows<BodyMotion>(w, section::kBody)[0].id = 0; }},
        {"ids not ascending", [](World& w) { body(w).id = (&body(w))[1].id; }},
        {"position", [](World& w) { body(w).position[1] = std::int64_t{30001} << 32U; }},
        {"position", [](World& w) { body(w).position[1] = std::int64_t{-30001} * (1LL << 32U); }},
        {"orientation", [](World& w) { body(w).orientation[2] += 1 << 24U; }},
        {"orientation", [](World& w) { std::memset(body(w).orientation, 0, 16); }},
        {"velocity", [](World& w) { body(w).linear_velocity[0] = 0x7fffffff; }},
        {"spin", [](World& w) { body(w).angular_velocity[0] = -0x7fffffff - 1; }},
        {"bounds", [](World& w) { body(w).fat_bounds[4] = 0x7fffffff; }},
        {"bounds", [](World& w) { std::swap(body(w).fat_bounds[2], body(w).fat_bounds[5]); }},
        {"motion sum", [](World& w) { body(w).motion_sum[1] = -1; }},
        {"mode", [](World& w) { properties(w).mode = 3; }},
        {"mode of a dynamic body", [](World& w) { properties(w).mode = 1; }},
        {"shape", [](World& w) { properties(w).shape = 4; }},
        {"another shape", [](World& w) { properties(w).shape ^= 1; }},
        {"size", [](World& w) { properties(w).size[0] = 0; }},
        {"size", [](World& w) { properties(w).size[0] = -properties(w).size[0]; }},
        {"bounding radius", [](World& w) { properties(w).bounding_radius += 1; }},
        {"gyration radius", [](World& w) { properties(w).gyration_radius += 1; }},
        {"inverse gyration", [](World& w) { properties(w).inverse_gyration_radius = 0; }},
        {"inverse inertia", [](World& w) { properties(w).inverse_inertia[0] *= -1; }},
        {"inverse mass", [](World& w) { properties(w).inverse_mass = 0; }},
        {"inverse mass", [](World& w) { properties(w).inverse_mass = -1; }},
        {"inverse mass", [](World& w) { properties(w).inverse_mass = std::int64_t{1} << 62U; }},
        {"friction", [](World& w) { properties(w).friction = -1; }},
        {"friction", [](World& w) { properties(w).friction = 0x7fffffff; }},
        {"restitution", [](World& w) { properties(w).restitution = 0x7fffffff; }},
        {"collision mode", [](World& w) { properties(w).collision_mode = 9; }},
        {"padding", [](World& w) { properties(w).zero_end = 1; }},
        {"spawn count",
         [](World& w) { rows<BodyLife>(w, section::kBodyLife)[20].spawn_count = 0x80000000U; }},
        {"kind beyond the kinds",
         [](World& w) {
             rows<BodyLife>(w, section::kBodyLife)[20].body_kind = w.row_count(section::kBodyKind);
         }},
        {"a kind that nobody has",
         [](World& w) {
             for (BodyRow row = 0; row < w.body_count(); ++row) {
                 rows<BodyLife>(w, section::kBodyLife)[row].body_kind = 1;
             }
         }},
        {"a kind twice",
         [](World& w) {
             BodyProperties* kinds = rows<BodyProperties>(w, section::kBodyKind);
             kinds[1] = kinds[2];
         }},
        {"no kind at all", [](World& w) { properties(w) = BodyProperties{}; }},
        {"spawn count below a living ball's",
         [](World& w) {
             BodyLife* pods = rows<BodyLife>(w, section::kBodyLife);
             for (std::uint32_t row = 0; row < w.row_count(section::kBody); ++row) {
                 pods[row].spawn_count = 0;
             }
         }},
    };
    for (const Damage& damage : damages) {
        expect_refused(sound, damage);
    }
}

TEST(Snapshot, RefusesDamagedContacts) {
    const WorldPtr world = busy_world();
    std::vector<std::byte> sound;
    world->save(sound);
    const Damage damages[] = {
        {"row beyond the bodies", [](World& w) { manifold(w).row_b = w.body_count(); }},
        {"row_a >= row_b", [](World& w) { manifold(w).row_a = manifold(w).row_b; }},
        {"two that are apart", [](World& w) { manifold(w).row_b = w.body_count() - 1; }},
        {"a pair's second manifold",
         [](World& w) {
             Manifold* first = rows<Manifold>(w, section::kManifold);
             Manifold* second = first + 1;
             while (second->point_count == 0) {
                 ++second;
             }
             *second = manifold(w);
         }},
        {"bounds that drop a touching pair",
         [](World& w) {
             BodyMotion& lost = rows<BodyMotion>(w, section::kBody)[manifold(w).row_b];
             std::copy_n(std::array{1, 1, 1, 0, 0, 0}.begin(), 6, lost.fat_bounds);
         }},
        {"axis", [](World& w) { manifold(w).axis = 129; }},
        {"five points", [](World& w) { manifold(w).point_count = 5; }},
        {"points that differ", [](World& w) { --manifold(w).point_count; }},
        {"normal", [](World& w) { manifold(w).normal[1] /= 2; }},
        {"tangent", [](World& w) { std::memset(manifold(w).tangent, 0, 12); }},
        {"impulse", [](World& w) { impulse(w).normal[0] = -1; }},
        {"impulse", [](World& w) { impulse(w).normal[0] = 0x7fffffff; }},
        {"impulses together",
         [](World& w) {
             for (std::uint32_t point = 0; point < manifold(w).point_count; ++point) {
                 impulse(w).normal[point] = 961 * (1 << 20) / manifold(w).point_count;
             }
         }},
        {"arm of a point",
         [](World& w) {
             const Manifold& m = manifold(w);
             const BodyLife& life = rows<BodyLife>(w, section::kBodyLife)[m.row_b];
             const BodyProperties& b = rows<BodyProperties>(w, section::kBodyKind)[life.body_kind];
             manifold(w).anchor_a[1] = m.centre_delta[1] + b.bounding_radius * 3 / 2;
         }},
        {"a point past the count",
         [](World& w) {
             for (Manifold* one = rows<Manifold>(w, section::kManifold);; ++one) {
                 if (one->point_count == 1) {
                     one->feature[2] = 1;
                     return;
                 }
             }
         }},
        {"friction impulse", [](World& w) { impulse(w).friction[1] = 0x7fffffff; }},
        {"twist impulse", [](World& w) { impulse(w).twist = -0x7fffffff; }},
        {"impulse of a point past the count",
         [](World& w) {
             const Manifold* manifolds = rows<Manifold>(w, section::kManifold);
             std::uint32_t row = 0;
             while (manifolds[row].point_count != 1) {
                 ++row;
             }
             rows<ContactImpulse>(w, section::kContactImpulse)[row].normal[1] = 1;
         }},
        {"anchor", [](World& w) { manifold(w).anchor_a[1] = 0x7fffffff; }},
        {"orientation", [](World& w) { manifold(w).orientation_b[3] /= 2; }},
        {"centre delta", [](World& w) { manifold(w).centre_delta[2] = 0x7fffffff; }},
        {"separation", [](World& w) { manifold(w).separation[0] = -0x7fffffff; }},
        {"padding", [](World& w) { manifold(w).zero[1] = 1; }},
    };
    for (const Damage& damage : damages) {
        expect_refused(sound, damage);
    }
}

TEST(Snapshot, RefusesDamagedPlayers) {
    const WorldPtr world = busy_world();
    std::vector<std::byte> sound;
    world->save(sound);
    const Damage damages[] = {
        {"another pod", [](World& w) { player(w).body = 10; }},
        {"shooting", [](World& w) { player(w).shooting = 2; }},
        {"padding", [](World& w) { player(w).zero[4] = 1; }},
    };
    for (const Damage& damage : damages) {
        expect_refused(sound, damage);
    }
}

} // namespace
} // namespace lockwind::test
