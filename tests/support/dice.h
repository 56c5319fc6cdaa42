#pragma once

#include "lockwind/assert.h"

#include <cstdint>

namespace lockwind::testing {

/// Seeded draws (splitmix64).
class Dice {
public:
    explicit Dice(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {
        state_ += 0x9e3779b97f4a7c15U;
        std::uint64_t value = state_;
        value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
        value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
        return value ^ (value >> 31U);
    }
    std::uint64_t below(std::uint64_t bound) { return bound == 0 ? 0 : next() % bound; }
    bool chance(std::uint32_t per_mille) { return below(1000) < per_mille; }
    /// first .. last, both included.
    std::uint64_t between(std::uint64_t first, std::uint64_t last) {
        LOCKWIND_ASSERT(first <= last);
        return first + below(last - first + 1);
    }

private:
    std::uint64_t state_;
};

} // namespace lockwind::testing
