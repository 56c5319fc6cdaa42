#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lockwind/schema.h"
#include "lockwind/types.h"

namespace lockwind {

/// Two bodies whose fat bounds overlap, at least one dynamic: row of section "pair", sorted by (row_a, row_b).
struct Pair {
    BodyRow row_a; // row_a < row_b
    BodyRow row_b;
    std::uint32_t manifold; // row of section "manifold"; kNoIndex unless touching
    std::uint32_t stamp;    // tick when the narrow phase last looked at it; 0 for never
    std::uint8_t axis;      // box-box cache, see ManifoldCache
    std::uint8_t point_count; // 0 .. 4; 0 unless touching
    std::uint8_t zero[2];
};
static_assert(sizeof(Pair) == 20);

inline constexpr std::array kPairFields{
    LOCKWIND_FIELD(Pair, row_a, 0, "", ""),
    LOCKWIND_FIELD(Pair, row_b, 0, "", ""),
    LOCKWIND_FIELD(Pair, manifold, 0, "", ""),
    LOCKWIND_FIELD(Pair, stamp, 0, "tick", ""),
    LOCKWIND_FIELD(Pair, axis, 0, "", ""),
    LOCKWIND_FIELD(Pair, point_count, 0, "", ""),
    LOCKWIND_FIELD(Pair, zero, 0, "", ""),
};

} // namespace lockwind
