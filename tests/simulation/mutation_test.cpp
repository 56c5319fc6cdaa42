#include "base/canonical.h"
#include "base/field_access.h"
#include "base/state_schema.h"
#include "forensics/state_diff.h"
#include "scene/scene.h"
#include "session/sync_test.h"
#include "tests/support/code_scenes.h"
#include "world/state.h"

#include "lockwind/world_simulation.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <iostream>
#include <string>

// What if a field were not hashed, not compared, not saved? Every field of a live arena is tried.
namespace lockwind::test {
namespace {

constexpr std::uint32_t kPlayers = 4;
/// Long enough that pods have shot, balls have come and gone, and the pile has settled.
constexpr int kLiveTicks = 200;

/// With one joint of each kind above it, and bullets.
WorldDefinition arena() {
    SceneOptions options;
    options.players = kPlayers;
    const Result<WorldDefinition> scene = load_scene("arena", options);
    EXPECT_TRUE(scene.ok());
    WorldDefinition definition = scene.value();
    add_joints(definition, 10000, {0, 30, 0});
    add_bullets(definition, 30000, {0, 20, 0});
    return definition;
}

WorldPtr live_arena() {
    WorldPtr world = make_world(arena());
    for (int tick = 0; tick < kLiveTicks; ++tick) {
        step_busy(*world);
    }
    return world;
}

std::vector<std::byte> saved(const World& world) {
    std::vector<std::byte> bytes;
    world.save(bytes);
    return bytes;
}

bool is_padding(const FieldDescriptor& field) {
    return field.name == "zero";
}

/// Calls visit(place) for every component of every field, the row counts aside.
template <class Visit>
std::uint32_t for_each_component(Visit visit) {
    std::uint32_t visited = 0;
    for (std::uint32_t section = 1; section < section::kStateCount; ++section) {
        const std::span<const FieldDescriptor> fields = World::schema()[section].fields;
        for (std::uint32_t field = 0; field < fields.size(); ++field) {
            for (std::uint32_t component = 0; component < fields[field].components; ++component) {
                visit(FieldPlace{section, field, component});
                ++visited;
            }
        }
    }
    return visited;
}

/// Calls visit(section, field) for every field, the row counts and the padding aside.
template <class Visit>
std::uint32_t for_each_field(Visit visit) {
    std::uint32_t visited = 0;
    for (std::uint32_t section = 1; section < section::kStateCount; ++section) {
        for (const FieldDescriptor& field : World::schema()[section].fields) {
            if (!is_padding(field)) {
                visit(section, field);
                ++visited;
            }
        }
    }
    return visited;
}

TEST(Mutation, EveryFlippedFieldIsHashedAndNamedByTheDiff) {
    const WorldPtr world = live_arena();
    const std::uint64_t hash = world->state_hash();
    const std::vector<std::byte> before = saved(*world);
    std::uint32_t hashed = 0;
    std::uint32_t named = 0;
    const std::uint32_t flipped = for_each_component([&](const FieldPlace& place) {
        const SectionDescriptor& section = World::schema()[place.section];
        const FieldDescriptor& field = section.fields[place.field];
        std::byte* row = world->section_bytes(place.section).data() +
                         std::size_t{world->row_count(place.section) / 2} * section.stride_bytes;
        const std::uint64_t raw = read_component(field, place.component, row);
        write_component(field, place.component, row, raw ^ 1U);
        hashed += world->state_hash() != hash ? 1 : 0;
        const Result<StateDiff> diff = diff_states(World::schema(), before, saved(*world));
        ASSERT_TRUE(diff.ok()) << diff.error().message;
        const bool is_named =
            !diff.value().fields.empty() && diff.value().fields[0].section == section.name &&
            diff.value().fields[0].field == component_name(field, place.component);
        EXPECT_TRUE(is_named) << section.name << "." << component_name(field, place.component)
                              << " is told as "
                              << (diff.value().fields.empty()
                                      ? "nothing"
                                      : diff.value().fields[0].section + "." +
                                            diff.value().fields[0].field);
        named += is_named ? 1 : 0;
        write_component(field, place.component, row, raw);
    });
    EXPECT_EQ(world->state_hash(), hash);
    std::cout << "flipped " << flipped << " components: " << hashed << " hashed, " << named
              << " named by the diff\n";
    EXPECT_GT(flipped, 100U);
    EXPECT_EQ(hashed, flipped);
    EXPECT_EQ(named, flipped);
}

TEST(Mutation, ARowMoreOrLessIsHashedAndNamedByTheDiff) {
    const WorldPtr world = live_arena();
    const std::vector<std::byte> before = saved(*world);
    const Result<std::uint64_t> hash = hash_state(World::schema(), before);
    ASSERT_EQ(hash.value(), world->state_hash());
    std::size_t end = 0;
    for (std::uint32_t section = 0; section < section::kStateCount; ++section) {
        const SectionDescriptor& described = World::schema()[section];
        end += std::size_t{world->row_count(section)} * described.stride_bytes;
        if (section == section::kArena) {
            continue; // holds the counts themselves
        }
        std::vector<std::byte> shorter = before;
        const auto last = shorter.begin() + static_cast<std::ptrdiff_t>(end);
        shorter.erase(last - described.stride_bytes, last);
        const FieldDescriptor& count = World::schema()[section::kArena].fields[section];
        shorter[count.offset_bytes] =
            static_cast<std::byte>(std::to_integer<std::uint8_t>(shorter[count.offset_bytes]) - 1U);
        if (world->row_count(section) % 256 == 0) {
            continue; // the borrow; the next section is as good
        }
        const Result<std::uint64_t> other = hash_state(World::schema(), shorter);
        ASSERT_TRUE(other.ok()) << other.error().message;
        EXPECT_NE(other.value(), hash.value()) << described.name;
        const Result<StateDiff> diff = diff_states(World::schema(), before, shorter);
        ASSERT_TRUE(diff.ok()) << diff.error().message;
        ASSERT_FALSE(diff.value().fields.empty());
        const bool is_told = std::ranges::any_of(diff.value().fields, [&](const FieldDiff& field) {
            return field.section == described.name && field.field == "row_count";
        });
        EXPECT_TRUE(is_told) << described.name;
        // A count that does not fit the rows is no state at all.
        std::vector<std::byte> wrong = before;
        wrong[count.offset_bytes] ^= std::byte{1};
        EXPECT_FALSE(diff_states(World::schema(), before, wrong).ok()) << described.name;
        EXPECT_FALSE(world->load(wrong).ok()) << described.name;
    }
}

/// A world whose load() forgets one field: another value stays in every row.
class Forgetful final : public Simulation {
public:
    enum class Keeps : std::uint8_t {
        present = 0, // what the field held before the load, row by row
        other = 1,   // anything else: memory that was never written
    };

