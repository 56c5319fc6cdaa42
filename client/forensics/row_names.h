#pragma once

#include "lockwind/schema.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lockwind {

/// What a row is about, comparable between two states: one id, two, or its place.
struct RowKey {
    enum class Kind : std::uint8_t { entity = 0, pair = 1, index = 2 };
    Kind kind = Kind::index;
    std::array<std::uint64_t, 2> values{};

    auto operator<=>(const RowKey&) const = default;
};

/// "17", "1-17", "17" (a place).
std::string to_text(const RowKey& key);

/// Tells what the rows of a canonical state are about. Generic, from names alone:
///   - a section's entity field names its rows;
///   - fields `row_a` and `row_b` are rows of the first section with an entity field, and the row
///   is
///     about both;
///   - a section that some other's field is named after (a pair's `manifold`) is about what that
///     one's row is about;
///   - a section named like an entity section, plus "_...", with as many rows, has its entities.
/// What is left is named by its place.
class RowNames {
public:
    /// `sections`: as split_canonical gave them, whole rows. All three must outlive it.
    RowNames(StateSchema schema, std::span<const std::span<const std::byte>> sections);

    std::vector<RowKey> keys(std::size_t section) const;

private:
    std::size_t row_count(std::size_t section) const;
    std::uint64_t value(std::size_t section, std::size_t row, std::size_t field) const;
    std::optional<std::size_t> find_field(std::size_t section, std::string_view name) const;
    std::optional<std::uint64_t> entity(std::size_t section, std::uint64_t row) const;

    bool name_by_pair(std::size_t section, std::vector<RowKey>& keys) const;
    bool name_by_owner(std::size_t section, std::vector<RowKey>& keys) const;
    bool name_by_sibling(std::size_t section, std::vector<RowKey>& keys) const;
    std::vector<RowKey> own_keys(std::size_t section) const;

    StateSchema schema_;
    std::span<const std::span<const std::byte>> sections_;
    std::optional<std::size_t> entities_; // first section with an entity field
};

} // namespace lockwind
