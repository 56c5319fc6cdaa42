#pragma once

#include "geometry/hull.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// The shapes of a world that are more than three sizes. They follow from its definition alone and
/// never change: every machine builds the same ones, so they are no state. A body's properties hold
/// an index; load() refuses one that leads nowhere.
///
/// Other shapes that bodies share belong here too, a vector and an index each: a compound is a list
/// of (convex shape, place), a height field and a triangle mesh are lists of faces with their
/// grid. A ShapeInstance then points to them as it does to a hull.
class ShapeLibrary {
public:
    ShapeLibrary() = default;
    /// The Error names the hull by its index.
    static Result<ShapeLibrary> create(std::span<const HullDefinition> hulls);

    std::uint32_t hull_count() const { return static_cast<std::uint32_t>(hulls_.size()); }
    /// Stays where it is as long as the library lives.
    const Hull& hull(std::uint32_t index) const { return hulls_[index]; }

private:
    std::vector<Hull> hulls_;
};

} // namespace lockwind
