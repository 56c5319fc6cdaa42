#include "tests/support/code_scenes.h"

#include "lockwind/hash_tree.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>

namespace lockwind::test {
namespace {

/// Spoils bytes by draws of one seed.
class Mutator {
public:
    Mutator(std::vector<std::byte>& bytes, std::uint64_t seed) : bytes_(bytes), seed_(seed) {}

    void run() {
        const std::uint32_t edits = 1 + below(3);
        for (std::uint32_t edit = 0; edit < edits && !bytes_.empty(); ++edit) {
            const std::size_t at = below(bytes_.size());
            switch (below(8)) {
            case 0:
                bytes_.resize(at);
                break;
            case 1:
                bytes_.resize(bytes_.size() + 1 + below(64));
                break;
            case 2:
                copy_range(at);
                break;
            case 3:
                set_word(at & ~std::size_t{3});
                break;
            default:
                bytes_[at] ^= static_cast<std::byte>(1U << below(8));
            }
        }
    }

private:
    std::uint32_t below(std::size_t bound) {
        ++draws_;
        return random_below(seed_, 3, draws_, static_cast<std::uint32_t>(bound));
    }

    /// About a row of bytes from elsewhere.
    void copy_range(std::size_t to) {
        const std::size_t size = std::min<std::size_t>(4 + below(256), bytes_.size() - to);
        const std::size_t from = below(bytes_.size() - size + 1);
        std::memmove(bytes_.data() + to, bytes_.data() + from, size);
    }

    void set_word(std::size_t at) {
        constexpr std::uint32_t kWords[] = {
            0, 1, 0x7fffffffU, 0x80000000U, 0xffffffffU, 0x40000000U};
        const std::uint32_t word = kWords[below(std::size(kWords))];
        for (std::size_t index = 0; index < 4 && at + index < bytes_.size(); ++index) {
            bytes_[at + index] = static_cast<std::byte>((word >> (8 * index)) & 0xffU);
        }
    }

    std::vector<std::byte>& bytes_;
    std::uint64_t seed_;
    std::uint64_t draws_ = 0;
};

TEST(SnapshotFuzz, EveryMutationIsRefusedOrCanBeStepped) {
    WorldDefinition definition = with_levels(busy_scene(40, 2));
    add_joints(definition, 1000, {0, 30, 0});
    const WorldPtr source = make_world(definition);
    std::vector<std::vector<std::byte>> sound;
    for (int tick = 0; tick < 160; ++tick) {
        step_busy(*source);
        if (tick % 40 == 39) {
            sound.emplace_back();
            source->save(sound.back());
        }
    }
    const WorldPtr world = make_world(definition);
    int refused = 0;
    int stepped = 0;
    constexpr std::uint64_t kMutations = 2000;
    for (std::uint64_t seed = 0; seed < kMutations; ++seed) {
        std::vector<std::byte> bytes = sound[static_cast<std::size_t>(seed % sound.size())];
        Mutator(bytes, seed).run();
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
            // Each forged impulse is in range, but what several do to one body may not be: it
            // wraps, which this build traps.
            continue;
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
