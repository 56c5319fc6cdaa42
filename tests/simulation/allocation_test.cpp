#include "tests/support/code_scenes.h"

#include "lockwind/hash_tree.h"
#include "lockwind/phase_observer.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <gtest/gtest.h>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LOCKWIND_COUNTS_MALLOC 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LOCKWIND_COUNTS_MALLOC 0
#endif
#endif
#if !defined(LOCKWIND_COUNTS_MALLOC) && defined(__GLIBC__)
#define LOCKWIND_COUNTS_MALLOC 1
#endif
#ifndef LOCKWIND_COUNTS_MALLOC
#define LOCKWIND_COUNTS_MALLOC 0
#endif

namespace {

std::atomic<std::uint64_t> allocations{0};

void count() {
    allocations.fetch_add(1, std::memory_order_relaxed);
}

} // namespace

#if LOCKWIND_COUNTS_MALLOC

// Under malloc lies operator new, so that counting malloc counts both.
extern "C" {
// NOLINTBEGIN(readability-identifier-naming): glibc's names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(readability-identifier-naming)

void* malloc(std::size_t size) {
    count();
    return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
    count();
    return __libc_calloc(number, size);
}
void* realloc(void* block, std::size_t size) {
    count();
    return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    count();
    return __libc_memalign(alignment, size);
}
}

#else

void* operator new(std::size_t size) {
    count();
    void* block = std::malloc(size);
    if (block == nullptr) {
        std::abort();
    }
    return block;
}
void operator delete(void* block) noexcept {
    std::free(block);
}
void operator delete(void* block, std::size_t) noexcept {
    std::free(block);
}

#endif

namespace lockwind::test {
namespace {

TEST(Allocations, AreCounted) {
    const std::uint64_t before = allocations.load();
    const auto* number = new int(5); // NOLINT(cppcoreguidelines-owning-memory): what is counted
    const std::uint64_t after = allocations.load();
    EXPECT_EQ(*number, 5);
    delete number; // NOLINT(cppcoreguidelines-owning-memory)
    EXPECT_EQ(after - before, 1U);
}

/// Allocates in the middle of a step, as a step that allocates would.
class Planted final : public PhaseObserver {
public:
    void after_phase(std::uint32_t phase) override {
        if (phase == 3) {
            vector.push_back(phase);
        }
    }
    std::vector<std::uint32_t> vector;
};

TEST(Allocations, OnePlantedInAStepIsSeen) {
    const WorldPtr world = make_world(busy_scene(20, 2));
    step_busy(*world);
    const std::vector<SlotInput> inputs = busy_inputs(2, 2);
    Planted planted;
    const std::uint64_t before = allocations.load();
    const bool ok = world->step(inputs, &planted).ok();
    const std::uint64_t after = allocations.load();
    EXPECT_TRUE(ok);
    EXPECT_EQ(after - before, 1U);
}

TEST(Allocations, NoneInAStepAfterTheFirst) {
    WorldDefinition scene = with_levels(busy_scene(220, 4));
    add_bullets(scene, 30000, {0, 20, 0});
    const WorldPtr world = make_world(scene);
    step_busy(*world);
    ASSERT_GE(world->body_count(), 224U);
    std::uint64_t in_steps = 0;
    for (int tick = 0; tick < 400; ++tick) {
        const std::vector<SlotInput> inputs = busy_inputs(world->tick() + 1, 4);
        const std::uint64_t before = allocations.load();
        const bool ok = world->step(inputs).ok();
        in_steps += allocations.load() - before;
        ASSERT_TRUE(ok);
    }
    EXPECT_EQ(in_steps, 0U);
    const WorldCounts counts = world->counts();
    EXPECT_GT(counts.created_total, 50U) << "shots";
    EXPECT_GT(counts.destroyed_total, 20U);
    EXPECT_GT(counts.contacts, 400U);
}

TEST(Allocations, NoneInAHashOrInASaveThatHasRoom) {
    const WorldPtr world = make_world(busy_scene(220, 4));
    for (int tick = 0; tick < 60; ++tick) {
        step_busy(*world);
    }
    std::vector<std::byte> bytes;
    world->save(bytes);
    const std::uint64_t before = allocations.load();
    const std::uint64_t hash = world->state_hash();
    world->save(bytes);
    const bool loaded = world->load(bytes).ok();
    const std::uint64_t after = allocations.load();
    EXPECT_TRUE(loaded);
    EXPECT_EQ(world->state_hash(), hash);
    EXPECT_EQ(after - before, 0U);
}

} // namespace
} // namespace lockwind::test
