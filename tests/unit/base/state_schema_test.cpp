#include "base/state_schema.h"
#include "tests/unit/base/sample_schema.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

namespace lockwind::test {
namespace {

/// The sample schema with one section's fields replaced.
class Edited {
public:
    Edited() : sections_(kSampleSchema.begin(), kSampleSchema.end()) {
        for (const SectionDescriptor& section : sections_) {
            fields_.emplace_back(section.fields.begin(), section.fields.end());
        }
        refresh();
    }
    std::vector<FieldDescriptor>& fields(std::size_t section) { return fields_[section]; }
    SectionDescriptor& section(std::size_t index) { return sections_[index]; }
    std::string refusal() {
        refresh();
        const Status status = check_schema(sections_);
        return status ? "" : status.error().message;
    }

private:
    void refresh() {
        for (std::size_t index = 0; index < sections_.size(); ++index) {
            sections_[index].fields = fields_[index];
        }
    }
    std::vector<SectionDescriptor> sections_;
    std::vector<std::vector<FieldDescriptor>> fields_;
};

TEST(StateSchema, AcceptsRowsWhoseEveryByteIsClaimedOnce) {
    EXPECT_EQ(Edited().refusal(), "");
}

TEST(StateSchema, NamesTheFieldBehindAHole) {
    Edited schema;
    schema.fields(1).erase(schema.fields(1).begin() + 2);
    EXPECT_EQ(schema.refusal(),
              "schema: sample.flags: starts at byte 36, but bytes are claimed up to 32");
}

TEST(StateSchema, RefusesAByteClaimedTwice) {
    Edited schema;
    schema.fields(1)[3].offset_bytes = 34;
    EXPECT_NE(schema.refusal(), "");
}

TEST(StateSchema, RefusesUnclaimedBytesAtTheEnd) {
    Edited schema;
    schema.fields(1).pop_back();
    EXPECT_EQ(schema.refusal(), "schema: sample: fields claim 38 bytes of a row of 40");
}

TEST(StateSchema, RefusesAComponentThatSomeCompilersWouldPad) {
    Edited schema;
    schema.fields(1) = {{"a", FieldType::u32, 1, 0, 0, "", ""},
                        {"b", FieldType::u64, 1, 4, 0, "", ""}};
    schema.section(1).stride_bytes = 12;
    schema.section(1).entity_field = "";
    EXPECT_EQ(schema.refusal(), "schema: sample.b: not at a multiple of its size");
}

TEST(StateSchema, RefusesDoubleNames) {
    Edited schema;
    schema.fields(1)[4].name = "flags";
    EXPECT_EQ(schema.refusal(), "schema: sample.flags: the name is taken");
    Edited other;
    other.section(2).name = "sample";
    EXPECT_EQ(other.refusal(), "schema: sample: the name is taken");
}

TEST(StateSchema, RefusesAnEntityFieldThatIsNotThere) {
    Edited schema;
    schema.section(1).entity_field = "key";
    EXPECT_NE(schema.refusal().find("no field \"key\""), std::string::npos);
}

TEST(StateSchema, RefusesCountsThatDoNotFollowTheSections) {
    Edited schema;
    schema.fields(0)[1].name = "tale";
    EXPECT_NE(schema.refusal().find("one u32 for each state section"), std::string::npos);
    Edited order;
    order.section(1).derived = true;
    EXPECT_NE(order.refusal(), "");
}

TEST(StateSchema, RefusesLettersThatDoNotMatchTheComponents) {
    Edited schema;
    schema.fields(1)[1].components_as = "xy";
    EXPECT_NE(schema.refusal().find("sample.position"), std::string::npos);
}

TEST(StateSchema, DescribesEverySectionAndField) {
    EXPECT_EQ(describe(kSampleSchema),
              "state counts owner base stride 12\n"
              "  0 u32 counts\n"
              "  4 u32 sample\n"
              "  8 u32 tail\n"
              "state sample owner test stride 40 entity id\n"
              "  0 u64 id\n"
              "  8 i64[3] position / 2^32 m (xyz)\n"
              "  32 i32 speed / 2^20 m/s\n"
              "  36 u16 flags\n"
              "  38 u8[2] pair\n"
              "state tail owner test stride 4\n"
              "  0 u32 value\n"
              "derived cache owner test stride 4\n"
              "  0 u32 value\n");
}

TEST(StateSchema, DigestChangesWithAnyFieldsType) {
    std::vector<FieldDescriptor> fields(kSampleFields.begin(), kSampleFields.end());
    std::vector<SectionDescriptor> sections(kSampleSchema.begin(), kSampleSchema.end());
    sections[1].fields = fields;
    EXPECT_EQ(schema_digest(sections), schema_digest(kSampleSchema));
    fields[2].fraction_bits = 21;
    EXPECT_NE(schema_digest(sections), schema_digest(kSampleSchema));
}

} // namespace
} // namespace lockwind::test
