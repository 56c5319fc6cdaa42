#include "base/canonical.h"

#include "base/field_access.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace lockwind {

namespace {

std::uint32_t read_u32_le(const std::byte* bytes) {
    return std::to_integer<std::uint32_t>(bytes[0]) |
           std::to_integer<std::uint32_t>(bytes[1]) << 8U |
           std::to_integer<std::uint32_t>(bytes[2]) << 16U |
           std::to_integer<std::uint32_t>(bytes[3]) << 24U;
}

/// `state` sections, which stand first.
std::uint32_t state_section_count(StateSchema schema) {
    return schema[0].stride_bytes / static_cast<std::uint32_t>(sizeof(std::uint32_t));
}

std::uint32_t row_count(std::span<const std::byte> bytes, std::uint32_t section) {
    return read_u32_le(bytes.data() + section * sizeof(std::uint32_t));
}

Error size_error(std::size_t actual, std::uint64_t expected) {
    return Error{"snapshot: " + std::to_string(actual) + " bytes, but its row counts need " +
                 std::to_string(expected)};
}

/// Checks the size against the counts.
Status check_size(StateSchema schema, std::span<const std::byte> bytes) {
    if (bytes.size() < schema[0].stride_bytes) {
        return size_error(bytes.size(), schema[0].stride_bytes);
    }
    if (row_count(bytes, 0) != 1) {
        return Error{"snapshot: section \"" + std::string(schema[0].name) + "\" must have 1 row"};
    }
    std::uint64_t expected = 0;
    for (std::uint32_t section = 0; section < state_section_count(schema); ++section) {
        expected += std::uint64_t{schema[section].stride_bytes} * row_count(bytes, section);
    }
    if (bytes.size() != expected) {
        return size_error(bytes.size(), expected);
    }
    return Success{};
}

} // namespace

std::size_t component_size_bytes(FieldType type) {
    switch (type) {
    case FieldType::u8:
        return 1;
    case FieldType::u16:
        return 2;
    case FieldType::u32:
    case FieldType::i32:
        return 4;
    case FieldType::u64:
    case FieldType::i64:
        return 8;
    }
    LOCKWIND_ASSERT(false && "unknown FieldType");
    return 0;
}

void swap_rows(const SectionDescriptor& section, std::span<std::byte> rows) {
    LOCKWIND_ASSERT(rows.size() % section.stride_bytes == 0);
    for (std::size_t row = 0; row < rows.size(); row += section.stride_bytes) {
        for (const FieldDescriptor& field : section.fields) {
            const std::size_t size = component_size_bytes(field.type);
            std::byte* component = rows.data() + row + field.offset_bytes;
            for (std::uint32_t index = 0; index < field.components; ++index, component += size) {
                std::reverse(component, component + size);
            }
        }
    }
}

std::size_t canonical_size_bytes(const StateArena& arena) {
    std::size_t size = 0;
    for (std::uint32_t section = 0; section < arena.state_section_count(); ++section) {
        size += arena.live_bytes(section).size();
    }
    return size;
}

void save_canonical(const StateArena& arena, std::vector<std::byte>& out) {
    out.resize(canonical_size_bytes(arena));
    std::byte* next = out.data();
    for (std::uint32_t section = 0; section < arena.state_section_count(); ++section) {
        const std::span<const std::byte> rows = arena.live_bytes(section);
        if (rows.empty()) {
            continue;
        }
        std::memcpy(next, rows.data(), rows.size());
        if constexpr (std::endian::native == std::endian::big) {
            swap_rows(arena.schema()[section], {next, rows.size()});
        }
        next += rows.size();
    }
}

Result<std::vector<std::span<const std::byte>>> split_canonical(StateSchema schema,
                                                                std::span<const std::byte> bytes) {
    if (Status status = check_size(schema, bytes); !status) {
        return status.error();
    }
    std::vector<std::span<const std::byte>> sections;
    std::size_t offset = 0;
    for (std::uint32_t section = 0; section < state_section_count(schema); ++section) {
        const std::size_t size =
            std::size_t{schema[section].stride_bytes} * row_count(bytes, section);
        sections.push_back(bytes.subspan(offset, size));
        offset += size;
    }
    return sections;
}

Status load_canonical(StateArena& arena, std::span<const std::byte> bytes) {
    const StateSchema schema = arena.schema();
    if (Status status = check_size(schema, bytes); !status) {
        return status;
    }
    std::size_t offset = schema[0].stride_bytes;
    for (std::uint32_t section = 1; section < arena.state_section_count(); ++section) {
        const std::uint32_t count = row_count(bytes, section);
        if (count > arena.capacity(section)) {
            return Error{"snapshot: " + std::to_string(count) + " rows in section \"" +
                         std::string(schema[section].name) + "\", more than its capacity of " +
                         std::to_string(arena.capacity(section))};
        }
        arena.set_row_count(section, count);
        const std::span<std::byte> rows = arena.live_bytes(section);
        if (!rows.empty()) {
            std::memcpy(rows.data(), bytes.data() + offset, rows.size());
        }
        if constexpr (std::endian::native == std::endian::big) {
            swap_rows(schema[section], rows);
        }
        offset += rows.size();
    }
    for (std::uint32_t section = arena.state_section_count(); section < schema.size(); ++section) {
        arena.set_row_count(section, 0);
    }
    return Success{};
}

} // namespace lockwind
