#pragma once

#include <cstdint>

namespace lockwind {

/// Simulation time. state(0) is the scene; step T applies inputs(T) to state(T - 1) and gives
/// state(T).
using Tick = std::uint64_t;

/// Player seat in a match, from 0.
using Slot = std::uint32_t;

/// Birth key of a body, never reused. Bodies of a scene: 1 .. 2^32 - 1. A spawned body: its
/// spawner's id (a scene body) in the high half, how many that one has spawned, from 1, in the low
/// half.
using BodyId = std::uint64_t;

/// A joint's identity, never reused.
using JointId = std::uint64_t;

/// Place of a body in the id-sorted table: its rank. Not an identity: it moves when others come and
/// go.
using BodyRow = std::uint32_t;

inline constexpr std::uint32_t kNoIndex = 0xffffffffU;

} // namespace lockwind
