#pragma once

#include "dynamics/body.h"
#include "dynamics/contact.h"
#include "dynamics/joint.h"
#include "systems/player.h"

#include "lockwind/schema.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace lockwind {

/// The world's own numbers: the one row of section "globals".
struct Globals {
    std::uint64_t tick;            // that this state is of
    std::uint64_t seed;            // of every random stream
    std::uint64_t event_hash;      // chain over all events so far, see event_log.h
    std::uint64_t events_total;    // events so far
    std::uint64_t created_total;   // bodies created in ticks so far
    std::uint64_t destroyed_total; // bodies destroyed in ticks so far
};
static_assert(sizeof(Globals) == 48);

/// How many rows live: the one row of section "arena".
struct RowCounts {
    std::uint32_t arena;
    std::uint32_t globals;
    std::uint32_t body;
    std::uint32_t body_kind;
    std::uint32_t body_life;
    std::uint32_t body_sleep;
    std::uint32_t manifold;
    std::uint32_t contact_impulse;
    std::uint32_t joint;
    std::uint32_t player;
};
static_assert(sizeof(RowCounts) == 40);

/// Sections by number, in the order of kWorldSections.
namespace section {
inline constexpr std::uint32_t kArena = 0;
inline constexpr std::uint32_t kGlobals = 1;
inline constexpr std::uint32_t kBody = 2;
inline constexpr std::uint32_t kBodyKind = 3;
inline constexpr std::uint32_t kBodyLife = 4;
inline constexpr std::uint32_t kBodySleep = 5;
inline constexpr std::uint32_t kManifold = 6;
inline constexpr std::uint32_t kContactImpulse = 7;
inline constexpr std::uint32_t kJoint = 8;
inline constexpr std::uint32_t kPlayer = 9;
inline constexpr std::uint32_t kStateCount = 10;
// Derived.
inline constexpr std::uint32_t kPair = 10;
inline constexpr std::uint32_t kCount = 11;
} // namespace section

inline constexpr std::array kRowCountsFields{
    LOCKWIND_FIELD(RowCounts, arena, 0, "", ""),
    LOCKWIND_FIELD(RowCounts, globals, 0, "", ""),
    LOCKWIND_FIELD(RowCounts, body, 0, "", ""),
    LOCKWIND_FIELD(RowCounts, body_kind, 0, "", ""),
    LOCKWIND_FIELD(RowCounts, body_life, 0, "", ""),
    LOCKWIND_FIELD(RowCounts, body_sleep, 0, "", ""),
    LOCKWIND_FIELD(RowCounts, manifold, 0, "", ""),
    LOCKWIND_FIELD(RowCounts, contact_impulse, 0, "", ""),
    LOCKWIND_FIELD(RowCounts, joint, 0, "", ""),
    LOCKWIND_FIELD(RowCounts, player, 0, "", ""),
};

inline constexpr std::array kGlobalsFields{
    LOCKWIND_FIELD(Globals, tick, 0, "tick", ""),
    LOCKWIND_FIELD(Globals, seed, 0, "", ""),
    LOCKWIND_FIELD(Globals, event_hash, 0, "", ""),
    LOCKWIND_FIELD(Globals, events_total, 0, "", ""),
    LOCKWIND_FIELD(Globals, created_total, 0, "", ""),
    LOCKWIND_FIELD(Globals, destroyed_total, 0, "", ""),
};

inline constexpr std::array<SectionDescriptor, section::kCount> kWorldSections{{
    {"arena", "base", sizeof(RowCounts), false, "", kRowCountsFields},
    {"globals", "world", sizeof(Globals), false, "", kGlobalsFields},
    {"body", "dynamics", sizeof(BodyMotion), false, "id", kBodyMotionFields},
    {"body_kind", "dynamics", sizeof(BodyProperties), false, "", kBodyPropertiesFields},
    {"body_life", "dynamics", sizeof(BodyLife), false, "", kBodyLifeFields},
    {"body_sleep", "dynamics", sizeof(BodySleep), false, "", kBodySleepFields},
    {"manifold", "dynamics", sizeof(Manifold), false, "", kManifoldFields},
    {"contact_impulse", "dynamics", sizeof(ContactImpulse), false, "", kContactImpulseFields},
    {"joint", "dynamics", sizeof(Joint), false, "id", kJointFields},
    {"player", "systems", sizeof(Player), false, "", kPlayerFields},
    {"pair", "dynamics", sizeof(Pair), true, "", kPairFields},
}};

} // namespace lockwind
