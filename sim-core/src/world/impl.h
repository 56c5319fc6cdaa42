#pragma once

#include "base/arena.h"
#include "base/keeping.h"
#include "base/page_versions.h"
#include "base/state_hash.h"
#include "dynamics/dynamics.h"
#include "geometry/shape_library.h"
#include "systems/pod.h"
#include "systems/spawn.h"
#include "world/event_log.h"
#include "world/query_index.h"
#include "world/state.h"

#include "lockwind/world.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

struct World::Impl {
    Impl(const WorldDefinition& definition,
         const DynamicsSettings& capacities,
         Simd simd,
         ShapeLibrary library,
         PodSystem pod_system);

    Globals& globals() { return arena.table<Globals>(section::kGlobals)[0]; }
    Table<Player> players() { return arena.table<Player>(section::kPlayer); }
    DynamicsTables tables() { return tables_of(arena); }
    static DynamicsTables tables_of(StateArena& arena);
    Error fault_error();
    void begin_anew();
    /// A joint came, went or is steered, which wakes its bodies.
    void touch_joints();
    /// Before a look at the pages of the state.
    PageVersions& looked_at();
    /// Makes the derived sections anew.
    void derive(const DynamicsTables& rows);
    /// Whether a state can be stepped; see validate.h.
    Status validate(StateArena& state, const DynamicsTables* known);

    // Constants of the match.
    WorldSettings settings;
    DynamicsSettings capacities;
    ShapeLibrary shapes;
    std::vector<BodyRecord> pod_starts; // by slot
    std::vector<BodyId> pod_ids;        // by slot

    // The state, and where a snapshot is checked before it becomes the state.
    StateArena arena;
    StateArena staging;

    // Scratch and derived data: nothing that the next tick reads.
    Keeper keeper;
    PageVersions versions;
    bool is_tracked = true; // false: who changes the state's bytes does not tell
    StateHasher hasher;
    Dynamics dynamics;
    PodSystem pods;
    Spawner spawner;
    EventLog events;
    QueryIndex query_index;
    StepFault fault = StepFault::none;
    BodyId fault_body = 0; // that left the bounds
};

/// Whether a body that moves has left the world.
bool is_outside(const BodyMotion& motion, Real bounds);

} // namespace lockwind
