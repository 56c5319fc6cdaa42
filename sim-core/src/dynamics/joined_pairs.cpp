#include "dynamics/joined_pairs.h"

#include <algorithm>

namespace lockwind {

namespace {

std::uint64_t key_of(BodyRow lower, BodyRow higher) {
    return std::uint64_t{lower} << 32U | higher;
}

} // namespace

void JoinedPairs::read(const Table<Joint>& joints) {
    keys_.clear();
    for (const Joint& joint : joints.rows()) {
        if (joint.collide_connected == 0) {
            keys_.push_back(
                key_of(std::min(joint.row_a, joint.row_b), std::max(joint.row_a, joint.row_b)));
        }
    }
    std::sort(keys_.begin(), keys_.end());
}

bool JoinedPairs::has(BodyRow row_a, BodyRow row_b) const {
    return !keys_.empty() && std::binary_search(keys_.begin(), keys_.end(), key_of(row_a, row_b));
}

} // namespace lockwind
