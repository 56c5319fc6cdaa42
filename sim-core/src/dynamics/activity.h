#pragma once

#include "dynamics/dynamics.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Who is awake in this tick, and the pairs and joints that concern them: what every phase goes
/// over, so that sleeping bodies cost nothing but the look at their flags. Scratch of one tick.
class Activity {
public:
    explicit Activity(const DynamicsSettings& capacities);

    void read_rows(const Table<BodySleep>& sleep);
    /// After read_rows and the broad phase.
    void read_pairs(const Table<Pair>& pairs);
    /// After read_rows.
    void read_joints(const Table<Joint>& joints);

    /// In row order.
    std::span<const BodyRow> rows() const { return rows_; }
    /// Sleeping rows that pairs() and joints() name, each once.
    std::span<const BodyRow> partners() const { return partners_; }
    /// Indices of pairs with a row that is awake, in pair order.
    std::span<const std::uint32_t> pairs() const { return pairs_; }
    /// Rows of the joints with a body that is awake, ascending.
    std::span<const std::uint32_t> joints() const { return joints_; }
    bool is_awake(BodyRow row) const { return part_[row] == Part::awake; }

private:
    enum class Part : std::uint8_t { none = 0, awake = 1, partner = 2 };
    void add_partner(BodyRow row);

    std::uint32_t row_count_ = 0;
    std::vector<BodyRow> rows_;
    std::vector<BodyRow> partners_;
    std::vector<Part> part_; // by row
    std::vector<std::uint32_t> pairs_;
    std::vector<std::uint32_t> joints_;
};

} // namespace lockwind
