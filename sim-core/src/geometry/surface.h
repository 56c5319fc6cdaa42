#pragma once

#include "geometry/bounds_tree.h"

#include "lockwind/result.h"
#include "lockwind/shape.h"
#include "lockwind/types.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// A triangle of a surface, by its vertices, counter-clockwise seen from its front.
struct SurfaceTriangle {
    std::uint32_t corners[3];
    std::uint32_t neighbours[3]; // across the edge from corner i to the next; kNoIndex for none
    std::int32_t normal[3];      // Q2.30, to the front
};

/// Triangles that bodies touch from their front: a mesh or a height field, in a frame whose origin
/// is the middle of its bounds. Never changes once it is made.
class Surface {
public:
    using Point = std::array<std::int32_t, 3>; // Q9.22 m

    std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles_.size()); }
    const SurfaceTriangle& triangle(std::uint32_t index) const { return triangles_[index]; }
    const std::int32_t* place(std::uint32_t vertex) const { return vertices_[vertex].data(); }
    const std::int32_t* corner(std::uint32_t triangle, std::uint32_t corner) const {
        return place(triangles_[triangle].corners[corner]);
    }
    /// Vertices that share an edge with this one.
    std::span<const std::uint32_t> ring(std::uint32_t vertex) const {
        return {rings_.data() + ring_starts_[vertex], rings_.data() + ring_starts_[vertex + 1]};
    }
    /// Of the triangles around a vertex, weighted by their angles there: which side of them a point
    /// lies on whose nearest place is the vertex (Baerentzen and Aanaes 2005). Q2.30.
    const std::int32_t* outwards(std::uint32_t vertex) const { return outwards_[vertex].data(); }
    /// Of triangle_bounds().
    const BoundsTree& tree() const { return tree_; }
    /// Q15.16 m, rounded outwards.
    Bounds triangle_bounds(std::uint32_t index) const;

    /// Where the own frame's origin lies in the given one, Q9.22 m.
    const std::int32_t* centre() const { return centre_.data(); }
    /// Q9.22 m: of the farthest vertex, rounded up, and on each axis.
    std::int32_t bounding_radius() const { return bounding_radius_; }
    const std::int32_t* half_extents() const { return half_extents_.data(); }

private:
    friend class SurfaceMaker;
    Surface() : tree_(0) {}

    std::vector<Point> vertices_;
    std::vector<Point> outwards_; // by vertex
    std::vector<SurfaceTriangle> triangles_;
    std::vector<std::uint32_t> ring_starts_; // by vertex, and the end
    std::vector<std::uint32_t> rings_;
    BoundsTree tree_;
    Point centre_{};
    Point half_extents_{};
    std::int32_t bounding_radius_ = 0;
};

/// An Error says what is wrong, and reads after the surface's name.
Result<Surface> make_mesh(const MeshDefinition& definition);
Result<Surface> make_height_field(const HeightFieldDefinition& definition);

} // namespace lockwind
