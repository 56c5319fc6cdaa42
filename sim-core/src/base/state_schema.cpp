#include "base/state_schema.h"

#include "base/canonical.h"
#include "base/state_hash.h"

#include <array>
#include <cstddef>
#include <string_view>

namespace lockwind {

namespace {

constexpr std::array<std::string_view, 6> kTypeNames{"u8", "u16", "u32", "u64", "i32", "i64"};

std::string place(const SectionDescriptor& section, const FieldDescriptor& field) {
    return "schema: " + std::string(section.name) + "." + std::string(field.name) + ": ";
}

Status check_fields(const SectionDescriptor& section) {
    std::size_t claimed_bytes = 0;
    std::size_t widest_bytes = 4;
    for (std::size_t index = 0; index < section.fields.size(); ++index) {
        const FieldDescriptor& field = section.fields[index];
        const std::size_t size = component_size_bytes(field.type);
        widest_bytes = size > widest_bytes ? size : widest_bytes;
        if (field.name.empty() || field.components == 0) {
            return Error{place(section, field) + "no name or no component"};
        }
        if (field.offset_bytes != claimed_bytes) {
            return Error{place(section, field) + "starts at byte " +
                         std::to_string(field.offset_bytes) + ", but bytes are claimed up to " +
                         std::to_string(claimed_bytes)};
        }
        if (field.offset_bytes % size != 0) {
            return Error{place(section, field) + "not at a multiple of its size"};
        }
        if (!field.components_as.empty() && field.components_as.size() != field.components) {
            return Error{place(section, field) + "components_as needs a letter a component"};
        }
        for (std::size_t other = 0; other < index; ++other) {
            if (section.fields[other].name == field.name) {
                return Error{place(section, field) + "the name is taken"};
            }
        }
        claimed_bytes += size * field.components;
    }
    if (claimed_bytes != section.stride_bytes || claimed_bytes % widest_bytes != 0) {
        return Error{"schema: " + std::string(section.name) + ": fields claim " +
                     std::to_string(claimed_bytes) + " bytes of a row of " +
                     std::to_string(section.stride_bytes)};
    }
    return Success{};
}

bool has_field(const SectionDescriptor& section, std::string_view name) {
    for (const FieldDescriptor& field : section.fields) {
        if (field.name == name) {
            return true;
        }
    }
    return false;
}

/// Section 0 holds a u32 for each `state` section, of the same name; derived sections stand last.
Status check_counts(StateSchema schema) {
    const SectionDescriptor& counts = schema[0];
    std::size_t state_count = 0;
    while (state_count < schema.size() && !schema[state_count].derived) {
        ++state_count;
    }
    bool fits = counts.fields.size() == state_count;
    for (std::size_t index = 0; fits && index < schema.size(); ++index) {
        if (index >= state_count) {
            fits = schema[index].derived;
            continue;
        }
        const FieldDescriptor& field = counts.fields[index];
        fits = field.name == schema[index].name && field.type == FieldType::u32 &&
               field.components == 1;
    }
    if (!fits) {
        return Error{"schema: " + std::string(counts.name) +
                     ": must hold one u32 for each state section, named like it; derived sections "
                     "stand last"};
    }
    return Success{};
}

} // namespace

Status check_schema(StateSchema schema) {
    if (schema.empty()) {
        return Error{"schema: no section"};
    }
    for (std::size_t index = 0; index < schema.size(); ++index) {
        const SectionDescriptor& section = schema[index];
        if (Status status = check_fields(section); !status) {
            return status;
        }
        if (!section.entity_field.empty() && !has_field(section, section.entity_field)) {
            return Error{"schema: " + std::string(section.name) + ": no field \"" +
                         std::string(section.entity_field) + "\" to name its entities"};
        }
        for (std::size_t other = 0; other < index; ++other) {
            if (schema[other].name == section.name) {
                return Error{"schema: " + std::string(section.name) + ": the name is taken"};
            }
        }
    }
    return check_counts(schema);
}

std::string describe(StateSchema schema) {
    std::string text;
    for (const SectionDescriptor& section : schema) {
        text += section.derived ? "derived " : "state ";
        text += section.name;
        text += " owner " + std::string(section.owner);
        text += " stride " + std::to_string(section.stride_bytes);
        text += section.entity_field.empty() ? "" : " entity " + std::string(section.entity_field);
        text += "\n";
        for (const FieldDescriptor& field : section.fields) {
            text += "  " + std::to_string(field.offset_bytes) + " ";
            text += kTypeNames[static_cast<std::size_t>(field.type)];
            text += field.components > 1 ? "[" + std::to_string(field.components) + "]" : "";
            text += " " + std::string(field.name);
            text += field.fraction_bits > 0 ? " / 2^" + std::to_string(field.fraction_bits) : "";
            text += field.unit.empty() ? "" : " " + std::string(field.unit);
            text +=
                field.components_as.empty() ? "" : " (" + std::string(field.components_as) + ")";
            text += "\n";
        }
    }
    return text;
}

std::uint64_t schema_digest(StateSchema schema) {
    const std::string text = describe(schema);
    return hash_bytes(std::as_bytes(std::span(text.data(), text.size())));
}

} // namespace lockwind
