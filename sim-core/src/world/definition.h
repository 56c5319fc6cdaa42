#pragma once

#include "dynamics/dynamics.h"

#include "lockwind/result.h"
#include "lockwind/world_definition.h"

#include <cstdint>

namespace lockwind {

// Limits of the settings beside those that make_body keeps.
inline constexpr std::uint32_t kBodyCapacityMax = 1U << 20U;
inline constexpr std::uint32_t kPairCapacityMax = 1U << 25U;
inline constexpr std::uint32_t kJointCapacityMax = 1U << 20U;
inline constexpr std::uint32_t kSlotsMax = 256;

/// Ranges of the settings, the number of pods, ids unique and bodies in bounds. What concerns one
/// body is make_body's, what concerns one pod PodSystem's. The Error names setting or body.
Status check_definition(const WorldDefinition& definition);

/// Of a checked definition; a capacity of 0 becomes
///   body_capacity     bodies + for each pod, the balls it can have in the air at once, + 8
///   pair_capacity     24 a body + one for each body and plane + 256
///   manifold_capacity 12 a body + 256
///   joint_capacity    joints + 64
/// since a body in a dense heap has some 10 pairs and 6 touching ones (each counted once), and a
/// plane has a pair with every body.
DynamicsSettings dynamics_settings(const WorldDefinition& definition);

} // namespace lockwind
