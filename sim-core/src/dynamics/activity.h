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

    /// The part of `whole` that concerns the dynamic rows that `takes(row)` takes, and those that
    /// are not dynamic.
    template <class Takes>
    void read_part(const Activity& whole, const DynamicsTables& tables, Takes takes) {
        begin(tables.sleep.count());
        const auto is_ours = [&](BodyRow row) {
            return row != kNoIndex && whole.is_awake(row) && is_dynamic(tables, row) && takes(row);
        };
        for (const BodyRow row : whole.rows()) {
            if (!is_dynamic(tables, row) || takes(row)) {
                part_[row] = Part::awake;
                rows_.push_back(row);
            }
        }
        for (const std::uint32_t index : whole.pairs()) {
            const Pair& pair = tables.pairs[index];
            if (pair.point_count != 0 && (is_ours(pair.row_a) || is_ours(pair.row_b))) {
                pairs_.push_back(index);
                add_partner(pair.row_a);
                add_partner(pair.row_b);
            }
        }
        for (const std::uint32_t index : whole.joints()) {
            const Joint& joint = tables.joints[index];
            if (is_ours(joint.row_a) || is_ours(joint.row_b)) {
                joints_.push_back(index);
                add_partner(joint.row_b);
                if (joint.row_a != kNoIndex) {
                    add_partner(joint.row_a);
                }
            }
        }
    }

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
    void begin(std::uint32_t row_count);
    void add_partner(BodyRow row);
    static bool is_dynamic(const DynamicsTables& tables, BodyRow row);

    std::uint32_t row_count_ = 0;
    std::vector<BodyRow> rows_;
    std::vector<BodyRow> partners_;
    std::vector<Part> part_; // by row
    std::vector<std::uint32_t> pairs_;
    std::vector<std::uint32_t> joints_;
};

} // namespace lockwind
