#pragma once

#include "dynamics/dynamics.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Who is awake in this tick, and the pairs that concern them: what every phase goes over, so that
/// sleeping bodies cost nothing but the look at their flags. Scratch of one tick.
class Activity {
public:
    Activity(std::uint32_t body_capacity, std::uint32_t pair_capacity);

    void read_rows(const Table<BodySleep>& sleep);
    /// After read_rows and the broad phase.
    void read_pairs(const Table<Pair>& pairs);

    /// In row order.
    std::span<const BodyRow> rows() const { return rows_; }
    /// Sleeping rows that pairs() name, each once.
    std::span<const BodyRow> partners() const { return partners_; }
    /// Indices of pairs with a row that is awake, in pair order.
    std::span<const std::uint32_t> pairs() const { return pairs_; }
    bool is_awake(BodyRow row) const { return part_[row] == Part::awake; }

private:
    enum class Part : std::uint8_t { none = 0, awake = 1, partner = 2 };
    void add_partner(BodyRow row);

    std::uint32_t row_count_ = 0;
    std::vector<BodyRow> rows_;
    std::vector<BodyRow> partners_;
    std::vector<Part> part_; // by row
    std::vector<std::uint32_t> pairs_;
};

} // namespace lockwind
