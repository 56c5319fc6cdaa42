#include "base/canonical.h"
#include "base/field_access.h"
#include "tests/unit/base/sample_schema.h"

#include "lockwind/rng.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

constexpr Sample kSample{
    0x0102030405060708U, {0x1112131415161718, -2, 3}, -5, 0x2122, {0x31, 0x32}};

/// An arena with rows of random bytes.
StateArena random_arena(std::uint64_t seed) {
    StateArena arena(kSampleSchema, kSampleCapacities);
    arena.set_row_count(1, random_below(seed, 1, 0, 501));
    arena.set_row_count(2, random_below(seed, 1, 1, 11));
    arena.set_row_count(3, random_below(seed, 1, 2, 9));
    std::uint64_t counter = 0;
    for (std::uint32_t section = 1; section < 4; ++section) {
        for (std::byte& byte : arena.live_bytes(section)) {
            byte = static_cast<std::byte>(random_u32(seed, 2, counter) & 0xffU);
            ++counter;
        }
    }
    return arena;
}

TEST(Canonical, WritesCountsThenRowsLittleEndian) {
    StateArena arena(kSampleSchema, kSampleCapacities);
    arena.table<Sample>(1).set_count(1);
    arena.table<Sample>(1)[0] = kSample;
    arena.table<Cache>(3).set_count(2);
    std::vector<std::byte> bytes;
    save_canonical(arena, bytes);
    const unsigned char expected[] = {
        1,    0,    0,    0,    1,    0,    0,    0,    0, 0, 0, 0,             // counts
        8,    7,    6,    5,    4,    3,    2,    1,                            // id
        0x18, 0x17, 0x16, 0x15, 0x14, 0x13, 0x12, 0x11,                         // position x
        0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 3, 0, 0, 0, 0, 0, 0, 0, // y, z
        0xfb, 0xff, 0xff, 0xff, 0x22, 0x21, 0x31, 0x32}; // speed, flags, pair
    ASSERT_EQ(bytes.size(), sizeof(expected));
    EXPECT_EQ(std::memcmp(bytes.data(), expected, sizeof(expected)), 0);
    EXPECT_EQ(canonical_size_bytes(arena), sizeof(expected));
}

TEST(Canonical, RoundTripsRandomStates) {
    StateArena target(kSampleSchema, kSampleCapacities);
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const StateArena arena = random_arena(seed);
        std::vector<std::byte> bytes;
        save_canonical(arena, bytes);
        ASSERT_TRUE(load_canonical(target, bytes).ok());
        std::vector<std::byte> again;
        save_canonical(target, again);
        EXPECT_EQ(bytes, again);
        EXPECT_EQ(target.row_count(3), 0U) << "a cache does not survive a load";
    }
}

TEST(Canonical, LeavesDeadRowsZeroAfterALoadOfFewerRows) {
    StateArena target(kSampleSchema, kSampleCapacities);
    target.set_row_count(1, 500);
    std::fill(target.live_bytes(1).begin(), target.live_bytes(1).end(), std::byte{0xff});
    StateArena small(kSampleSchema, kSampleCapacities);
    small.set_row_count(1, 3);
    std::vector<std::byte> bytes;
    save_canonical(small, bytes);
    ASSERT_TRUE(load_canonical(target, bytes).ok());
    target.set_row_count(1, 500);
    EXPECT_TRUE(std::all_of(target.live_bytes(1).begin(),
                            target.live_bytes(1).end(),
                            [](std::byte byte) { return byte == std::byte{0}; }));
}

TEST(Canonical, SwapReversesEachComponentInItsPlace) {
    Sample sample = kSample;
    swap_rows(kSampleSchema[1], std::as_writable_bytes(std::span(&sample, 1)));
    EXPECT_EQ(sample.id, 0x0807060504030201U);
    EXPECT_EQ(sample.position[0], 0x1817161514131211);
    EXPECT_EQ(sample.position[1], -0x0100000000000001);
    EXPECT_EQ(sample.position[2], 0x0300000000000000);
    EXPECT_EQ(sample.speed, static_cast<std::int32_t>(0xfbffffffU));
    EXPECT_EQ(sample.flags, 0x2221);
    EXPECT_EQ(sample.pair[0], 0x31);
    EXPECT_EQ(sample.pair[1], 0x32);
}

