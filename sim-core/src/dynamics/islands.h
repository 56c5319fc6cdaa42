#pragma once

#include "lockwind/types.h"

#include <cstdint>
#include <vector>

namespace lockwind {

/// Sets of bodies that hold on to each other, by union-find. Tarjan, "Efficiency of a Good but Not
/// Linear Set Union Algorithm", JACM 22, 1975, with path halving. A set is named by its lowest row,
/// whatever the order of the joins.
class Islands {
public:
    explicit Islands(std::uint32_t capacity) : parent_(capacity) {}

    /// The row becomes a set of its own.
    void begin(BodyRow row) { parent_[row] = row; }
    void join(BodyRow a, BodyRow b) {
        const BodyRow root_a = find(a);
        const BodyRow root_b = find(b);
        (root_a < root_b ? parent_[root_b] : parent_[root_a]) = root_a < root_b ? root_a : root_b;
    }
    BodyRow find(BodyRow row) {
        while (parent_[row] != row) {
            parent_[row] = parent_[parent_[row]];
            row = parent_[row];
        }
        return row;
    }

private:
    std::vector<BodyRow> parent_;
};

} // namespace lockwind
