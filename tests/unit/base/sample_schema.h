#pragma once

#include "lockwind/schema.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace lockwind::test {

struct SampleCounts {
    std::uint32_t counts;
    std::uint32_t sample;
    std::uint32_t tail;
};

struct Sample {
    std::uint64_t id;
    std::int64_t position[3]; // Q31.32
    std::int32_t speed;       // Q11.20
    std::uint16_t flags;
    std::uint8_t pair[2];
};
static_assert(sizeof(Sample) == 40);

struct Tail {
    std::uint32_t value;
};

struct Cache {
    std::uint32_t value;
};

inline constexpr std::array kSampleCountsFields{
    LOCKWIND_FIELD(SampleCounts, counts, 0, "", ""),
    LOCKWIND_FIELD(SampleCounts, sample, 0, "", ""),
    LOCKWIND_FIELD(SampleCounts, tail, 0, "", ""),
};
inline constexpr std::array kSampleFields{
    LOCKWIND_FIELD(Sample, id, 0, "", ""),
    LOCKWIND_FIELD(Sample, position, 32, "m", "xyz"),
    LOCKWIND_FIELD(Sample, speed, 20, "m/s", ""),
    LOCKWIND_FIELD(Sample, flags, 0, "", ""),
    LOCKWIND_FIELD(Sample, pair, 0, "", ""),
};
inline constexpr std::array kTailFields{LOCKWIND_FIELD(Tail, value, 0, "", "")};
inline constexpr std::array kCacheFields{LOCKWIND_FIELD(Cache, value, 0, "", "")};

inline constexpr std::array<SectionDescriptor, 4> kSampleSchema{{
    {"counts", "base", sizeof(SampleCounts), false, "", kSampleCountsFields},
    {"sample", "test", sizeof(Sample), false, "id", kSampleFields},
    {"tail", "test", sizeof(Tail), false, "", kTailFields},
    {"cache", "test", sizeof(Cache), true, "", kCacheFields},
}};

inline constexpr std::array<std::uint32_t, 4> kSampleCapacities{1, 500, 10, 8};

} // namespace lockwind::test