    Forgetful(const WorldDefinition& definition,
              std::uint32_t section,
              const FieldDescriptor& field,
              Keeps keeps)
        : inner_(WorldSimulation::create(definition).value()), section_(section), field_(field),
          keeps_(keeps) {}

    std::uint32_t slot_count() const override { return inner_->slot_count(); }
    std::uint32_t input_size_bytes() const override { return inner_->input_size_bytes(); }
    Tick tick() const override { return inner_->tick(); }
    Status advance(std::span<const SlotInput> inputs) override { return inner_->advance(inputs); }
    std::uint64_t state_hash() const override { return inner_->state_hash(); }
    HashTree hash_tree() const override { return inner_->hash_tree(); }
    void save(std::vector<std::byte>& out) const override { inner_->save(out); }
    StateSchema schema() const override { return inner_->schema(); }
    std::span<const std::string_view> phases() const override { return inner_->phases(); }
    void observe(PhaseObserver* observer) override { inner_->observe(observer); }
    bool corrupt(std::string_view field) override { return inner_->corrupt(field); }

    Status load(std::span<const std::byte> bytes) override {
        const World& world = inner_->world();
        const std::vector<std::byte> present = saved(world);
        std::vector<std::byte> mixed(bytes.begin(), bytes.end());
        const std::span<const std::byte> from =
            split_canonical(schema(), present).value()[section_];
        const std::span<const std::byte> to = split_canonical(schema(), mixed).value()[section_];
        const std::uint32_t stride = schema()[section_].stride_bytes;
        const std::size_t size = component_size_bytes(field_.type) * field_.components;
        for (std::size_t at = field_.offset_bytes; at < to.size(); at += stride) {
            std::byte* value = mixed.data() + (to.data() - mixed.data()) + at;
            if (keeps_ == Keeps::other) {
                value[0] ^= std::byte{1};
                ++differed;
            } else if (at < from.size()) {
                differed += std::memcmp(value, from.data() + at, size) != 0 ? 1 : 0;
                std::memcpy(value, from.data() + at, size);
            }
        }
        return inner_->load(mixed);
    }

