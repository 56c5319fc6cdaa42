#pragma once

#include "dynamics/body.h"
#include "dynamics/dynamics.h"

#include "lockwind/world_definition.h"

#include <cstdint>

namespace lockwind {

/// Whether the two make a pair when their bounds overlap: one of them is dynamic, their layers and
/// masks agree, and they are not both sensors. A damaged layer is another one.
constexpr bool may_meet(const BodyProperties& a, const BodyProperties& b) {
    constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);
    return (a.mode == kDynamic || b.mode == kDynamic) && (a.sensor & b.sensor) == 0 &&
           (a.mask >> (b.layer % kLayerCount) & 1U) != 0 &&
           (b.mask >> (a.layer % kLayerCount) & 1U) != 0;
}

/// A pair that only tells of its overlap: nothing is pushed, held or woken by it.
constexpr bool is_sensing(const BodyProperties& a, const BodyProperties& b) {
    return (a.sensor | b.sensor) != 0;
}

/// Whether the two touch, and mind it.
inline bool is_pressing(const Pair& pair, const DynamicsTables& tables) {
    return pair.point_count != 0 &&
           !is_sensing(tables.properties[pair.row_a], tables.properties[pair.row_b]);
}

/// Two bodies' friction or restitution, Q3.28, 0 .. kFrictionMax, as one; also in this range.
std::int32_t combine(std::int32_t a, std::int32_t b, std::uint8_t rule_a, std::uint8_t rule_b);

} // namespace lockwind
