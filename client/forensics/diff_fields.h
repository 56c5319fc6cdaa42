#pragma once

#include "forensics/config_diff.h"
#include "forensics/diff.h"

namespace lockwind {

/// Shared by the comparisons: what differs, taken into a result.

void set_fields(DiffResult& result, StateDiff diff);
void set_hashes(DiffResult& result, std::uint64_t a, std::uint64_t b);
void set_settings(DiffResult& result, const std::vector<ConfigDiff>& differing);

} // namespace lockwind
