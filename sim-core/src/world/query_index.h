#pragma once

#include "dynamics/dynamics.h"
#include "geometry/bounds_tree.h"
#include "geometry/shape_instance.h"
#include "geometry/shape_library.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lockwind {

/// What queries look up about bodies as they stand between two changes: turned shapes, and a tree
/// of their tight bounds. (Fat bounds would not do: they are of where bodies were before the last
/// step moved them.) Scratch; it decides what a query costs, never what it finds.
class QueryIndex {
public:
    explicit QueryIndex(std::uint32_t body_capacity);
    /// Bodies have come, gone or moved.
    void drop() { is_current_ = false; }
    /// Builds what was dropped.
    void refresh(const DynamicsTables& tables, const ShapeLibrary& shapes);

    const BoundsTree& tree() const { return tree_; }
    ShapeInstance
    shape(BodyRow row, const DynamicsTables& tables, const ShapeLibrary& shapes) const;

private:
    using Rotation = std::array<std::int32_t, 9>;

    bool is_current_ = false;
    std::vector<Rotation> rotations_; // by row
    std::vector<Bounds> bounds_;      // by row
    BoundsTree tree_;
};

/// Tight bounds of a shape (not a plane) at a place, grown by 2^-15 m at least.
Bounds query_bounds(const ShapeInstance& shape, const std::int64_t centre[3]);

} // namespace lockwind
