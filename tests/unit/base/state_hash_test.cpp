#include "base/canonical.h"
#include "base/state_hash.h"
#include "tests/unit/base/sample_schema.h"

#include <gtest/gtest.h>
#include <string_view>

namespace lockwind::test {
namespace {

std::uint64_t hash_text(std::string_view text) {
    return hash_bytes(std::as_bytes(std::span(text.data(), text.size())));
}

StateArena filled_arena() {
    StateArena arena(kSampleSchema, kSampleCapacities);
    arena.set_row_count(1, 400);
    arena.set_row_count(2, 4);
    for (std::uint32_t row = 0; row < 400; ++row) {
        arena.table<Sample>(1)[row].id = row + 1;
    }
    return arena;
}

TEST(StateHash, IsXxh3WithSeedZero) {
    // xxHash's own: xxhsum -H3.
    EXPECT_EQ(hash_text(""), 0x2d06800538d394c2U);
    EXPECT_EQ(hash_text("a"), 0xe6c632b61e964e1fU);
    EXPECT_EQ(hash_text("abc"), 0x78af5f94892f3950U);
}

TEST(StateHash, RootEqualsTheTreesRoot) {
    const StateArena arena = filled_arena();
    StateHasher hasher(arena);
    const HashTree tree = hasher.tree(arena);
    EXPECT_EQ(hasher.root(arena), tree.root);
    EXPECT_EQ(hasher.root(arena), tree.root) << "scratch must not carry over";
}

std::uint64_t hash_of_words(const std::vector<std::uint64_t>& words) {
    std::vector<std::byte> bytes;
    for (const std::uint64_t word : words) {
        for (int shift = 0; shift < 64; shift += 8) {
            bytes.push_back(static_cast<std::byte>(word >> shift & 0xffU));
        }
    }
    return hash_bytes(bytes);
}

TEST(StateHash, TreeIsBuiltOfPagesAsDocumented) {
    const StateArena arena = filled_arena();
    std::vector<std::byte> snapshot;
    save_canonical(arena, snapshot);
    const auto sections = split_canonical(arena.schema(), snapshot);
    ASSERT_TRUE(sections.ok());
    StateHasher hasher(arena);
    const HashTree tree = hasher.tree(arena);
    ASSERT_EQ(tree.sections.size(), 3U);
    ASSERT_EQ(tree.pages.size(), 3U);
    for (std::uint32_t section = 0; section < 3; ++section) {
        const std::span<const std::byte> rows = sections.value()[section];
        ASSERT_EQ(tree.pages[section].size(), (rows.size() + kHashPageBytes - 1) / kHashPageBytes);
        for (std::size_t page = 0; page < tree.pages[section].size(); ++page) {
            const std::size_t offset = page * kHashPageBytes;
            const std::size_t size = std::min(kHashPageBytes, rows.size() - offset);
            EXPECT_EQ(tree.pages[section][page], hash_bytes(rows.subspan(offset, size)));
        }
        EXPECT_EQ(tree.sections[section], hash_of_words(tree.pages[section]));
    }
    EXPECT_EQ(tree.root, hash_of_words(tree.sections));
}

TEST(StateHash, ADifferenceIsFoundByDescending) {
    const StateArena before = filled_arena();
    StateArena after = filled_arena();
    after.table<Sample>(1)[250].speed ^= 1; // byte 10,032: page 2
    StateHasher hasher(before);
    const HashTree a = hasher.tree(before);
    const HashTree b = hasher.tree(after);
    EXPECT_NE(a.root, b.root);
    EXPECT_EQ(a.sections[0], b.sections[0]);
    EXPECT_NE(a.sections[1], b.sections[1]);
    EXPECT_EQ(a.sections[2], b.sections[2]);
    for (std::size_t page = 0; page < a.pages[1].size(); ++page) {
        EXPECT_EQ(a.pages[1][page] == b.pages[1][page], page != 2) << page;
    }
}

TEST(StateHash, ARowMoreOfZeroesIsAnotherState) {
    const StateArena before = filled_arena();
    StateArena after = filled_arena();
    after.set_row_count(2, 5);
    StateHasher hasher(before);
    EXPECT_NE(hasher.root(before), hasher.root(after));
}

TEST(StateHash, IgnoresCaches) {
    const StateArena before = filled_arena();
    StateArena after = filled_arena();
    after.set_row_count(3, 5);
    after.table<Cache>(3)[0].value = 1;
    StateHasher hasher(before);
    EXPECT_EQ(hasher.root(before), hasher.root(after));
}

} // namespace
} // namespace lockwind::test
