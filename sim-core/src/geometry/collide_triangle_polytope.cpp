#include "geometry/bounds.h"
#include "geometry/polytope_pair.h"
#include "geometry/triangle.h"

#include <algorithm>
#include <limits>

namespace lockwind {

namespace {

/// A triangle as the kernels of polytopes see it: one face that a contact may be on, and past it
/// those that the arcs of its edges lead to on the Gauss map (of closed edges, back to the face
/// itself: no arc).
struct TriangleFeatures {
    HullVertex vertices[3];
    HullFace faces[4]; // the triangle; across each edge
    HullEdge edges[3];
    HullCorner corners[3];

    explicit TriangleFeatures(const Triangle& triangle);
    Polytope polytope() const { return {vertices, faces, edges, corners, 3, 1, 3}; }
};

TriangleFeatures::TriangleFeatures(const Triangle& triangle)
    : vertices{}, faces{}, edges{}, corners{} {
    HullFace& face = faces[0];
    std::copy(triangle.normal, triangle.normal + 3, face.normal);
    face.corner_count = 3;
    std::int64_t offset = std::numeric_limits<std::int64_t>::min();
    for (std::uint8_t corner = 0; corner < 3; ++corner) {
        const auto next = static_cast<std::uint8_t>((corner + 1) % 3);
        std::copy(triangle.corners[corner], triangle.corners[corner] + 3, vertices[corner].place);
        vertices[corner].faces = 1;
        const TriangleEdge& edge = triangle.edges[corner];
        const std::int32_t* direction = edge.direction;
        const auto across = static_cast<std::uint8_t>(corner + 1);
        edges[corner] = {{direction[0], direction[1], direction[2]}, corner, next, 0, across};
        corners[corner] = {corner, corner};
        const std::int32_t* limit = edge.is_open ? edge.limit : triangle.normal;
        std::copy(limit, limit + 3, faces[across].normal);
        offset =
            std::max(offset, round_unit_wide(dot_wide(triangle.normal, triangle.corners[corner])));
    }
    face.offset = static_cast<std::int32_t>(offset);
}

/// Q9.22 m: how far from its centre a polytope may touch.
std::int64_t reach_of(const ShapeInstance& shape) {
    const std::int32_t radius = shape.type == ShapeType::hull
                                    ? shape.hull->bounding_radius
                                    : bounding_radius(shape.type, shape.size);
    return std::int64_t{radius} + kSpeculativeMargin;
}

class TrianglePolytope {
public:
    TrianglePolytope(const Triangle& triangle, const Polytopes& pair)
        : triangle_(triangle), pair_(pair) {}

    void touch(ManifoldGeometry& out) const;

private:
    /// The face whose normal is a contact's, and how high the other lies above it.
    struct Best {
        Reference reference;
        std::int64_t separation;
    };
    bool find_face(Best& best) const;
    bool is_allowed(const HullFace& face) const;
    EdgeResult test_edges(std::int64_t threshold) const;

    const Triangle& triangle_;
    const Polytopes& pair_;
};

/// Whether the triangle may be touched along the face's normal: by its lowest corner.
bool TrianglePolytope::is_allowed(const HullFace& face) const {
    std::int32_t outwards[3];
    rotate(pair_.other[0].rotation, face.normal, outwards);
    const std::int32_t back[3] = {-outwards[0], -outwards[1], -outwards[2]};
    int lowest = 0;
    std::int64_t most = dot_wide(back, triangle_.corners[0]);
    for (int corner = 1; corner < 3; ++corner) {
        const std::int64_t along = dot_wide(back, triangle_.corners[corner]);
        lowest = along > most ? corner : lowest;
        most = std::max(along, most);
    }
    return is_over_corner(triangle_, lowest, back);
}

/// False where a face of either separates them.
bool TrianglePolytope::find_face(Best& best) const {
    best.reference = {0, 0};
    best.separation = separation_of(pair_, best.reference);
    if (best.separation > kSpeculativeMargin) {
        return false;
    }
    // The triangle's own face is the reference unless another is clearly better.
    std::int64_t threshold = best.separation + (kLinearSlop >> 2);
    for (std::uint32_t face = 0; face < pair_.polytope[1].face_count; ++face) {
        const Reference reference{1, face};
        const std::int64_t separation = separation_of(pair_, reference);
        if (separation > kSpeculativeMargin) {
            return false;
        }
        if (separation > threshold && is_allowed(pair_.polytope[1].faces[face])) {
            best = {reference, separation};
            threshold = separation;
        }
    }
    return true;
}

/// Only over open edges: the others have no arc to cross.
EdgeResult TrianglePolytope::test_edges(std::int64_t threshold) const {
    EdgeTest test(pair_, threshold);
    const Polytope& triangle = pair_.polytope[0];
    const Polytope& other = pair_.polytope[1];
    for (std::uint32_t edge_b = 0; edge_b < other.edge_count; ++edge_b) {
        std::int32_t direction_b[3];
        rotate(pair_.other[0].rotation, other.edges[edge_b].direction, direction_b);
        std::uint64_t along_b = 0;
        for (std::uint32_t face = 0; face < 4; ++face) {
            const bool out = dot_wide(direction_b, triangle.faces[face].normal) > 0;
            along_b |= std::uint64_t{out ? 1U : 0U} << face;
        }
        for (std::uint32_t edge_a = 0; edge_a < 3; ++edge_a) {
            if (!triangle_.edges[edge_a].is_open) {
                continue;
            }
            std::int32_t direction_a[3];
            rotate(pair_.other[1].rotation, triangle.edges[edge_a].direction, direction_a);
            std::uint64_t along_a = 0;
            for (const std::uint32_t face : {other.edges[edge_b].left, other.edges[edge_b].right}) {
                const bool out = dot_wide(direction_a, other.faces[face].normal) > 0;
                along_a |= std::uint64_t{out ? 1U : 0U} << face;
            }
            if (arcs_cross(triangle.edges[edge_a], along_a, other.edges[edge_b], along_b) &&
                !test.test(edge_a, edge_b, direction_b)) {
                return test.result();
            }
        }
    }
    return test.result();
}

void TrianglePolytope::touch(ManifoldGeometry& out) const {
    Best best{};
    if (!find_face(best)) {
        return;
    }
    PolytopeContact contact;
    clip_face(pair_, best.reference, contact);
    const bool has_face = contact.count != 0;
    // As of two polytopes: edges must beat a face by a slop.
    const EdgeResult edges =
        test_edges(has_face ? std::int64_t{contact.min_separation} + kLinearSlop
                            : best.separation - kLinearSlop);
    if (edges.separates || (edges.found && emit_edges(pair_, edges, out))) {
        return;
    }
    if (has_face) {
        emit_face(pair_, best.reference, contact, out);
    }
}

} // namespace

void collide_triangle_polytope(const ShapeInstance& surface,
                               const ShapeInstance& other,
                               const std::int32_t delta[3],
                               ManifoldGeometry& out) {
    std::int32_t centre[3];
    inverse_rotate(surface.rotation, delta, centre);
    const std::int64_t height = Triangle::height_above(*surface.surface, surface.part, centre);
    // What has its centre behind a triangle is left to others, or let go.
    if (height < 0 || height > reach_of(other)) {
        return;
    }
    const Triangle triangle = triangle_of(*surface.surface, surface.part);
    const TriangleFeatures features(triangle);
    BoxFeatures room;
    const Polytopes pair =
        polytopes_of(surface, features.polytope(), other, polytope_of(other, room), delta);
    TrianglePolytope(triangle, pair).touch(out);
}

} // namespace lockwind
