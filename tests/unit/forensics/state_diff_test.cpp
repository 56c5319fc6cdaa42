#include "forensics.pb.h"
#include "forensics/owned_schema.h"
#include "forensics/state_diff.h"
#include "tests/unit/forensics/fake_simulation.h"

#include <gtest/gtest.h>
#include <random>

namespace lockwind::test {
namespace {

StateDiff diff(const FakeSimulation& a, const FakeSimulation& b, std::size_t fields_max = 20) {
    Result<StateDiff> result = diff_states(kFakeSections, a.saved(), b.saved(), fields_max);
    EXPECT_TRUE(result.ok());
    return std::move(result).value();
}

TEST(StateDiff, FindsNothingBetweenEqualStates) {
    const FakeSimulation a;
    const FakeSimulation b;
    EXPECT_EQ(diff(a, b).count, 0U);
}

TEST(StateDiff, NamesExactlyThePlantedFieldForEveryField) {
    const FakeSimulation good;
    for (std::uint32_t section = 1; section < kFakeSections.size(); ++section) {
        const SectionDescriptor& described = kFakeSections[section];
        for (const FieldDescriptor& field : described.fields) {
            for (std::uint32_t component = 0; component < field.components; ++component) {
                if (field.name == "id" || field.name == "row_a" || field.name == "row_b") {
                    continue; // what names a row: see the tests of missing rows
                }
                FakeSimulation bad;
                const std::uint32_t row =
                    good.saved().empty() ? 0 : bad.arena().row_count(section) - 1;
                std::byte* bytes =
                    bad.arena().live_bytes(section).data() + row * described.stride_bytes;
                const std::uint64_t raw = read_component(field, component, bytes);
                write_component(field, component, bytes, raw + 1);
                const StateDiff found = diff(good, bad);
                ASSERT_EQ(found.count, 1U) << described.name << "." << field.name;
                EXPECT_EQ(found.fields[0].section, described.name);
                EXPECT_EQ(found.fields[0].field, component_name(field, component));
                EXPECT_EQ(found.fields[0].unit, field.unit);
                EXPECT_EQ(found.fields[0].a.raw, format_raw(field, raw));
                EXPECT_EQ(found.fields[0].b.raw, format_raw(field, raw + 1));
                EXPECT_EQ(found.fields[0].b.decimal, format_decimal(field, raw + 1));
            }
        }
    }
}

TEST(StateDiff, NamesTheEntityOfEveryKindOfRow) {
    const FakeSimulation good;
    FakeSimulation bad;
    bad.row<Globals>(globals, 0).seed += 1;
    bad.row<FakeBody>(body, 4).group += 1;
    bad.row<FakeProperties>(properties, 5).friction += 1;
    bad.row<FakePair>(pair, 0).manifold = 0;
    bad.row<FakePair>(pair, 1).manifold = 1;
    const StateDiff found = diff(good, bad);
    ASSERT_EQ(found.count, 5U);
    EXPECT_EQ(found.fields[0].entity, "0");     // a row of no entity: its place
    EXPECT_EQ(found.fields[1].entity, "22");    // row 4's id
    EXPECT_EQ(found.fields[2].entity, "25");    // body_properties: the body of the same row
    EXPECT_EQ(found.fields[3].entity, "10-13"); // rows 0 and 1
    EXPECT_EQ(found.fields[4].entity, "13-22"); // rows 1 and 4
}

TEST(StateDiff, NamesAManifoldByThePairThatHoldsIt) {
    const FakeSimulation good;
    FakeSimulation bad;
    bad.row<FakeManifold>(manifold, 1).impulse[1] = 7;
    const StateDiff found = diff(good, bad);
    ASSERT_EQ(found.count, 1U);
    EXPECT_EQ(found.fields[0].entity, "10-13");
    EXPECT_EQ(found.fields[0].field, "impulse[1]");
}

TEST(StateDiff, TellsAnotherNumberOfRowsAndMatchesTheRestByEntity) {
    FakeSimulation a;
    FakeSimulation b;
    // b lacks the body of row 2; all rows behind it stand one lower.
    for (std::uint32_t row = 2; row + 1 < FakeSimulation::kBodies; ++row) {
        b.row<FakeBody>(body, row) = a.row<FakeBody>(body, row + 1);
    }
    b.arena().set_row_count(body, FakeSimulation::kBodies - 1);
    b.row<FakePair>(pair, 1).row_b = 3;
    const StateDiff found = diff(a, b);
    ASSERT_GE(found.count, 2U);
    EXPECT_EQ(found.fields[0].section, "body");
    EXPECT_EQ(found.fields[0].field, "row_count");
    EXPECT_EQ(found.fields[0].a.raw, "40");
    EXPECT_EQ(found.fields[0].b.raw, "39");
    EXPECT_EQ(found.fields[1].entity, "16");
    EXPECT_EQ(found.fields[1].field, "id");
    EXPECT_EQ(found.fields[1].a.raw, "16");
    EXPECT_EQ(found.fields[1].b.raw, "");
    // The pair is still 13-22: only where its body stands differs.
    ASSERT_EQ(found.count, 3U);
    EXPECT_EQ(found.fields[2].entity, "13-22");
    EXPECT_EQ(found.fields[2].field, "row_b");
}

TEST(StateDiff, TellsRowsThatOnlyChangedPlaces) {
    const FakeSimulation a;
    FakeSimulation b;
    std::swap(b.row<FakeBody>(body, 0), b.row<FakeBody>(body, 1));
    EXPECT_GT(diff(a, b).count, 0U);
}

TEST(StateDiff, KeepsTheFirstFieldsAndCountsAll) {
    const FakeSimulation a;
    FakeSimulation b;
    for (std::uint32_t row = 0; row < FakeSimulation::kBodies; ++row) {
        b.row<FakeBody>(body, row).group += 1;
    }
    const StateDiff found = diff(a, b, 7);
    EXPECT_EQ(found.count, FakeSimulation::kBodies);
    ASSERT_EQ(found.fields.size(), 7U);
    EXPECT_EQ(found.fields[6].entity, "28");
}

TEST(StateDiff, RefusesBytesThatAreNoState) {
    const FakeSimulation good;
    const std::vector<std::byte> state = good.saved();
    EXPECT_FALSE(diff_states(kFakeSections, state, {}).ok());
    EXPECT_FALSE(diff_states(kFakeSections, std::span(state).first(100), state).ok());
}

TEST(StateDiff, SurvivesAnyBytes) {
    const FakeSimulation good;
    const std::vector<std::byte> state = good.saved();
    std::mt19937 random(1);
    for (int round = 0; round < 2000; ++round) {
        std::vector<std::byte> changed = state;
        for (std::size_t change = 0; change <= random() % 8; ++change) {
            changed[random() % changed.size()] = static_cast<std::byte>(random() & 0xffU);
        }
        const Result<StateDiff> result = diff_states(kFakeSections, state, changed);
        if (result && changed != state) {
            EXPECT_GT(result.value().count, 0U) << "round " << round;
        }
    }
}

TEST(StateHash, OfBytesIsTheSimulationsOwn) {
    FakeSimulation simulation;
    for (Tick tick = 1; tick < 5; ++tick) {
        ASSERT_TRUE(simulation.advance(fake_inputs(tick)).ok());
        const Result<std::uint64_t> hash = hash_state(kFakeSections, simulation.saved());
        ASSERT_TRUE(hash.ok());
        EXPECT_EQ(hash.value(), simulation.state_hash());
    }
}

TEST(OwnedSchemaTest, ReadsBackAsItself) {
    forensics_format::Schema message;
    const OwnedSchema schema{StateSchema(kFakeSections)};
    schema.encode(message);
    const Result<OwnedSchema> read = OwnedSchema::decode(message);
    ASSERT_TRUE(read.ok());
    EXPECT_TRUE(read.value() == schema);
    EXPECT_EQ(read.value().view()[2].fields[1].components_as, "xyz");
}

TEST(OwnedSchemaTest, RefusesSchemasThatBreakARule) {
    const auto refused = [](const auto& change) {
        forensics_format::Schema message;
        OwnedSchema{StateSchema(kFakeSections)}.encode(message);
        change(message);
        return !OwnedSchema::decode(message).ok();
    };
    using forensics_format::Schema;
    EXPECT_FALSE(refused([](Schema&) {}));
    EXPECT_TRUE(refused([](Schema& schema) { schema.clear_sections(); }));
    EXPECT_TRUE(refused([](Schema& schema) { schema.mutable_sections(2)->set_stride_bytes(0); }));
    EXPECT_TRUE(refused([](Schema& schema) { schema.mutable_sections(2)->set_stride_bytes(44); }));
    EXPECT_TRUE(refused([](Schema& schema) {
        schema.mutable_sections(2)->mutable_fields(1)->set_fraction_bits(60);
    }));
    EXPECT_TRUE(refused([](Schema& schema) {
        schema.mutable_sections(2)->mutable_fields(1)->set_components(0xffffffffU);
    }));
    EXPECT_TRUE(refused([](Schema& schema) {
        schema.mutable_sections(2)->mutable_fields(0)->set_offset_bytes(8);
    }));
    EXPECT_TRUE(refused(
        [](Schema& schema) { schema.mutable_sections(2)->mutable_fields(0)->set_type(9); }));
    EXPECT_TRUE(refused([](Schema& schema) { schema.mutable_sections(2)->set_name("globals"); }));
    EXPECT_TRUE(refused(
        [](Schema& schema) { schema.mutable_sections(2)->set_entity_field("no such field"); }));
    EXPECT_TRUE(refused(
        [](Schema& schema) { schema.mutable_sections(2)->set_owner(std::string(1000, 'x')); }));
}

} // namespace
} // namespace lockwind::test
