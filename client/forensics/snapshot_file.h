#pragma once

#include "forensics/owned_schema.h"
#include "forensics/trace.h"

#include "lockwind/result.h"
#include "lockwind/types.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lockwind {

/// One state in a file that describes itself.
struct Snapshot {
    Party party;
    Tick tick = 0;
    std::uint64_t hash = 0;
    OwnedSchema schema;
    std::vector<std::byte> state; // canonical bytes
};

/// Written under a temporary name, then renamed; an existing file is an Error.
Status write_snapshot(const std::string& path, const Snapshot& snapshot);
Result<Snapshot> read_snapshot(const std::string& path);

} // namespace lockwind
