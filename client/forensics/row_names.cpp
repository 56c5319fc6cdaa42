#include "forensics/row_names.h"

#include "base/field_access.h"

namespace lockwind {

std::string to_text(const RowKey& key) {
    std::string text = std::to_string(key.values[0]);
    if (key.kind == RowKey::Kind::pair) {
        text += "-" + std::to_string(key.values[1]);
    }
    return text;
}

RowNames::RowNames(StateSchema schema, std::span<const std::span<const std::byte>> sections)
    : schema_(schema), sections_(sections) {
    for (std::size_t section = 0; section < schema.size() && !entities_; ++section) {
        if (!schema[section].derived && !schema[section].entity_field.empty()) {
            entities_ = section;
        }
    }
}

std::size_t RowNames::row_count(std::size_t section) const {
    return sections_[section].size() / schema_[section].stride_bytes;
}

std::optional<std::size_t> RowNames::find_field(std::size_t section, std::string_view name) const {
    for (std::size_t field = 0; field < schema_[section].fields.size(); ++field) {
        if (schema_[section].fields[field].name == name) {
            return field;
        }
    }
    return std::nullopt;
}

std::uint64_t RowNames::value(std::size_t section, std::size_t row, std::size_t field) const {
    return read_canonical_component(schema_[section].fields[field],
                                    0,
                                    sections_[section].data() +
                                        row * schema_[section].stride_bytes);
}

std::optional<std::uint64_t> RowNames::entity(std::size_t section, std::uint64_t row) const {
    if (row >= row_count(section)) {
        return std::nullopt;
    }
    const std::optional<std::size_t> field = find_field(section, schema_[section].entity_field);
    return field ? std::optional(value(section, static_cast<std::size_t>(row), *field))
                 : std::nullopt;
}

bool RowNames::name_by_pair(std::size_t section, std::vector<RowKey>& keys) const {
    const std::optional<std::size_t> row_a = find_field(section, "row_a");
    const std::optional<std::size_t> row_b = find_field(section, "row_b");
    if (!entities_ || !row_a || !row_b) {
        return false;
    }
    for (std::size_t row = 0; row < keys.size(); ++row) {
        const std::optional<std::uint64_t> a = entity(*entities_, value(section, row, *row_a));
        const std::optional<std::uint64_t> b = entity(*entities_, value(section, row, *row_b));
        if (a && b) {
            keys[row] = {RowKey::Kind::pair, {*a, *b}};
        }
    }
    return true;
}

bool RowNames::name_by_owner(std::size_t section, std::vector<RowKey>& keys) const {
    for (std::size_t owner = 1; owner < schema_.size(); ++owner) {
        const std::optional<std::size_t> field = find_field(owner, schema_[section].name);
        if (owner == section || schema_[owner].derived || !field) {
            continue;
        }
        const std::vector<RowKey> owner_keys = own_keys(owner);
        for (std::size_t row = 0; row < owner_keys.size(); ++row) {
            const std::uint64_t target = value(owner, row, *field);
            if (target < keys.size()) {
                keys[static_cast<std::size_t>(target)] = owner_keys[row];
            }
        }
        return true;
    }
    return false;
}

bool RowNames::name_by_sibling(std::size_t section, std::vector<RowKey>& keys) const {
    const std::string_view name = schema_[section].name;
    for (std::size_t other = 1; other < schema_.size(); ++other) {
        const std::string_view stem = schema_[other].name;
        if (schema_[other].derived || schema_[other].entity_field.empty() ||
            !name.starts_with(stem) || name.substr(stem.size(), 1) != "_" ||
            row_count(other) != keys.size()) {
            continue;
        }
        for (std::size_t row = 0; row < keys.size(); ++row) {
            keys[row] = {RowKey::Kind::entity, {*entity(other, row), 0}};
        }
        return true;
    }
    return false;
}

/// What a section's rows tell without looking at other sections' references to them.
std::vector<RowKey> RowNames::own_keys(std::size_t section) const {
    std::vector<RowKey> keys(row_count(section));
    for (std::size_t row = 0; row < keys.size(); ++row) {
        keys[row].values[0] = row;
        if (const std::optional<std::uint64_t> id =
                schema_[section].entity_field.empty() ? std::nullopt : entity(section, row)) {
            keys[row] = {RowKey::Kind::entity, {*id, 0}};
        }
    }
    if (schema_[section].entity_field.empty() && !name_by_pair(section, keys)) {
        name_by_sibling(section, keys);
    }
    return keys;
}

std::vector<RowKey> RowNames::keys(std::size_t section) const {
    std::vector<RowKey> keys = own_keys(section);
    const bool named = keys.empty() || keys.front().kind != RowKey::Kind::index;
    if (!named) {
        name_by_owner(section, keys);
    }
    return keys;
}

} // namespace lockwind
