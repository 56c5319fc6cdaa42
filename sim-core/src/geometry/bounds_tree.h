#pragma once

#include "geometry/axis_bounds.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Bounds in a binary tree, split at the median along the longest side: for queries of any shape
/// and size, where a grid would visit many cells. Built anew from the bounds; its layout decides
/// only what a query costs, never what it finds. A row is the place of its bounds in what was
/// built.
class BoundsTree {
public:
    explicit BoundsTree(std::uint32_t capacity);
    /// Empty bounds (low > high along x) are left out.
    void build(std::span<const Bounds> bounds);

    /// Calls visit(row) for each row that is unbounded, then for each whose bounds `cost` (of
    /// Bounds) does not refuse by a negative value, those in cheaper nodes first. What `cost`
    /// refuses of a node's bounds it must refuse of all within; it may refuse more as visits go on.
    template <class Cost, class Visit>
    void visit(Cost&& cost, Visit&& visit) const;

private:
    static constexpr std::uint32_t kLeafItems = 4;
    /// Each level halves the items, and leaves one node waiting.
    static constexpr std::uint32_t kStackSize = 40;

    struct Item {
        Bounds bounds;
        std::uint32_t row;
    };
    struct Node {
        Bounds bounds;
        std::uint32_t first; // item
        std::uint32_t count; // of items
        std::uint32_t right; // node; the left one follows its parent; 0: a leaf
    };

    void build_node(std::uint32_t first, std::uint32_t count);
    template <class Cost, class Visit>
    void visit_items(const Node& node, Cost&& cost, Visit&& visit) const;

    std::vector<Item> items_;
    std::vector<Node> nodes_; // in preorder
    std::vector<std::uint32_t> unbounded_;
};

template <class Cost, class Visit>
void BoundsTree::visit_items(const Node& node, Cost&& cost, Visit&& visit) const {
    for (std::uint32_t item = node.first; item < node.first + node.count; ++item) {
        if (cost(items_[item].bounds) >= 0) {
            visit(items_[item].row);
        }
    }
}

template <class Cost, class Visit>
void BoundsTree::visit(Cost&& cost, Visit&& visit) const {
    for (const std::uint32_t row : unbounded_) {
        visit(row);
    }
    std::uint32_t stack[kStackSize];
    std::uint32_t height = 0;
    std::uint32_t index = 0;
    bool is_taken = !nodes_.empty() && cost(nodes_[0].bounds) >= 0;
    for (;;) {
        if (!is_taken) {
            if (height == 0) {
                return;
            }
            index = stack[--height];
            is_taken = cost(nodes_[index].bounds) >= 0; // it may be refused by now
            continue;
        }
        const Node& node = nodes_[index];
        if (node.right == 0) {
            visit_items(node, cost, visit);
            is_taken = false;
            continue;
        }
        const std::int64_t left = cost(nodes_[index + 1].bounds);
        const std::int64_t right = cost(nodes_[node.right].bounds);
        const bool left_first = right < 0 || (left >= 0 && left <= right);
        if (left >= 0 && right >= 0) {
            stack[height++] = left_first ? node.right : index + 1;
        }
        index = left_first ? index + 1 : node.right;
        is_taken = left >= 0 || right >= 0;
    }
}

} // namespace lockwind
