#pragma once

#include "lockwind/result.h"
#include "lockwind/schema.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lockwind {

/// One side's value of a field. Both strings are empty where that side has no such row.
struct FieldValue {
    std::string raw;     // the stored integer
    std::string decimal; // its exact value, without the unit

    bool operator==(const FieldValue&) const = default;
};

/// A field that differs.
struct FieldDiff {
    std::string section;
    std::string entity; // id, "1-17" for a row between two of them, else the row's index
    std::string field;  // with its component: "linear_velocity.x"
    std::string unit;
    FieldValue a;
    FieldValue b;
};

struct StateDiff {
    std::vector<FieldDiff> fields; // the first ones, in section, row, field order
    std::size_t count = 0;         // of all fields that differ
};

/// Compares two canonical states field by field; descends into sections and pages that differ only.
/// A section with another number of rows is one difference, "row_count"; its rows are then compared
/// by entity where they name one, else by index. An Error where a state does not fit the schema.
Result<StateDiff> diff_states(StateSchema schema,
                              std::span<const std::byte> a,
                              std::span<const std::byte> b,
                              std::size_t fields_max = 20);

/// Root hash of canonical bytes, computed without a simulation: XXH3-64 over pages, sections, root.
/// An Error where they do not fit the schema.
Result<std::uint64_t> hash_state(StateSchema schema, std::span<const std::byte> state);

/// Names of the schema's `state` sections, in the order of a hash tree's sections.
std::vector<std::string> state_section_names(StateSchema schema);

} // namespace lockwind
