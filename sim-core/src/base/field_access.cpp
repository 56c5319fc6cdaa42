#include "base/field_access.h"

#include "base/canonical.h"

#include "lockwind/assert.h"

#include <bit>
#include <cstring>

namespace lockwind {

namespace {

std::uint64_t sign_extend(FieldType type, std::uint64_t bits) {
    if (type == FieldType::i32) {
        return static_cast<std::uint64_t>(
            static_cast<std::int64_t>(static_cast<std::int32_t>(static_cast<std::uint32_t>(bits))));
    }
    return bits;
}

bool is_negative(const FieldDescriptor& field, std::uint64_t raw) {
    return is_signed(field.type) && (raw >> 63U) != 0;
}

/// "" or a number in decimal; the whole text must be digits.
std::optional<std::uint32_t> parse_index(std::string_view text) {
    if (text.empty() || text.size() > 9) {
        return std::nullopt;
    }
    std::uint32_t value = 0;
    for (const char digit : text) {
        if (digit < '0' || digit > '9') {
            return std::nullopt;
        }
        value = value * 10 + static_cast<std::uint32_t>(digit - '0');
    }
    return value;
}

/// `text` is what stands behind a field's name: "", ".y" or "[1]".
std::optional<std::uint32_t> parse_component(const FieldDescriptor& field, std::string_view text) {
    if (text.empty()) {
        return 0;
    }
    if (text.size() == 2 && text[0] == '.') {
        const std::size_t index = field.components_as.find(text[1]);
        return index == std::string_view::npos ? std::nullopt
                                               : std::optional(static_cast<std::uint32_t>(index));
    }
    if (text.size() < 3 || text.front() != '[' || text.back() != ']') {
        return std::nullopt;
    }
    const std::optional<std::uint32_t> index = parse_index(text.substr(1, text.size() - 2));
    return index && *index < field.components ? index : std::nullopt;
}

} // namespace

bool is_signed(FieldType type) {
    return type == FieldType::i32 || type == FieldType::i64;
}

std::uint64_t
read_component(const FieldDescriptor& field, std::uint32_t component, const std::byte* row) {
    LOCKWIND_ASSERT(component < field.components);
    const std::size_t size = component_size_bytes(field.type);
    std::byte bytes[8] = {};
    std::memcpy(bytes, row + field.offset_bytes + size * component, size);
    std::uint64_t bits = 0;
    for (std::size_t index = 0; index < size; ++index) {
        const std::size_t significance =
            std::endian::native == std::endian::big ? size - 1 - index : index;
        bits |= std::to_integer<std::uint64_t>(bytes[index]) << (8 * significance);
    }
    return sign_extend(field.type, bits);
}

void write_component(const FieldDescriptor& field,
                     std::uint32_t component,
                     std::byte* row,
                     std::uint64_t raw) {
    LOCKWIND_ASSERT(component < field.components);
    const std::size_t size = component_size_bytes(field.type);
    std::byte* target = row + field.offset_bytes + size * component;
    for (std::size_t index = 0; index < size; ++index) {
        const std::size_t significance =
            std::endian::native == std::endian::big ? size - 1 - index : index;
        target[index] = static_cast<std::byte>((raw >> (8 * significance)) & 0xffU);
    }
}

std::uint64_t read_canonical_component(const FieldDescriptor& field,
                                       std::uint32_t component,
                                       const std::byte* row) {
    LOCKWIND_ASSERT(component < field.components);
    const std::size_t size = component_size_bytes(field.type);
    const std::byte* source = row + field.offset_bytes + size * component;
    std::uint64_t bits = 0;
    for (std::size_t index = 0; index < size; ++index) {
        bits |= std::to_integer<std::uint64_t>(source[index]) << (8 * index);
    }
    return sign_extend(field.type, bits);
}

std::string format_raw(const FieldDescriptor& field, std::uint64_t raw) {
    if (is_negative(field, raw)) {
        return "-" + std::to_string(0 - raw);
    }
    return std::to_string(raw);
}

std::string format_decimal(const FieldDescriptor& field, std::uint64_t raw) {
    LOCKWIND_ASSERT(field.fraction_bits < 60);
    const bool negative = is_negative(field, raw);
    const std::uint64_t magnitude = negative ? 0 - raw : raw;
    const std::uint64_t mask = (std::uint64_t{1} << field.fraction_bits) - 1;
    std::string text = (negative ? "-" : "") + std::to_string(magnitude >> field.fraction_bits);
    std::uint64_t fraction = magnitude & mask;
    if (fraction != 0) {
        text += '.';
    }
    // Each digit frees one bit (10 = 2 x 5), so at most fraction_bits digits; < 2^60 x 10 fits.
    while (fraction != 0) {
        fraction *= 10;
        text += static_cast<char>('0' + (fraction >> field.fraction_bits));
        fraction &= mask;
    }
    return text;
}

std::string component_name(const FieldDescriptor& field, std::uint32_t component) {
    LOCKWIND_ASSERT(component < field.components);
    std::string name(field.name);
    if (!field.components_as.empty()) {
        name += '.';
        name += field.components_as[component];
    } else if (field.components > 1) {
        name += "[" + std::to_string(component) + "]";
    }
    return name;
}

std::optional<FieldPlace> find_field(StateSchema schema, std::string_view path) {
    const std::size_t dot = path.find('.');
    if (dot == std::string_view::npos) {
        return std::nullopt;
    }
    const std::string_view section_name = path.substr(0, dot);
    const std::string_view rest = path.substr(dot + 1);
    const std::string_view field_name = rest.substr(0, rest.find_first_of(".["));
    for (std::uint32_t section = 0; section < schema.size(); ++section) {
        if (schema[section].derived || schema[section].name != section_name) {
            continue;
        }
        for (std::uint32_t index = 0; index < schema[section].fields.size(); ++index) {
            const FieldDescriptor& field = schema[section].fields[index];
            if (field.name != field_name) {
                continue;
            }
            const auto component = parse_component(field, rest.substr(field_name.size()));
            return component ? std::optional(FieldPlace{section, index, *component}) : std::nullopt;
        }
    }
    return std::nullopt;
}

std::uint64_t
entity_of_row(const SectionDescriptor& section, std::uint32_t index, const std::byte* row) {
    for (const FieldDescriptor& field : section.fields) {
        if (!section.entity_field.empty() && field.name == section.entity_field) {
            return read_component(field, 0, row);
        }
    }
    return index;
}

} // namespace lockwind
