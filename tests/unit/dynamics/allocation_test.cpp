#include "tests/unit/dynamics/dynamics_bench.h"

#include <cstdlib>
#include <new>
#include <random>

namespace {

std::size_t allocation_count = 0;

} // namespace

void* operator new(std::size_t size) {
    ++allocation_count;
    void* memory = std::malloc(size != 0 ? size : 1);
    if (memory == nullptr) {
        std::abort();
    }
    return memory;
}

void operator delete(void* memory) noexcept {
    std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace lockwind {
namespace {

TEST(Allocation, NoPhaseAllocates) {
    DynamicsBench bench;
    bench.add(ground());
    std::mt19937 random(2);
    for (int index = 0; index < 150; ++index) {
        const Vec3 position = vec(index % 5 * 0.9, 1 + index / 25 * 1.1, index / 5 % 5 * 0.9);
        bench.add(random() % 2 == 0 ? ball(0.4, position) : cube(0.4, position));
    }
    const std::size_t before = allocation_count;
    const DynamicsTables tables = bench.tables();
    Dynamics& dynamics = bench.dynamics();
    std::size_t changes = 0;
    for (std::uint32_t tick = 1; tick <= 180; ++tick) {
        static_cast<void>(dynamics.broad_phase(tables));
        static_cast<void>(dynamics.narrow_phase(tables));
        changes += dynamics.contact_changes().size();
        dynamics.solve(tables);
        dynamics.restitution(tables);
    }
    EXPECT_EQ(allocation_count, before);
    EXPECT_GT(changes, 150U) << "nothing happened";
    const std::vector<int> counted(1);
    EXPECT_EQ(allocation_count, before + 1) << "the count does not count";
}

} // namespace
} // namespace lockwind
