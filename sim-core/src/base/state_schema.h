#pragma once

#include "lockwind/result.h"
#include "lockwind/schema.h"

#include <cstdint>
#include <string>

namespace lockwind {

/// Checks what every part that walks a schema relies on: names unique and not empty, fields in
/// offset order, each byte of a row claimed by exactly one field, components at multiples of their
/// size (so that no compiler pads, i686 included), section 0 the row counts. The Error names
/// section and field.
Status check_schema(StateSchema schema);

/// The schema as text, one line a section and a field. The same on every architecture.
std::string describe(StateSchema schema);

/// XXH3-64 of describe(schema).
std::uint64_t schema_digest(StateSchema schema);

} // namespace lockwind
