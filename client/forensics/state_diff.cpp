#include "forensics/state_diff.h"

#include "base/canonical.h"
#include "base/field_access.h"
#include "base/state_hash.h"
#include "forensics/row_names.h"

#include <algorithm>
#include <cstring>

namespace lockwind {

namespace {

using Sections = std::vector<std::span<const std::byte>>;

/// A row of one side: its key and its place.
struct KeyedRow {
    RowKey key;
    std::size_t row;
};

/// The rows of both sides that are about the same thing; one side may lack it.
struct RowPair {
    RowKey key;
    const std::byte* a;
    const std::byte* b;
};

class StateComparison {
public:
    StateComparison(StateSchema schema,
                    const Sections& a,
                    const Sections& b,
                    std::size_t fields_max)
        : schema_(schema), a_(a), b_(b), names_a_(schema, a), names_b_(schema, b),
          fields_max_(fields_max) {}

    StateDiff run() {
        // Section 0 counts the rows of the others, and is told with them.
        for (std::size_t section = 1; section < schema_.size(); ++section) {
            if (!schema_[section].derived && !equal(section)) {
                compare_section(section);
            }
        }
        return std::move(diff_);
    }

private:
    bool equal(std::size_t section) const {
        return std::equal(
            a_[section].begin(), a_[section].end(), b_[section].begin(), b_[section].end());
    }

    void add(FieldDiff field) {
        ++diff_.count;
        if (diff_.fields.size() < fields_max_) {
            diff_.fields.push_back(std::move(field));
        }
    }

    void compare_section(std::size_t section) {
        const std::size_t stride = schema_[section].stride_bytes;
        const std::size_t count_a = a_[section].size() / stride;
        const std::size_t count_b = b_[section].size() / stride;
        if (count_a != count_b) {
            const std::string text_a = std::to_string(count_a);
            const std::string text_b = std::to_string(count_b);
            add({std::string(schema_[section].name),
                 "",
                 "row_count",
                 "",
                 {text_a, text_a},
                 {text_b, text_b}});
        }
        const std::size_t before = diff_.count;
        for (const RowPair& rows : match_rows(section)) {
            compare_rows(section, rows);
        }
        if (diff_.count == before && count_a == count_b) {
            // The same rows in other places: what differs is where they are.
            for (const RowPair& rows : match_places(section)) {
                compare_rows(section, rows);
            }
        }
    }

    const std::byte* row_a(std::size_t section, std::size_t row) const {
        return a_[section].data() + row * schema_[section].stride_bytes;
    }
    const std::byte* row_b(std::size_t section, std::size_t row) const {
        return b_[section].data() + row * schema_[section].stride_bytes;
    }

    static std::vector<KeyedRow> sort_rows(const std::vector<RowKey>& keys) {
        std::vector<KeyedRow> rows;
        for (std::size_t row = 0; row < keys.size(); ++row) {
            rows.push_back({keys[row], row});
        }
        std::stable_sort(rows.begin(), rows.end(), [](const KeyedRow& left, const KeyedRow& right) {
            return left.key < right.key;
        });
        return rows;
    }

    static bool unique(const std::vector<KeyedRow>& rows) {
        return std::adjacent_find(
                   rows.begin(), rows.end(), [](const KeyedRow& left, const KeyedRow& right) {
                       return left.key == right.key;
                   }) == rows.end();
    }

    std::vector<RowPair> match_rows(std::size_t section) const {
        const std::vector<KeyedRow> a = sort_rows(names_a_.keys(section));
        const std::vector<KeyedRow> b = sort_rows(names_b_.keys(section));
        if (!unique(a) || !unique(b)) {
            return match_places(section);
        }
        std::vector<RowPair> pairs;
        std::size_t at_a = 0;
        std::size_t at_b = 0;
        while (at_a < a.size() || at_b < b.size()) {
            const bool take_a = at_b == b.size() || (at_a < a.size() && a[at_a].key <= b[at_b].key);
            const bool take_b = at_a == a.size() || (at_b < b.size() && b[at_b].key <= a[at_a].key);
            pairs.push_back({take_a ? a[at_a].key : b[at_b].key,
                             take_a ? row_a(section, a[at_a].row) : nullptr,
                             take_b ? row_b(section, b[at_b].row) : nullptr});
            at_a += take_a ? 1 : 0;
            at_b += take_b ? 1 : 0;
        }
        if (schema_[section].entity_field.empty()) {
            join_strays(section, pairs);
        }
        return pairs;
    }

    /// The only row that one side lacks; nullptr where it lacks none or several.
    static RowPair* only_one_without(const std::byte* RowPair::*side, std::vector<RowPair>& pairs) {
        RowPair* found = nullptr;
        for (RowPair& pair : pairs) {
            if (pair.*side != nullptr) {
                continue;
            }
            if (found != nullptr) {
                return nullptr;
            }
            found = &pair;
        }
        return found;
    }