    WorldSimulation& inner() { return *inner_; }
    std::uint64_t differed = 0; // rows in which the loaded field is not the one that was saved

private:
    std::unique_ptr<WorldSimulation> inner_;
    std::uint32_t section_;
    FieldDescriptor field_;
    Keeps keeps_;
};

/// Whether a sync test from `start` on finds what the simulation's load() forgets.
bool sync_test_fails(Forgetful& simulation, std::span<const std::byte> start, int ticks) {
    EXPECT_TRUE(simulation.inner().load(start).ok());
    SyncTestSession session(simulation, 4);
    for (int tick = 0; tick < ticks; ++tick) {
        const auto result =
            session.advance(busy_inputs(simulation.tick() + 1, simulation.slot_count()));
        if (!result.ok() || result.value().has_value()) {
            return true; // not even a state, or another one
        }
    }
    return false;
}

TEST(Mutation, TheSyncTestFindsEveryFieldThatLoadForgets) {
    const WorldDefinition definition = arena();
    const std::vector<std::byte> start = saved(*live_arena());
    std::uint32_t found = 0;
    const std::uint32_t fields =
        for_each_field([&](std::uint32_t section, const FieldDescriptor& field) {
            Forgetful simulation(definition, section, field, Forgetful::Keeps::other);
            const bool is_found = sync_test_fails(simulation, start, 1);
            EXPECT_TRUE(is_found) << World::schema()[section].name << "." << field.name;
            EXPECT_GT(simulation.differed, 0U);
            found += is_found ? 1 : 0;
        });
    std::cout << "forgot " << fields << " fields, another value in their place: " << found
              << " found by the sync test\n";
    EXPECT_EQ(found, fields);
}

TEST(Mutation, TheSyncTestFindsEveryFieldThatLoadLeavesAsItIs) {
    const WorldDefinition definition = arena();
    const std::vector<std::byte> start = saved(*live_arena());
    std::uint32_t found = 0;
    std::uint32_t constant = 0; // equal in every state of the run: nothing to forget
    const std::uint32_t fields =
        for_each_field([&](std::uint32_t section, const FieldDescriptor& field) {
            Forgetful simulation(definition, section, field, Forgetful::Keeps::present);
            const bool is_found = sync_test_fails(simulation, start, 40);
            EXPECT_EQ(is_found, simulation.differed > 0)
                << World::schema()[section].name << "." << field.name;
            found += is_found ? 1 : 0;
            constant += simulation.differed == 0 ? 1 : 0;
        });
    std::cout << "left " << fields << " fields as they were: " << found
              << " found by the sync test, " << constant << " equal in every state\n";
    EXPECT_EQ(found + constant, fields);
    EXPECT_GT(found, fields / 3); // what a joint is made of never changes
}

TEST(Mutation, EveryByteIsClaimedByOneFieldOrIsZero) {
    const Status status = check_schema(World::schema());
    ASSERT_TRUE(status.ok()) << status.error().message;
    const WorldPtr world = live_arena();
    std::size_t claimed = 0;
    std::size_t padding = 0;
    for (std::uint32_t section = 0; section < section::kStateCount; ++section) {
        const SectionDescriptor& described = World::schema()[section];
        const std::span<const std::byte> rows = world->section_bytes(section);
        for (const FieldDescriptor& field : described.fields) {
            const std::size_t size = component_size_bytes(field.type) * field.components;
            for (std::size_t at = field.offset_bytes; at < rows.size();
                 at += described.stride_bytes) {
                if (!is_padding(field)) {
                    claimed += size;
                    continue;
                }
                padding += size;
                for (const std::byte byte : rows.subspan(at, size)) {
                    ASSERT_EQ(byte, std::byte{0}) << described.name << " at " << at;
                }
            }
        }
    }
    const std::size_t total = saved(*world).size();
    std::cout << total << " bytes: " << claimed << " claimed by one field each, " << padding
              << " zeroed padding\n";
    EXPECT_EQ(claimed + padding, total);
    EXPECT_GT(padding, 0U);
}

TEST(Mutation, DroppingDerivedDataChangesNoBit) {
    const WorldPtr straight = make_world(arena());
    const WorldPtr dropped = make_world(arena());
    int drops = 0;
    for (int tick = 0; tick < 300; ++tick) {
        if (random_below(23, 1, static_cast<std::uint64_t>(tick), 4) == 0) {
            dropped->drop_derived();
            ++drops;
        }
        step_busy(*straight);
        step_busy(*dropped);
        ASSERT_EQ(dropped->state_hash(), straight->state_hash()) << "tick " << tick;
    }
    std::cout << "dropped derived data " << drops << " times in 300 ticks\n";
    EXPECT_GT(drops, 30);
}

} // namespace
} // namespace lockwind::test