TEST(Canonical, SwappingTwiceGivesTheRowsBack) {
    StateArena arena = random_arena(7);
    const std::span<std::byte> rows = arena.live_bytes(1);
    const std::vector<std::byte> before(rows.begin(), rows.end());
    swap_rows(kSampleSchema[1], rows);
    EXPECT_FALSE(std::equal(before.begin(), before.end(), rows.begin()));
    swap_rows(kSampleSchema[1], rows);
    EXPECT_TRUE(std::equal(before.begin(), before.end(), rows.begin()));
}

TEST(Canonical, ABigEndianMachinesRowsBecomeCanonicalBySwapping) {
    unsigned char memory[sizeof(Sample)] = {
        1,    2,    3,    4,    5,    6,    7,    8,                            // id
        0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18,                         // position x
        0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe, 0, 0, 0, 0, 0, 0, 0, 3, // y, z
        0xff, 0xff, 0xff, 0xfb, 0x21, 0x22, 0x31, 0x32}; // speed, flags, pair
    const auto bytes = std::as_writable_bytes(std::span(memory));
    swap_rows(kSampleSchema[1], bytes);
    for (const FieldDescriptor& field : kSampleFields) {
        for (std::uint32_t index = 0; index < field.components; ++index) {
            const auto* expected = reinterpret_cast<const std::byte*>(&kSample);
            EXPECT_EQ(read_canonical_component(field, index, bytes.data()),
                      read_component(field, index, expected))
                << field.name;
        }
    }
}

TEST(Canonical, RefusesEveryTruncationAndExtension) {
    StateArena arena(kSampleSchema, kSampleCapacities);
    arena.set_row_count(1, 2);
    std::vector<std::byte> bytes;
    save_canonical(arena, bytes);
    StateArena target(kSampleSchema, kSampleCapacities);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        EXPECT_FALSE(load_canonical(target, std::span(bytes).first(size)).ok()) << size;
        EXPECT_FALSE(split_canonical(kSampleSchema, std::span(bytes).first(size)).ok()) << size;
    }
    bytes.push_back(std::byte{0});
    EXPECT_FALSE(load_canonical(target, bytes).ok());
}

TEST(Canonical, RefusesCountsBeyondTheCapacity) {
    constexpr std::array<std::uint32_t, 4> kLarge{1, 501, 10, 8};
    StateArena large(kSampleSchema, kLarge);
    large.set_row_count(1, 501);
    std::vector<std::byte> bytes;
    save_canonical(large, bytes);
    StateArena target(kSampleSchema, kSampleCapacities);
    const Status status = load_canonical(target, bytes);
    ASSERT_FALSE(status.ok());
    EXPECT_NE(status.error().message.find("501 rows in section \"sample\""), std::string::npos);
    EXPECT_NE(status.error().message.find("capacity of 500"), std::string::npos);
    EXPECT_TRUE(split_canonical(kSampleSchema, bytes).ok());
}

TEST(Canonical, RefusesCountsWhoseSizeOverflows) {
    std::vector<std::byte> bytes(12);
    bytes[0] = std::byte{1};
    std::fill(bytes.begin() + 4, bytes.end(), std::byte{0xff});
    StateArena target(kSampleSchema, kSampleCapacities);
    EXPECT_FALSE(load_canonical(target, bytes).ok());
    EXPECT_FALSE(split_canonical(kSampleSchema, bytes).ok());
}

TEST(Canonical, RefusesASecondRowOfCounts) {
    std::vector<std::byte> bytes(24);
    bytes[0] = std::byte{2};
    StateArena target(kSampleSchema, kSampleCapacities);
    EXPECT_FALSE(load_canonical(target, bytes).ok());
}

TEST(Canonical, SplitsASnapshotIntoItsSections) {
    const StateArena arena = random_arena(3);
    std::vector<std::byte> bytes;
    save_canonical(arena, bytes);
    const auto sections = split_canonical(kSampleSchema, bytes);
    ASSERT_TRUE(sections.ok());
    ASSERT_EQ(sections.value().size(), 3U);
    for (std::uint32_t section = 0; section < 3; ++section) {
        const auto live = arena.live_bytes(section);
        std::vector<std::byte> rows(live.begin(), live.end());
        if constexpr (std::endian::native == std::endian::big) {
            swap_rows(kSampleSchema[section], rows);
        }
        ASSERT_EQ(sections.value()[section].size(), rows.size());
        EXPECT_TRUE(std::equal(rows.begin(), rows.end(), sections.value()[section].begin()));
    }
}

} // namespace
} // namespace lockwind::test
