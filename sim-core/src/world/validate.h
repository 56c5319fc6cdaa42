#pragma once

#include "dynamics/dynamics.h"
#include "systems/player.h"
#include "systems/spawn.h"
#include "world/state.h"

#include "lockwind/result.h"
#include "lockwind/world_definition.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

// Whether rows are such as a step leaves them: a state that passes can be stepped without leaving a
// table or a loop without end. An Error names section, row and field. Constants of the match are
// compared, what a body's shape implies is made anew and compared; the rest is held to ranges.
// Forged velocities and impulses that pass one by one may together leave the solver's formats: then
// they wrap, as all arithmetic does, and a CHECKED build traps.

Status check_globals(const Table<Globals>& globals);
Status check_players(const Table<Player>& players, std::span<const BodyId> pods);
/// `known`, where given, is a sound state: what its kinds are built of is not made anew.
Status check_kinds(const DynamicsTables& tables,
                   const DynamicsTables* known,
                   Spawner& spawner,
                   const WorldSettings& settings,
                   const ShapeLibrary& shapes);
/// Of sound kinds, whose properties the bodies have.
Status check_bodies(const DynamicsTables& tables, const LevelOfDetail& detail);
/// Of bodies that are sound.
Status check_joints(const DynamicsTables& tables);
/// Of sound bodies. Makes the pairs anew, which follow from the rest.
Status check_contacts(const DynamicsTables& tables, Dynamics& dynamics);

} // namespace lockwind
