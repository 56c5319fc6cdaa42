#include "geometry/pair_kernels.h"
#include "geometry/polytope_pair.h"

#include <limits>

namespace lockwind {

namespace {

// The separating-axis test of two polytopes: D. Gregorius, *The Separating Axis Test between Convex
// Polyhedra*, GDC 2013. All faces; of the pairs of edges those whose arcs cross on the Gauss map,
// for only they make a face of the Minkowski difference.

constexpr std::int64_t kNever = -(std::int64_t{1} << 40);

/// The face that the cache names; damaged state may name none.
bool cached_face(const Polytopes& pair, const ManifoldCache& cache, Reference& reference) {
    if (cache.axis == 0) {
        return false;
    }
    reference = Reference::of_axis(cache.axis);
    return reference.face < pair.polytope[reference.side].face_count;
}

/// The result of the test over faces, or the face that separates.
struct FaceResult {
    bool separates;
    Reference best;
    std::int64_t separation;
};

FaceResult test_faces(const Polytopes& pair) {
    Reference best[2] = {{0, 0}, {1, 0}};
    std::int64_t separation[2] = {kNever, kNever};
    for (std::uint32_t side = 0; side < 2; ++side) {
        for (std::uint32_t face = 0; face < pair.polytope[side].face_count; ++face) {
            const Reference reference{side, face};
            const std::int64_t found = separation_of(pair, reference);
            if (found > kSpeculativeMargin) {
                return {true, reference, found};
            }
            if (found > separation[side]) {
                separation[side] = found;
                best[side] = reference;
            }
        }
    }
    // A's face is the reference unless B's is clearly better: equals do not take turns.
    const int side = separation[0] + (kLinearSlop >> 2) >= separation[1] ? 0 : 1;
    return {false, best[side], separation[side]};
}

/// Which of the other's faces an edge's direction points out of, as bits.
std::uint64_t faces_along(const std::int32_t direction[3], const Polytope& other) {
    std::uint64_t bits = 0;
    for (std::uint32_t face = 0; face < other.face_count; ++face) {
        const bool out = dot_wide(direction, other.faces[face].normal) > 0;
        bits |= std::uint64_t{out ? 1U : 0U} << face;
    }
    return bits;
}

/// Looks for a pair of edges that separates, or whose separation beats `threshold`.
EdgeResult test_edges(const Polytopes& pair, std::int64_t threshold) {
    const Polytope& a = pair.polytope[0];
    const Polytope& b = pair.polytope[1];
    std::uint64_t along_a[kHullEdgesMax] = {};
    for (std::uint32_t edge = 0; edge < a.edge_count; ++edge) {
        std::int32_t direction[3];
        rotate(pair.other[1].rotation, a.edges[edge].direction, direction);
        along_a[edge] = faces_along(direction, b);
    }
    EdgeTest test(pair, threshold);
    for (std::uint32_t edge_b = 0; edge_b < b.edge_count; ++edge_b) {
        std::int32_t direction[3];
        rotate(pair.other[0].rotation, b.edges[edge_b].direction, direction);
        const std::uint64_t along_b = faces_along(direction, a);
        for (std::uint32_t edge_a = 0; edge_a < a.edge_count; ++edge_a) {
            if (arcs_cross(a.edges[edge_a], along_a[edge_a], b.edges[edge_b], along_b) &&
                !test.test(edge_a, edge_b, direction)) {
                return test.result();
            }
        }
    }
    return test.result();
}

/// Which edges of a polytope have a part between two heights above a plane of its own frame.
class EdgesInSlab {
public:
    EdgesInSlab(const Polytope& polytope, const std::int32_t normal[3], std::int64_t offset)
        : polytope_(polytope), normal_(normal), offset_(offset) {}

