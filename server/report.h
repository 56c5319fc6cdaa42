#pragma once

#include "match/match_server.h"

#include <string>

namespace lockwind {

/// One JSON object with the fields of the contract.
std::string report_json(const MatchServer& match);
/// A few lines for a person; ends with a newline.
std::string report_text(const MatchServer& match);

} // namespace lockwind
