#include "base/arena.h"
#include "tests/unit/base/sample_schema.h"

#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

bool is_zero(std::byte byte) {
    return byte == std::byte{0};
}

TEST(StateArena, StartsZeroedWithOneRowOfCounts) {
    const StateArena arena(kSampleSchema, kSampleCapacities);
    EXPECT_EQ(arena.row_count(0), 1U);
    EXPECT_EQ(arena.row_count(1), 0U);
    // The count of section 0 is the only byte that is not zero.
    EXPECT_EQ(std::count_if(arena.buffer().begin(),
                            arena.buffer().end(),
                            [](std::byte b) { return !is_zero(b); }),
              1);
}

TEST(StateArena, SectionsStartOnCacheLines) {
    StateArena arena(kSampleSchema, kSampleCapacities);
    for (std::uint32_t section = 0; section < arena.section_count(); ++section) {
        const auto address = reinterpret_cast<std::uintptr_t>(arena.live_bytes(section).data());
        EXPECT_EQ(address % StateArena::kAlignmentBytes, 0U) << section;
    }
}

TEST(StateArena, KeepsRowCountsInItsOwnSection) {
    StateArena arena(kSampleSchema, kSampleCapacities);
    arena.table<Sample>(1).set_count(7);
    arena.table<Tail>(2).set_count(3);
    const SampleCounts& counts = arena.table<SampleCounts>(0)[0];
    EXPECT_EQ(counts.counts, 1U);
    EXPECT_EQ(counts.sample, 7U);
    EXPECT_EQ(counts.tail, 3U);
    EXPECT_EQ(arena.live_bytes(1).size(), 7 * sizeof(Sample));
}

TEST(StateArena, KeepsCountsOfCachesOutOfTheState) {
    StateArena arena(kSampleSchema, kSampleCapacities);
    const std::vector<std::byte> before(arena.live_bytes(0).begin(), arena.live_bytes(0).end());
    arena.table<Cache>(3).set_count(5);
    EXPECT_EQ(arena.row_count(3), 5U);
    EXPECT_TRUE(std::equal(before.begin(), before.end(), arena.live_bytes(0).begin()));
}

TEST(StateArena, ZeroesRowsThatDie) {
    for (const bool through_table : {false, true}) {
        StateArena arena(kSampleSchema, kSampleCapacities);
        const Table<Sample> table = arena.table<Sample>(1);
        table.set_count(5);
        std::fill(arena.live_bytes(1).begin(), arena.live_bytes(1).end(), std::byte{0xff});
        if (through_table) {
            table.set_count(2);
        } else {
            arena.set_row_count(1, 2);
        }
        table.set_count(5);
        const auto rows = arena.live_bytes(1);
        EXPECT_FALSE(is_zero(rows[2 * sizeof(Sample) - 1]));
        EXPECT_TRUE(std::all_of(rows.begin() + 2 * sizeof(Sample), rows.end(), is_zero));
    }
}

TEST(StateArena, MovesWithItsRowsAndTables) {
    StateArena first(kSampleSchema, kSampleCapacities);
    StateArena second(kSampleSchema, kSampleCapacities);
    first.table<Sample>(1).set_count(1);
    first.table<Sample>(1)[0].id = 11;
    second.table<Sample>(1).set_count(2);
    second.table<Sample>(1)[1].id = 22;
    second.table<Cache>(3).set_count(4);
    std::swap(first, second);
    EXPECT_EQ(first.row_count(1), 2U);
    EXPECT_EQ(first.table<Sample>(1)[1].id, 22U);
    EXPECT_EQ(first.row_count(3), 4U);
    EXPECT_EQ(second.table<Sample>(1)[0].id, 11U);
    EXPECT_EQ(second.row_count(3), 0U);
}

TEST(StateArenaDeathTest, RefusesMoreRowsThanItsCapacity) {
    StateArena arena(kSampleSchema, kSampleCapacities);
    EXPECT_DEATH(arena.table<Sample>(1).set_count(501), "count <= capacity_");
    EXPECT_DEATH(arena.set_row_count(2, 11), "new_count <=");
}

TEST(StateArenaDeathTest, RefusesARowTypeOfAnotherSize) {
    StateArena arena(kSampleSchema, kSampleCapacities);
    EXPECT_DEATH(static_cast<void>(arena.table<Tail>(1)), "stride_bytes");
}

TEST(AssertDeathTest, NamesTheConditionAndItsPlace) {
    EXPECT_DEATH(LOCKWIND_ASSERT(1 + 1 == 3),
                 "arena_test.cpp:[0-9]+: assertion failed: 1 \\+ 1 == 3");
}

} // namespace
} // namespace lockwind::test
