#pragma once

#include "lockwind/assert.h"

#include <cstdint>
#include <span>

namespace lockwind {

/// A view of one section of the arena: `count` live rows (the count itself is arena state), then
/// dead rows, which are all zero bytes.
template <class Row>
class Table {
public:
    Table(Row* rows, std::uint32_t* count, std::uint32_t capacity)
        : rows_(rows), count_(count), capacity_(capacity) {}

    std::uint32_t count() const { return *count_; }
    std::uint32_t capacity() const { return capacity_; }
    std::span<Row> rows() const { return {rows_, *count_}; }
    Row& operator[](std::uint32_t index) const { return rows_[index]; }

    /// Shrinking zeroes the rows that die; growing exposes rows that are zero.
    void set_count(std::uint32_t count) const {
        LOCKWIND_ASSERT(count <= capacity_);
        for (std::uint32_t index = count; index < *count_; ++index) {
            rows_[index] = Row{};
        }
        *count_ = count;
    }

private:
    Row* rows_;
    std::uint32_t* count_;
    std::uint32_t capacity_;
};

} // namespace lockwind
