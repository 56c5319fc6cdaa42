#pragma once

#include "base/table.h"
#include "dynamics/joint.h"

#include <cstdint>
#include <vector>

namespace lockwind {

/// Pairs of bodies whose joint keeps them from colliding. Scratch, read anew in each tick.
class JoinedPairs {
public:
    explicit JoinedPairs(std::uint32_t joint_capacity) { keys_.reserve(joint_capacity); }
    void read(const Table<Joint>& joints);
    /// row_a < row_b
    bool has(BodyRow row_a, BodyRow row_b) const;

private:
    std::vector<std::uint64_t> keys_; // (lower row, higher row), sorted
};

} // namespace lockwind