    bool has(std::uint32_t index, std::int64_t low, std::int64_t high) const {
        const HullEdge& edge = polytope_.edges[index];
        const std::int64_t from = height(edge.from);
        const std::int64_t to = height(edge.to);
        return (from >= low || to >= low) && (from <= high || to <= high);
    }

private:
    std::int64_t height(std::uint32_t vertex) const {
        return round_unit_wide(dot_wide(normal_, polytope_.vertices[vertex].place)) - offset_;
    }
    const Polytope& polytope_;
    const std::int32_t* normal_;
    std::int64_t offset_;
};

/// Polytopes a little apart whose nearest features are edges or corners beside the faces: all pairs
/// of edges near the best face's plane.
void emit_nearest(const Polytopes& pair, const Reference& reference, ManifoldGeometry& out) {
    constexpr std::int64_t kSlack = kSpeculativeMargin + 2 * kHullTolerance;
    const std::uint32_t side = reference.side;
    const HullFace& face = pair.polytope[side].faces[reference.face];
    std::int32_t turned[3];
    inverse_rotate(pair.other[side].rotation, face.normal, turned);
    const EdgesInSlab own(pair.polytope[side], face.normal, face.offset);
    const EdgesInSlab others(
        pair.polytope[1 - side], turned, -height_above(face, pair.other[side].centre));
    const EdgesInSlab& slab_a = side == 0 ? own : others;
    const EdgesInSlab& slab_b = side == 0 ? others : own;
    std::uint64_t least = static_cast<std::uint64_t>(kSpeculativeMargin) * kSpeculativeMargin + 1;
    EdgePair best{};
    std::int32_t best_on_a = 0;
    bool found = false;
    for (std::uint32_t edge_a = 0; edge_a < pair.polytope[0].edge_count; ++edge_a) {
        if (!slab_a.has(edge_a, -kSlack, kSlack)) {
            continue;
        }
        for (std::uint32_t edge_b = 0; edge_b < pair.polytope[1].edge_count; ++edge_b) {
            if (!slab_b.has(edge_b, -kSlack, kSlack)) {
                continue;
            }
            const EdgePair edges = edge_pair(pair, edge_a, edge_b);
            const NearestOnA nearest = nearest_of(edges.segments);
            if (nearest.square < least) {
                least = nearest.square;
                best = edges;
                best_on_a = nearest.along;
                found = true;
            }
        }
    }
    if (!found) {
        return;
    }
    const std::int32_t best_on_b = nearest_on_b(best.segments, best_on_a);
    std::int32_t gap[3];
    between(best.segments, best_on_a, best_on_b, gap);
    std::int32_t normal[3] = {0, 0, 0};
    if (normalise(gap, normal) < kDirectionMin) {
        normal_of(pair, reference, gap);
        inverse_rotate(pair.shape[0]->rotation, gap, normal);
    }
    emit_between(pair, best, best_on_a, best_on_b, normal, out);
    out.points[0].feature |= kNearestFeature;
}

/// Moves a point of the incident polytope (in its frame) towards where the two overlap, by nearest
/// points on one and the other in turn (von Neumann's alternating projections).
void move_to_overlap(const Polytopes& pair, std::uint32_t incident, std::int32_t point[3]) {
    constexpr int kRounds = 8; // two or three do where this is needed
    const std::uint32_t reference = 1 - incident;
    for (int round = 0; round < kRounds; ++round) {
        std::int32_t seen[3];
        NearestPoint nearest{};
        pair.other[reference].move(point, seen);
        if (!nearest_point(pair.polytope[reference], seen, nearest)) {
            return;
        }
        pair.other[incident].move(nearest.place, point);
        if (nearest_point(pair.polytope[incident], point, nearest)) {
            for (int axis = 0; axis < 3; ++axis) {
                point[axis] = nearest.place[axis];
            }
        }
    }
}

/// Overlapping polytopes of which neither faces nor edges gave a point: a point of the overlap is
/// the contact, near the other's corner that is deepest below the face.
void emit_deep_point(const Polytopes& pair,
                     const Reference& reference,
                     std::int64_t separation,
                     ManifoldGeometry& out) {
    const std::uint32_t side = reference.side;
    const Polytope& incident = pair.polytope[1 - side];
    const HullFace& face = pair.polytope[side].faces[reference.face];
    std::int32_t direction[3];
    inverse_rotate(pair.other[side].rotation, face.normal, direction);
    const HullFace& nearest = incident.faces[face_against(incident, direction)];
    std::uint32_t lowest = 0;
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (std::uint32_t corner = 0; corner < nearest.corner_count; ++corner) {
        const std::int64_t height = dot_wide(direction, incident.place(nearest, corner));
        lowest = height < least ? corner : lowest;
        least = height < least ? height : least;
    }
    std::int32_t point[3];
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = incident.place(nearest, lowest)[axis];
    }
    move_to_overlap(pair, 1 - side, point);
    normal_of(pair, reference, out.normal);
    ManifoldPoint& contact = out.points[0];
    contact.separation = raw_saturate<std::int32_t>(separation);
    const Midway between = midway(*pair.shape[1 - side], *pair.shape[side]);
    const std::int32_t way = between.from_first(contact.separation);
    std::int32_t local[3];
    pair.other[side].move(point, local);
    for (int axis = 0; axis < 3; ++axis) {
        local[axis] -= scale(way, face.normal[axis]);
    }
    set_locals(pair, side, local, contact);
    contact.feature = kDeepFeature | reference.axis();
    out.point_count = 1;
}

/// The reference face of the last manifold, kept while its separation has changed by less than a
/// slop since it was chosen: a resting hull keeps its face.
bool keep_reference_face(const Polytopes& pair, const ManifoldCache& cache, ManifoldGeometry& out) {
    Reference reference{};
    if (!cached_face(pair, cache, reference)) {
        return false;
    }
    PolytopeContact contact;
    clip_face(pair, reference, contact);
    if (contact.count == 0 ||
        magnitude(std::int64_t{contact.min_separation} - cache.axis_separation) >= kLinearSlop) {
        return false;
    }
    emit_face(pair, reference, contact, out);
    out.axis = cache.axis;
    out.axis_separation = cache.axis_separation;
    return true;
}

void find_contact(const Polytopes& pair, ManifoldGeometry& out) {
    const FaceResult faces = test_faces(pair);
    if (faces.separates) {
        out.axis = faces.best.axis();
        return;
    }
    PolytopeContact contact;
    clip_face(pair, faces.best, contact);
    const bool has_face = contact.count != 0;
    // A face is preferred, as it gives more points and lasts longer: edges must beat it by a slop.
    // Where it gives none, edges that are nearly as good are asked first.
    const EdgeResult edges =
        test_edges(pair,
                   has_face ? std::int64_t{contact.min_separation} + kLinearSlop
                            : faces.separation - kLinearSlop);
    if (edges.separates || (edges.found && emit_edges(pair, edges, out))) {
        return;
    }
    if (has_face) {
        emit_face(pair, faces.best, contact, out);
        out.axis = faces.best.axis();
        out.axis_separation = contact.min_separation;
    } else if (faces.separation > 0 || (edges.found && edges.separation > 0)) {
        emit_nearest(pair, faces.best, out);
    } else {
        emit_deep_point(pair, faces.best, faces.separation, out);
    }
}

} // namespace

void collide_polytopes(const ShapeInstance& a,
                       const ShapeInstance& b,
                       const std::int32_t delta[3],
                       const ManifoldCache& cache,
                       ManifoldGeometry& out) {
    BoxFeatures room[2];
    const Polytopes pair =
        polytopes_of(a, polytope_of(a, room[0]), b, polytope_of(b, room[1]), delta);
    Reference reference{};
    if (!cache.touching && cached_face(pair, cache, reference) &&
        separation_of(pair, reference) > kSpeculativeMargin) {
        out.axis = cache.axis;
        return;
    }
    if (!cache.touching || !keep_reference_face(pair, cache, out)) {
        find_contact(pair, out);
    }
}

} // namespace lockwind
