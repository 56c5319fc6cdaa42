#pragma once

#include "lockwind/vector.h"

#include <cstdint>

namespace lockwind {

/// How much a step does for a body. Bit 0: no phase moves it; bit 1: it is far from all players.
enum class BodyLevel : std::uint8_t {
    full = 0,
    asleep = 1,     // its island rests. Fixed bodies sleep too, and kinematic ones at rest
    simplified = 2, // fewer substeps, discrete collision
    frozen = 3,     // keeps its velocities and goes on with them once it thaws
};

/// Less work for what is far from the players' pods. An island, what touches or is joined, has one
/// level, by the gap between the nearest pod's centre and the nearest bounding sphere of its bodies
/// at the end of a tick; without a pod in the world that is the full one. A body goes a level down
/// only a tenth beyond the distance within which it comes back.
struct LevelOfDetail {
    bool enabled = false;
    Real full_within = 50.0;               // m, 1 .. 16,000
    Real simplified_within = 200.0;        // m, full_within .. 16,000; beyond: frozen
    std::uint32_t simplified_substeps = 2; // at most, 1 .. 16
};

} // namespace lockwind
