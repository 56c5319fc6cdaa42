#pragma once

#include "session/messages.h"

#include "lockwind/result.h"
#include "lockwind/world_simulation.h"

#include <memory>

namespace lockwind {

/// state(0) of a match: the world of its scene, seed, players and tick rate. An Error names the
/// place in the scene's text.
Result<std::unique_ptr<WorldSimulation>> create_match_simulation(const MatchConfig& config);

} // namespace lockwind
