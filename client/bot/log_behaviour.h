#pragma once

#include "bot/behaviour.h"

#include <string>

namespace lockwind {

/// Plays what the player of the same slot played in the log's match; idle behind the log's end. An
/// Error where the file is missing, no log or damaged.
Result<std::unique_ptr<Behaviour>> make_log_behaviour(const std::string& path);

} // namespace lockwind
