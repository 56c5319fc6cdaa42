#pragma once

#include "session/messages.h"

#include <string>
#include <vector>

namespace lockwind {

/// A setting that differs, both values as text; a scene's text as its first line that differs.
struct ConfigDiff {
    std::string field;
    std::string a;
    std::string b;
};

/// In the order of MatchConfig's fields. The match's name is no setting: it does not change a
/// state.
std::vector<ConfigDiff> diff_configs(const MatchConfig& a, const MatchConfig& b);

} // namespace lockwind
