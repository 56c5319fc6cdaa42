#include "tests/support/code_scenes.h"

#include "lockwind/hash_tree.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

/// Flips bits, overwrites words, copies ranges, cuts and extends.
std::vector<std::byte> mutated(const std::vector<std::byte>& sound, std::uint64_t seed) {
    std::vector<std::byte> bytes = sound;
    std::uint64_t draw = 0;
    const auto below = [&](std::size_t bound) {
        return random_below(seed, 3, draw++, static_cast<std::uint32_t>(bound));
    };
    const std::uint32_t edits = 1 + below(3);
    for (std::uint32_t edit = 0; edit < edits && !bytes.empty(); ++edit) {
        const std::size_t at = below(bytes.size());
        switch (below(8)) {
        case 0: // cut
            bytes.resize(at);
            break;
        case 1: // extend
            bytes.resize(bytes.size() + 1 + below(64));
            break;
        case 2: { // copy a row-sized range elsewhere
            const std::size_t size = std::min<std::size_t>(4 + below(256), bytes.size() - at);
            const std::size_t from = below(bytes.size() - size + 1);
            const std::vector<std::byte> range(bytes.begin() + static_cast<std::ptrdiff_t>(from),
                                               bytes.begin() +
                                                   static_cast<std::ptrdiff_t>(from + size));
            std::copy(range.begin(), range.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
            break;
        }
        case 3: { // an extreme 32-bit word
            constexpr std::uint32_t kWords[] = {
                0, 1, 0x7fffffffU, 0x80000000U, 0xffffffffU, 0x40000000U};
            const std::uint32_t word = kWords[below(std::size(kWords))];
            for (std::size_t index = 0; index < 4 && (at & ~3U) + index < bytes.size(); ++index) {
                bytes[(at & ~3U) + index] = static_cast<std::byte>((word >> (8 * index)) & 0xffU);
            }
            break;
        }
        default: // one bit
            bytes[at] ^= static_cast<std::byte>(1U << below(8));
        }
    }
    return bytes;
}

TEST(SnapshotFuzz, EveryMutationIsRefusedOrCanBeStepped) {
    const WorldPtr source = make_world(busy_scene(40, 2));
    std::vector<std::vector<std::byte>> sound;
    for (int tick = 0; tick < 160; ++tick) {
        step_busy(*source);
        if (tick % 40 == 39) {
            sound.emplace_back();
            source->save(sound.back());
        }
    }
    const WorldPtr world = make_world(busy_scene(40, 2));
    int refused = 0;
    int stepped = 0;
    constexpr std::uint64_t kMutations = 2000;
    for (std::uint64_t seed = 0; seed < kMutations; ++seed) {
        const std::vector<std::byte> bytes = mutated(sound[seed % sound.size()], seed);
        const std::uint64_t before = world->state_hash();
        const Status loaded = world->load(bytes);
        if (!loaded) {
            ++refused;
            ASSERT_FALSE(loaded.error().message.empty());
            ASSERT_EQ(world->state_hash(), before) << "seed " << seed;
            continue;
        }
        ++stepped;
        if (kChecked) {
            continue; // forged impulses may add up to more than a velocity holds: it wraps, or
                      // traps
        }
        for (int tick = 0; tick < 3; ++tick) {
            // A table may run full; that is told, not asserted.
            static_cast<void>(world->step(busy_inputs(world->tick() + 1, 2)));
        }
        // What a step leaves is a state that others accept.
        std::vector<std::byte> after;
        world->save(after);
        const Status accepted = world->load(after);
        ASSERT_TRUE(accepted.ok()) << "seed " << seed << ": " << accepted.error().message;
    }
    EXPECT_GT(refused, 200);
    EXPECT_GT(stepped, 200);
    RecordProperty("refused", refused);
    RecordProperty("stepped", stepped);
}

} // namespace
} // namespace lockwind::test
