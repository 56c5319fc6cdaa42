#pragma once

#include "lockwind/level_of_detail.h"
#include "lockwind/schema.h"
#include "lockwind/types.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace lockwind {

/// What moves: row of the arena's section "body", sorted by id. Raw fixed-point values. A body's
/// frame is that of its principal axes about its centre of mass; for hulls, compounds and surfaces
/// it is not the one that the definition has (see ShapeBuild), for all others it is.
struct BodyMotion {
    std::uint64_t id;
    std::int64_t position[3];        // Q31.32 m
    std::int32_t orientation[4];     // Q2.30 x y z w, unit
    std::int32_t linear_velocity[3]; // Q11.20 m/s
    std::int32_t
        angular_velocity[3];    // Q11.20 m/s: world angular velocity (rad/s) x gyration radius
    std::int32_t fat_bounds[6]; // Q15.16 m: min xyz, max xyz
    std::int32_t motion_sum[2]; // Q9.22 m moved since each last passed its bound, see MotionBound
};
static_assert(sizeof(BodyMotion) == 104);

/// What a body is. Bodies that are the same share a row of "body_kind"; the derived section
/// "body_properties" has it once more for each body, in the same row as its BodyMotion. Written on
/// creation only.
struct BodyProperties {
    std::int64_t inverse_mass;    // Q24.40 1/kg; 0 unless dynamic
    std::int32_t size[3];         // Q9.22 m: box half extents; sphere radius; capsule radius,
                                  // half height of the segment; else 0
    std::int32_t bounding_radius; // Q9.22 m; 0 for a plane
    std::int32_t gyration_radius; // Q9.22 m: sqrt(k_min k_max); see solver.md 4
    std::int32_t inverse_gyration_radius; // Q7.24 1/m
    std::int32_t inverse_inertia[3];  // Q5.26: mass x gyration_radius^2 / I, principal = local axes
    std::int32_t friction;            // Q3.28
    std::int32_t restitution;         // Q3.28
    std::uint8_t mode;                // BodyMode
    std::uint8_t shape;               // ShapeType
    std::uint8_t can_sleep;           // 0, 1
    std::uint8_t sensor;              // 0, 1
    std::int32_t surface_velocity[3]; // Q11.20 m/s, in the body's frame
    std::uint32_t mask;               // bit L: meets bodies of layer L
    std::uint8_t layer;               // below kLayerCount
    std::uint8_t friction_rule;       // CombineRule
    std::uint8_t restitution_rule;    // CombineRule
    std::uint8_t collision_mode;      // CollisionMode
    std::uint16_t shape_index;        // in the world's ShapeLibrary, of its type; 0 for sizes alone
    std::uint8_t substeps;            // 1 .. kSubstepsMax; 0: the settings'
    std::uint8_t zero_end;            // int64 is aligned to 8 on some machines
};
static_assert(sizeof(BodyProperties) == 80);

/// rho^2 m / I, Q5.26: from here on a body is so slender that its contacts take care of its twist
/// and turn.
inline constexpr std::int32_t kVerySlender = 8 << 26;
inline bool is_very_slender(const BodyProperties& body) {
    return std::max({body.inverse_inertia[0], body.inverse_inertia[1], body.inverse_inertia[2]}) >=
           kVerySlender;
}

/// What else a body has to itself: row of "body_life", same row as its BodyMotion.
struct BodyLife {
    std::uint32_t body_kind;    // row of section "body_kind"
    std::uint32_t spawn_count;  // bodies this one has spawned
    std::uint32_t despawn_tick; // low 32 bits of the tick that destroys it; 0 for never
};
static_assert(sizeof(BodyLife) == 12);

/// How far a body may move before the narrow phase looks at its pairs again. A touching pair of
/// flat shapes bears more motion than others.
enum class MotionBound : std::uint8_t { touching = 0, other = 1 };
inline constexpr std::int32_t kMotionBound[2] = {104858, 41943}; // Q9.22 m: 25 mm and 10 mm
constexpr std::uint8_t bit_of(MotionBound bound) {
    return static_cast<std::uint8_t>(1U << static_cast<unsigned>(bound));
}

/// Whether a step moves a body: row of "body_sleep", same row as its BodyMotion. Apart and narrow,
/// so that a step sees at a glance who is awake.
struct BodySleep {
    std::uint16_t still_ticks; // for how many it has been slow; at most 65535
    std::uint8_t level;        // BodyLevel; fixed bodies are not far
    std::uint8_t moved;        // bit_of(MotionBound): passed since a narrow phase saw it awake
};
static_assert(sizeof(BodySleep) == 4);

constexpr BodyLevel level_of(const BodySleep& sleep) {
    return static_cast<BodyLevel>(sleep.level);
}
constexpr void set_level(BodySleep& sleep, BodyLevel level) {
    sleep.level = static_cast<std::uint8_t>(level);
}
/// Whether phases move it.
constexpr bool is_awake(const BodySleep& sleep) {
    return (sleep.level & 1U) == 0;
}

inline constexpr std::array kBodyMotionFields{
    LOCKWIND_FIELD(BodyMotion, id, 0, "", ""),
    LOCKWIND_FIELD(BodyMotion, position, 32, "m", "xyz"),
    LOCKWIND_FIELD(BodyMotion, orientation, 30, "", "xyzw"),
    LOCKWIND_FIELD(BodyMotion, linear_velocity, 20, "m/s", "xyz"),
    LOCKWIND_FIELD(BodyMotion, angular_velocity, 20, "m/s", "xyz"),
    LOCKWIND_FIELD(BodyMotion, fat_bounds, 16, "m", ""),
    LOCKWIND_FIELD(BodyMotion, motion_sum, 22, "m", ""),
};

inline constexpr std::array kBodyPropertiesFields{
    LOCKWIND_FIELD(BodyProperties, inverse_mass, 40, "1/kg", ""),
    LOCKWIND_FIELD(BodyProperties, size, 22, "m", ""),
    LOCKWIND_FIELD(BodyProperties, bounding_radius, 22, "m", ""),
    LOCKWIND_FIELD(BodyProperties, gyration_radius, 22, "m", ""),
    LOCKWIND_FIELD(BodyProperties, inverse_gyration_radius, 24, "1/m", ""),
    LOCKWIND_FIELD(BodyProperties, inverse_inertia, 26, "", "xyz"),
    LOCKWIND_FIELD(BodyProperties, friction, 28, "", ""),
    LOCKWIND_FIELD(BodyProperties, restitution, 28, "", ""),
    LOCKWIND_FIELD(BodyProperties, mode, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, shape, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, can_sleep, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, sensor, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, surface_velocity, 20, "m/s", "xyz"),
    LOCKWIND_FIELD(BodyProperties, mask, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, layer, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, friction_rule, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, restitution_rule, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, collision_mode, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, shape_index, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, substeps, 0, "", ""),
    LOCKWIND_FIELD(BodyProperties, zero_end, 0, "", ""),
};

inline constexpr std::array kBodyLifeFields{
    LOCKWIND_FIELD(BodyLife, body_kind, 0, "", ""),
    LOCKWIND_FIELD(BodyLife, spawn_count, 0, "", ""),
    LOCKWIND_FIELD(BodyLife, despawn_tick, 0, "tick", ""),
};

inline constexpr std::array kBodySleepFields{
    LOCKWIND_FIELD(BodySleep, still_ticks, 0, "ticks", ""),
    LOCKWIND_FIELD(BodySleep, level, 0, "", ""),
    LOCKWIND_FIELD(BodySleep, moved, 0, "", ""),
};

} // namespace lockwind
