#pragma once

#include "dynamics/dynamics.h"

#include "lockwind/result.h"
#include "lockwind/world_definition.h"

#include <cstdint>

namespace lockwind {

// Limits that make_joint keeps; the solver's formats rest on them.
inline constexpr Real kJointAnchorMax = 400.0; // m, each axis
/// Longest lever of a body that moves, in gyration radii.
inline constexpr std::int64_t kJointLeverMax = 1000;
inline constexpr Real kJointLengthMax = 500.0;       // m
inline constexpr Real kJointMotorSpeedMax = 1000.0;  // m/s, rad/s
inline constexpr Real kJointForceMax = 1000000000.0; // N, N m
inline constexpr Real kJointHertzMin = 0.01;
inline constexpr Real kJointHertzMax = 1000.0;
inline constexpr Real kJointDampingMax = 100.0;

/// Fills the row of a new joint between these rows of `tables` (row_a kNoIndex for a grab). An
/// Error names the joint, the field and what would be right; the row is then untouched.
Status make_joint(const JointDefinition& definition,
                  const DynamicsTables& tables,
                  const ShapeLibrary& shapes,
                  BodyRow row_a,
                  BodyRow row_b,
                  Joint& joint);

/// Null, or the field of a stored joint that make_joint would not have written. Does not look at
/// the order of rows.
const char* bad_joint_field(const DynamicsTables& tables, const Joint& joint);

/// Null, or the field for which a joint cannot be between bodies with these properties; a grab has
/// no A.
const char* bad_joint_side(const Joint& joint, const BodyProperties* a, const BodyProperties& b);

} // namespace lockwind
