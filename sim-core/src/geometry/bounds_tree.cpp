#include "geometry/bounds_tree.h"

#include "lockwind/assert.h"

#include <algorithm>

namespace lockwind {

namespace {

std::int64_t centre(const Bounds& bounds, int axis) {
    return std::int64_t{bounds.low[axis]} + bounds.high[axis];
}

} // namespace

BoundsTree::BoundsTree(std::uint32_t capacity) {
    items_.reserve(capacity);
    // A leaf holds at least two items, unless it is the root.
    nodes_.reserve(std::size_t{capacity} + 1);
    unbounded_.reserve(capacity);
}

void BoundsTree::build(std::span<const Bounds> bounds) {
    LOCKWIND_ASSERT(bounds.size() <= items_.capacity());
    items_.clear();
    nodes_.clear();
    unbounded_.clear();
    for (std::uint32_t row = 0; row < bounds.size(); ++row) {
        if (bounds[row] == kUnbounded) {
            unbounded_.push_back(row);
        } else if (bounds[row].low[0] <= bounds[row].high[0]) {
            items_.push_back({bounds[row], row});
        }
    }
    if (!items_.empty()) {
        build_node(0, static_cast<std::uint32_t>(items_.size()));
    }
}

void BoundsTree::build_node(std::uint32_t first, std::uint32_t count) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    const auto begin = items_.begin() + first;
    Bounds around = begin->bounds;
    std::int64_t low[3] = {centre(around, 0), centre(around, 1), centre(around, 2)};
    std::int64_t high[3] = {low[0], low[1], low[2]};
    for (auto item = begin; item != begin + count; ++item) {
        for (int axis = 0; axis < 3; ++axis) {
            around.low[axis] = std::min(around.low[axis], item->bounds.low[axis]);
            around.high[axis] = std::max(around.high[axis], item->bounds.high[axis]);
            low[axis] = std::min(low[axis], centre(item->bounds, axis));
            high[axis] = std::max(high[axis], centre(item->bounds, axis));
        }
    }
    nodes_.push_back({around, first, count, 0});
    if (count <= kLeafItems) {
        return;
    }
    int axis = high[1] - low[1] > high[0] - low[0] ? 1 : 0;
    axis = high[2] - low[2] > high[axis] - low[axis] ? 2 : axis;
    const std::uint32_t half = count / 2;
    std::nth_element(begin, begin + half, begin + count, [axis](const Item& a, const Item& b) {
        const std::int64_t centre_a = centre(a.bounds, axis);
        const std::int64_t centre_b = centre(b.bounds, axis);
        return centre_a != centre_b ? centre_a < centre_b : a.row < b.row;
    });
    build_node(first, half);
    nodes_[index].right = static_cast<std::uint32_t>(nodes_.size());
    build_node(first + half, count - half);
}

} // namespace lockwind