    /// What names such a row is made of its own fields: where each side has one row without a
    /// partner, in the same place, they are one row in which such a field differs.
    void join_strays(std::size_t section, std::vector<RowPair>& pairs) const {
        RowPair* const of_a = only_one_without(&RowPair::b, pairs);
        RowPair* const of_b = only_one_without(&RowPair::a, pairs);
        if (of_a != nullptr && of_b != nullptr &&
            of_a->a - row_a(section, 0) == of_b->b - row_b(section, 0)) {
            of_a->b = of_b->b;
            pairs.erase(pairs.begin() + (of_b - pairs.data()));
        }
    }

    std::vector<RowPair> match_places(std::size_t section) const {
        const std::vector<RowKey> keys = names_a_.keys(section);
        const std::size_t count_b = b_[section].size() / schema_[section].stride_bytes;
        std::vector<RowPair> pairs;
        for (std::size_t row = 0; row < std::max(keys.size(), count_b); ++row) {
            const RowKey place{RowKey::Kind::index, {row, 0}};
            pairs.push_back({row < keys.size() ? keys[row] : place,
                             row < keys.size() ? row_a(section, row) : nullptr,
                             row < count_b ? row_b(section, row) : nullptr});
        }
        return pairs;
    }

    void compare_rows(std::size_t section, const RowPair& rows) {
        const SectionDescriptor& described = schema_[section];
        if (rows.a == nullptr || rows.b == nullptr) {
            add_missing(described, rows);
            return;
        }
        if (std::memcmp(rows.a, rows.b, described.stride_bytes) == 0) {
            return;
        }
        for (const FieldDescriptor& field : described.fields) {
            for (std::uint32_t component = 0; component < field.components; ++component) {
                const std::uint64_t a = read_canonical_component(field, component, rows.a);
                const std::uint64_t b = read_canonical_component(field, component, rows.b);
                if (a != b) {
                    add({std::string(described.name),
                         to_text(rows.key),
                         component_name(field, component),
                         std::string(field.unit),
                         {format_raw(field, a), format_decimal(field, a)},
                         {format_raw(field, b), format_decimal(field, b)}});
                }
            }
        }
    }

    /// A row that one side lacks, told by its first field: its id, where it has one.
    void add_missing(const SectionDescriptor& described, const RowPair& rows) {
        const auto named = std::find_if(
            described.fields.begin(), described.fields.end(), [&](const FieldDescriptor& field) {
                return field.name == described.entity_field;
            });
        const FieldDescriptor& field =
            named == described.fields.end() ? described.fields.front() : *named;
        const auto value_of = [&](const std::byte* row) {
            if (row == nullptr) {
                return FieldValue{};
            }
            const std::uint64_t raw = read_canonical_component(field, 0, row);
            return FieldValue{format_raw(field, raw), format_decimal(field, raw)};
        };
        add({std::string(described.name),
             to_text(rows.key),
             component_name(field, 0),
             std::string(field.unit),
             value_of(rows.a),
             value_of(rows.b)});
    }

    StateSchema schema_;
    const Sections& a_;
    const Sections& b_;
    RowNames names_a_;
    RowNames names_b_;
    std::size_t fields_max_;
    StateDiff diff_;
};

std::uint64_t hash_words(std::span<const std::uint64_t> words) {
    std::vector<std::byte> bytes;
    for (const std::uint64_t word : words) {
        for (std::uint32_t index = 0; index < 8; ++index) {
            bytes.push_back(static_cast<std::byte>((word >> (8 * index)) & 0xffU));
        }
    }
    return hash_bytes(bytes);
}

} // namespace

Result<StateDiff> diff_states(StateSchema schema,
                              std::span<const std::byte> a,
                              std::span<const std::byte> b,
                              std::size_t fields_max) {
    const Result<Sections> sections_a = split_canonical(schema, a);
    const Result<Sections> sections_b = split_canonical(schema, b);
    if (!sections_a || !sections_b) {
        return sections_a ? sections_b.error() : sections_a.error();
    }
    return StateComparison(schema, sections_a.value(), sections_b.value(), fields_max).run();
}

Result<std::uint64_t> hash_state(StateSchema schema, std::span<const std::byte> state) {
    const Result<Sections> sections = split_canonical(schema, state);
    if (!sections) {
        return sections.error();
    }
    std::vector<std::uint64_t> hashes;
    for (std::size_t section = 0; section < schema.size(); ++section) {
        if (schema[section].derived) {
            continue;
        }
        std::vector<std::uint64_t> pages;
        std::span<const std::byte> rest = sections.value()[section];
        while (!rest.empty()) {
            const std::size_t size = std::min(rest.size(), kHashPageBytes);
            pages.push_back(hash_bytes(rest.first(size)));
            rest = rest.subspan(size);
        }
        hashes.push_back(hash_words(pages));
    }
    return hash_words(hashes);
}

std::vector<std::string> state_section_names(StateSchema schema) {
    std::vector<std::string> names;
    for (const SectionDescriptor& section : schema) {
        if (!section.derived) {
            names.emplace_back(section.name);
        }
    }
    return names;
}

} // namespace lockwind
