#pragma once

#include "lockwind/schema.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lockwind {

/// A raw component is handed about as 64 bits: the value, sign-extended where its type is signed.

bool is_signed(FieldType type);

/// Of a row in this machine's byte order, `stride_bytes` of the field's section.
std::uint64_t
read_component(const FieldDescriptor& field, std::uint32_t component, const std::byte* row);
/// Keeps the low bits that fit the type.
void write_component(const FieldDescriptor& field,
                     std::uint32_t component,
                     std::byte* row,
                     std::uint64_t raw);
/// Of a row in canonical (little-endian) order, as in a snapshot.
std::uint64_t read_canonical_component(const FieldDescriptor& field,
                                       std::uint32_t component,
                                       const std::byte* row);

/// The raw integer in decimal: "-12884902".
std::string format_raw(const FieldDescriptor& field, std::uint64_t raw);
/// The exact decimal value: "-12.2880001068115234375". Integer arithmetic only; no unit.
std::string format_decimal(const FieldDescriptor& field, std::uint64_t raw);

/// "linear_velocity.y", "motion_sum[1]", or just "id".
std::string component_name(const FieldDescriptor& field, std::uint32_t component);

/// Place of a component in a schema.
struct FieldPlace {
    std::uint32_t section;
    std::uint32_t field;
    std::uint32_t component;
};

/// Finds "section.field", "section.field.y" or "section.field[1]" of the state; without a
/// component, the first.
std::optional<FieldPlace> find_field(StateSchema schema, std::string_view path);

/// What names row `index` (in this machine's byte order): its entity field's value, or the index.
std::uint64_t
entity_of_row(const SectionDescriptor& section, std::uint32_t index, const std::byte* row);

} // namespace lockwind
