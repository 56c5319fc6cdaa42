#pragma once

#include "base/table.h"

#include "lockwind/assert.h"
#include "lockwind/schema.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace lockwind {

/// All state of a simulation: one relocatable, zeroed, 64-byte aligned buffer. Sections lie at
/// fixed offsets that follow from the schema and the capacities; rows hold indices, never pointers.
///
/// Section 0 is the arena's own: one row, one u32 for each section of the schema, in order: how
/// many of its rows live. Rows behind those are zero.
class StateArena {
public:
    static constexpr std::size_t kAlignmentBytes = 64;

    /// `capacities`: rows of each section; capacities[0] is 1. The schema must outlive the arena.
    StateArena(StateSchema schema, std::span<const std::uint32_t> capacities);

    StateSchema schema() const { return schema_; }
    std::uint32_t section_count() const { return static_cast<std::uint32_t>(schema_.size()); }
    std::uint32_t state_section_count() const { return state_section_count_; }
    std::uint32_t capacity(std::uint32_t section) const { return places_[section].capacity; }
    std::uint32_t row_count(std::uint32_t section) const { return *count(section); }
    /// Shrinking zeroes the rows that die.
    void set_row_count(std::uint32_t section, std::uint32_t new_count);

    template <class Row>
    Table<Row> table(std::uint32_t section) {
        static_assert(std::is_trivially_copyable_v<Row> && alignof(Row) <= kAlignmentBytes);
        LOCKWIND_ASSERT(section < section_count() && sizeof(Row) == schema_[section].stride_bytes);
        return {reinterpret_cast<Row*>(buffer_.get() + places_[section].offset_bytes),
                count(section),
                places_[section].capacity};
    }

    /// Live rows, in this machine's byte order.
    std::span<std::byte> live_bytes(std::uint32_t section);
    std::span<const std::byte> live_bytes(std::uint32_t section) const;

    /// The whole buffer, dead rows and gaps between sections too.
    std::span<const std::byte> buffer() const { return {buffer_.get(), size_bytes_}; }

    /// Back to no rows, but section 0's.
    void clear();

private:
    struct Place {
        std::size_t offset_bytes;
        std::uint32_t capacity;
    };
    struct Free {
        void operator()(std::byte* buffer) const;
    };

    const std::uint32_t* count(std::uint32_t section) const {
        return section < state_section_count_
                   ? reinterpret_cast<const std::uint32_t*>(buffer_.get()) + section
                   : derived_counts_.data() + (section - state_section_count_);
    }
    std::uint32_t* count(std::uint32_t section) {
        return const_cast<std::uint32_t*>(std::as_const(*this).count(section));
    }

    StateSchema schema_;
    std::uint32_t state_section_count_ = 0;
    std::vector<Place> places_;
    std::vector<std::uint32_t> derived_counts_;
    std::size_t size_bytes_ = 0;
    std::unique_ptr<std::byte, Free> buffer_;
};

} // namespace lockwind
