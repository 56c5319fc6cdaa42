#include "base/field_access.h"
#include "tests/unit/base/sample_schema.h"

#include <cstring>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

constexpr const FieldDescriptor& kId = kSampleFields[0];
constexpr const FieldDescriptor& kPosition = kSampleFields[1];
constexpr const FieldDescriptor& kSpeed = kSampleFields[2];
constexpr const FieldDescriptor& kFlags = kSampleFields[3];

const std::byte* bytes_of(const Sample& sample) {
    return reinterpret_cast<const std::byte*>(&sample);
}

TEST(FieldAccess, ReadsComponentsSignExtended) {
    const Sample sample{0xffffffffffffffffU, {1, -2, 3}, -5, 0xfffe, {7, 255}};
    EXPECT_EQ(read_component(kId, 0, bytes_of(sample)), 0xffffffffffffffffU);
    EXPECT_EQ(read_component(kPosition, 1, bytes_of(sample)), static_cast<std::uint64_t>(-2));
    EXPECT_EQ(read_component(kSpeed, 0, bytes_of(sample)), static_cast<std::uint64_t>(-5));
    EXPECT_EQ(read_component(kFlags, 0, bytes_of(sample)), 0xfffeU);
    EXPECT_EQ(read_component(kSampleFields[4], 1, bytes_of(sample)), 255U);
}

TEST(FieldAccess, WritesOneComponentAndNoOtherByte) {
    for (const FieldDescriptor& field : kSampleFields) {
        for (std::uint32_t component = 0; component < field.components; ++component) {
            Sample sample;
            std::memset(&sample, 0xa5, sizeof(sample));
            write_component(field, component, reinterpret_cast<std::byte*>(&sample), 0x42);
            EXPECT_EQ(read_component(field, component, bytes_of(sample)), 0x42U);
            Sample untouched;
            std::memset(&untouched, 0xa5, sizeof(untouched));
            write_component(field,
                            component,
                            reinterpret_cast<std::byte*>(&sample),
                            read_component(field, component, bytes_of(untouched)));
            EXPECT_EQ(std::memcmp(&sample, &untouched, sizeof(sample)), 0) << field.name;
        }
    }
}

TEST(FieldAccess, FormatsRawValuesByTheirSign) {
    EXPECT_EQ(format_raw(kId, 0xffffffffffffffffU), "18446744073709551615");
    EXPECT_EQ(format_raw(kPosition, 0xffffffffffffffffU), "-1");
    EXPECT_EQ(format_raw(kPosition, std::uint64_t{1} << 63U), "-9223372036854775808");
    EXPECT_EQ(format_raw(kSpeed, 12), "12");
}

TEST(FieldAccess, FormatsExactDecimals) {
    const auto raw = [](std::int64_t value) { return static_cast<std::uint64_t>(value); };
    EXPECT_EQ(format_decimal(kPosition, 0), "0");
    EXPECT_EQ(format_decimal(kPosition, std::uint64_t{1} << 32U), "1");
    EXPECT_EQ(format_decimal(kPosition, std::uint64_t{3} << 31U), "1.5");
    EXPECT_EQ(format_decimal(kPosition, 1), "0.00000000023283064365386962890625");
    EXPECT_EQ(format_decimal(kPosition, raw(-1)), "-0.00000000023283064365386962890625");
    EXPECT_EQ(format_decimal(kPosition, std::uint64_t{1} << 63U), "-2147483648");
    EXPECT_EQ(format_decimal(kPosition, (std::uint64_t{1} << 63U) - 1),
              "2147483647.99999999976716935634613037109375");
    EXPECT_EQ(format_decimal(kSpeed, raw(-12884902)), "-12.2880001068115234375");
    EXPECT_EQ(format_decimal(kFlags, 77), "77");
}

TEST(FieldAccess, NamesComponents) {
    EXPECT_EQ(component_name(kId, 0), "id");
    EXPECT_EQ(component_name(kPosition, 2), "position.z");
    EXPECT_EQ(component_name(kSampleFields[4], 1), "pair[1]");
}

TEST(FieldAccess, FindsFieldsByPath) {
    const auto whole = find_field(kSampleSchema, "sample.speed");
    ASSERT_TRUE(whole.has_value());
    EXPECT_EQ(whole->section, 1U);
    EXPECT_EQ(whole->field, 2U);
    EXPECT_EQ(whole->component, 0U);
    EXPECT_EQ(find_field(kSampleSchema, "sample.position.y")->component, 1U);
    EXPECT_EQ(find_field(kSampleSchema, "sample.position[2]")->component, 2U);
    EXPECT_EQ(find_field(kSampleSchema, "sample.pair[1]")->component, 1U);
}

TEST(FieldAccess, FindsEveryNameItGives) {
    for (std::uint32_t section = 0; section < kSampleSchema.size(); ++section) {
        const SectionDescriptor& descriptor = kSampleSchema[section];
        for (std::uint32_t field = 0; field < descriptor.fields.size(); ++field) {
            for (std::uint32_t c = 0; c < descriptor.fields[field].components; ++c) {
                const auto place = find_field(kSampleSchema,
                                              std::string(descriptor.name) + "." +
                                                  component_name(descriptor.fields[field], c));
                ASSERT_EQ(place.has_value(), !descriptor.derived);
                if (descriptor.derived) {
                    continue;
                }
                EXPECT_EQ(place->section, section);
                EXPECT_EQ(place->field, field);
                EXPECT_EQ(place->component, c);
            }
        }
    }
}

TEST(FieldAccess, FindsNothingUnderAWrongPath) {
    for (const char* path : {"",
                             "sample",
                             "sample.",
                             "sample.spin",
                             "simple.speed",
                             "sample.position.w",
                             "sample.position[3]",
                             "sample.position[-1]",
                             "sample.position[",
                             "sample.position[]",
                             "sample.position[1",
                             "sample.position[99999999999]",
                             "sample.speedy",
                             ".speed",
                             "sample.position.xy"}) {
        EXPECT_FALSE(find_field(kSampleSchema, path).has_value()) << path;
    }
}

TEST(FieldAccess, NamesAnEntityByItsFieldOrItsRow) {
    const Sample sample{99, {}, 0, 0, {}};
    EXPECT_EQ(entity_of_row(kSampleSchema[1], 4, bytes_of(sample)), 99U);
    EXPECT_EQ(entity_of_row(kSampleSchema[2], 4, bytes_of(sample)), 4U);
}

} // namespace
} // namespace lockwind::test
