#include "geometry/pair_kernels.h"
#include "geometry/polytope_face.h"
#include "geometry/segments.h"

#include <bit>
#include <limits>

namespace lockwind {

namespace {

// The separating-axis test of two polytopes: D. Gregorius, *The Separating Axis Test between Convex
// Polyhedra*, GDC 2013. All faces; of the pairs of edges those whose arcs cross on the Gauss map,
// for only they make a face of the Minkowski difference.

// Axes of the cache: 1 .. 64 faces of A, 65 .. 128 faces of B.
constexpr std::uint32_t kFirstFaceB = 1 + kHullFacesMax;

// Features: a face contact's is (reference, both faces, both edges), others have a bit of their
// own and both edges.
constexpr int kEdgeBits = 7;
constexpr int kFaceBits = 6;
constexpr std::uint32_t kReferenceIsB = 1U << (2 * kEdgeBits + 2 * kFaceBits);
constexpr std::uint32_t kEdgeFeature = kReferenceIsB << 1U;
constexpr std::uint32_t kNearestFeature = kReferenceIsB << 2U;
constexpr std::uint32_t kDeepFeature = kReferenceIsB << 3U;

/// Squared sine (Q60) of 1.1 degrees: below it two edges are parallel, and their cross product is
/// no axis.
constexpr std::int64_t kParallelEdges = (std::int64_t{1} << 60) / 2713;
constexpr std::int64_t kNever = -(std::int64_t{1} << 40);

struct Polytopes {
    const ShapeInstance* shape[2];
    Polytope polytope[2];
    FramePlace other[2]; // [0]: B in A's frame; [1]: A in B's
};

Polytopes make_polytopes(const ShapeInstance& a,
                         const ShapeInstance& b,
                         const std::int32_t delta[3],
                         BoxFeatures (&room)[2]) {
    Polytopes pair{{&a, &b}, {polytope_of(a, room[0]), polytope_of(b, room[1])}, {}};
    FramePlace& b_in_a = pair.other[0];
    FramePlace& a_in_b = pair.other[1];
    for (int i = 0; i < 3; ++i) {
        std::int32_t axis_a[3];
        axis_of(a, i, axis_a);
        for (int j = 0; j < 3; ++j) {
            std::int32_t axis_b[3];
            axis_of(b, j, axis_b);
            const std::int32_t cosine = round_unit(dot_wide(axis_a, axis_b));
            b_in_a.rotation[3 * i + j] = cosine;
            a_in_b.rotation[3 * j + i] = cosine;
        }
    }
    const std::int32_t back[3] = {-delta[0], -delta[1], -delta[2]};
    inverse_rotate(a.rotation, delta, b_in_a.centre);
    inverse_rotate(b.rotation, back, a_in_b.centre);
    return pair;
}

/// A face of one of the two.
struct Reference {
    std::uint32_t side; // 0: A, 1: B
    std::uint32_t face;

    static Reference of_axis(std::uint32_t axis) {
        return axis < kFirstFaceB ? Reference{0, axis - 1} : Reference{1, axis - kFirstFaceB};
    }
    std::uint32_t axis() const { return side == 0 ? 1 + face : kFirstFaceB + face; }
};

/// The face that the cache names; damaged state may name none.
bool cached_face(const Polytopes& pair, const ManifoldCache& cache, Reference& reference) {
    if (cache.axis == 0) {
        return false;
    }
    reference = Reference::of_axis(cache.axis);
    return reference.face < pair.polytope[reference.side].face_count;
}

std::int64_t separation_of(const Polytopes& pair, const Reference& reference) {
    return face_separation(pair.polytope[reference.side],
                           reference.face,
                           pair.polytope[1 - reference.side],
                           pair.other[reference.side]);
}

void clip_face(const Polytopes& pair, const Reference& reference, PolytopeContact& contact) {
    clip_polytope_face(pair.polytope[reference.side],
                       reference.face,
                       pair.polytope[1 - reference.side],
                       pair.other[reference.side],
                       midway(*pair.shape[0], *pair.shape[1]).companion_separation,
                       contact);
}

/// The normal of a face of either, from A to B.
void normal_of(const Polytopes& pair, const Reference& reference, std::int32_t normal[3]) {
    const std::int32_t* local = pair.polytope[reference.side].faces[reference.face].normal;
    rotate(pair.shape[reference.side]->rotation, local, normal);
    for (int axis = 0; axis < 3 && reference.side == 1; ++axis) {
        normal[axis] = -normal[axis];
    }
}

/// A point of the reference's frame in both.
void set_locals(const Polytopes& pair,
                std::uint32_t side,
                const std::int32_t local[3],
                ManifoldPoint& point) {
    std::int32_t* own = side == 0 ? point.local_a : point.local_b;
    std::int32_t* others = side == 0 ? point.local_b : point.local_a;
    for (int axis = 0; axis < 3; ++axis) {
        own[axis] = local[axis];
    }
    pair.other[1 - side].move(local, others);
}

void emit_face(const Polytopes& pair,
               const Reference& reference,
               const PolytopeContact& contact,
               ManifoldGeometry& out) {
    const std::uint32_t side = reference.side;
    const HullFace& face = pair.polytope[side].faces[reference.face];
    const Midway between = midway(*pair.shape[side], *pair.shape[1 - side]);
    normal_of(pair, reference, out.normal);
    for (int index = 0; index < contact.count; ++index) {
        const FacePoint& from = contact.points[index];
        ManifoldPoint& point = out.points[index];
        point.separation = raw_saturate<std::int32_t>(from.separation);
        const std::int64_t height =
            std::int64_t{face.offset} + between.from_first(point.separation);
        std::int32_t local[3];
        for (int axis = 0; axis < 3; ++axis) {
            local[axis] =
                round_unit(from.place[0] * contact.axes.u[axis] +
                           from.place[1] * contact.axes.v[axis] + height * face.normal[axis]);
        }
        set_locals(pair, side, local, point);
        point.feature = (side != 0 ? kReferenceIsB : 0U) |
                        reference.face << (2 * kEdgeBits + kFaceBits) |
                        contact.incident_face << (2 * kEdgeBits) |
                        static_cast<std::uint32_t>(from.edge_in) << kEdgeBits | from.edge_out;
    }
    out.point_count = static_cast<std::uint32_t>(contact.count);
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

/// Whether the arcs of two edges cross: the ends of each lie on different sides of the other, and
/// they meet on one side of the sphere, not on opposite ones. B's arc is that of the negative
/// normals. (Gregorius; an edge's direction is the cross product of its two normals.)
bool arcs_cross(const HullEdge& edge_a,
                std::uint64_t along_a,
                const HullEdge& edge_b,
                std::uint64_t along_b) {
    const std::uint64_t left_b = along_a >> edge_b.left & 1U;
    const std::uint64_t left_a = along_b >> edge_a.left & 1U;
    return left_b != (along_a >> edge_b.right & 1U) && left_a != (along_b >> edge_a.right & 1U) &&
           left_b == left_a;
}

/// Two edges in A's frame, by their middles.
struct EdgePair {
    std::uint32_t edge_a;
    std::uint32_t edge_b;
    std::int32_t middle_a[3];
    Segments segments;
};

void middle_of(const Polytope& polytope,
               const HullEdge& edge,
               std::int32_t middle[3],
               std::int32_t& half) {
    const std::int32_t* from = polytope.vertices[edge.from].place;
    const std::int32_t* to = polytope.vertices[edge.to].place;
    half = static_cast<std::int32_t>(round_unit_wide(dot_between(edge.direction, from, to)) >> 1);
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = static_cast<std::int32_t>((std::int64_t{from[axis]} + to[axis]) >> 1);
    }
}

EdgePair edge_pair(const Polytopes& pair, std::uint32_t edge_a, std::uint32_t edge_b) {
    EdgePair edges{edge_a, edge_b, {}, {}};
    Segments& s = edges.segments;
    const HullEdge& a = pair.polytope[0].edges[edge_a];
    const HullEdge& b = pair.polytope[1].edges[edge_b];
    std::int32_t middle[3];
    std::int64_t middle_b[3];
    middle_of(pair.polytope[0], a, edges.middle_a, s.half_a);
    middle_of(pair.polytope[1], b, middle, s.half_b);
    pair.other[0].move_far(middle, middle_b);
    rotate(pair.other[0].rotation, b.direction, s.axis_b);
    for (int axis = 0; axis < 3; ++axis) {
        s.axis_a[axis] = a.direction[axis];
        s.delta[axis] = raw_saturate<std::int32_t>(middle_b[axis] - edges.middle_a[axis]);
    }
    complete(s);
    return edges;
}

struct EdgeResult {
    bool separates = false;
    bool found = false;
    std::uint32_t edge_a = 0;
    std::uint32_t edge_b = 0;
    std::int32_t normal[3] = {0, 0, 0}; // A's frame, outwards, Q2.30 but for the sine
    std::int64_t separation = 0;        // or the threshold
};

/// One pair of edges whose arcs cross.
class EdgeTest {
public:
    EdgeTest(const Polytopes& pair, std::int64_t threshold) : pair_(pair) {
        result_.separation = threshold;
    }
    const EdgeResult& result() const { return result_; }

    /// False once a pair of edges separates.
    bool test(std::uint32_t edge_a, std::uint32_t edge_b, const std::int32_t direction_b[3]) {
        const HullEdge& a = pair_.polytope[0].edges[edge_a];
        const HullEdge& b = pair_.polytope[1].edges[edge_b];
        std::int32_t normal[3];
        std::int64_t square = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const int j = (axis + 1) % 3;
            const int k = (axis + 2) % 3;
            normal[axis] = round_unit(static_cast<std::int64_t>(a.direction[j]) * direction_b[k] -
                                      static_cast<std::int64_t>(a.direction[k]) * direction_b[j]);
            square += static_cast<std::int64_t>(normal[axis]) * normal[axis];
        }
        if (square < kParallelEdges) {
            return true;
        }
        std::int64_t between_edges[3];
        pair_.other[0].move_far(pair_.polytope[1].vertices[b.from].place, between_edges);
        for (int axis = 0; axis < 3; ++axis) {
            between_edges[axis] -= pair_.polytope[0].vertices[a.from].place[axis];
        }
        const std::int64_t outwards = dot_wide(normal, pair_.polytope[0].faces[a.left].normal) +
                                      dot_wide(normal, pair_.polytope[0].faces[a.right].normal);
        for (int axis = 0; axis < 3 && outwards < 0; ++axis) {
            normal[axis] = -normal[axis];
        }
        // Scaled by the sine between the edges: never farther from 0 than the separation itself.
        const std::int64_t scaled = round_unit_wide(dot_far(normal, between_edges));
        if (scaled <= 0 && scaled <= result_.separation) {
            return true;
        }
        const auto sine = static_cast<std::int64_t>(floor_sqrt(static_cast<std::uint64_t>(square)));
        const std::int64_t separation = scaled * kUnitOne / sine;
        if (separation > kSpeculativeMargin) {
            result_.separates = true;
            return false;
        }
        if (separation > result_.separation) {
            result_ = {false, true, edge_a, edge_b, {normal[0], normal[1], normal[2]}, separation};
        }
        return true;
    }

private:
    const Polytopes& pair_;
    EdgeResult result_;
};

/// Looks for a pair of edges that separates, or whose separation beats `threshold`.
EdgeResult test_edges(const Polytopes& pair, std::int64_t threshold) {
    const Polytope& a = pair.polytope[0];
    const Polytope& b = pair.polytope[1];
    std::uint64_t along_a[kHullEdgesMax];
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

/// One point between A's point `on_a` of its edge and B's of its own. `normal`: A's frame.
void emit_between(const Polytopes& pair,
                  const EdgePair& edges,
                  std::int32_t on_a,
                  std::int32_t on_b,
                  const std::int32_t normal[3],
                  ManifoldGeometry& out) {
    const Segments& s = edges.segments;
    std::int32_t gap[3];
    between(s, on_a, on_b, gap);
    ManifoldPoint& point = out.points[0];
    point.separation = round_unit(dot_wide(gap, normal));
    const std::int32_t lift = midway(*pair.shape[0], *pair.shape[1]).from_first(point.separation);
    std::int32_t middle[3];
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] =
            edges.middle_a[axis] + scale(on_a, s.axis_a[axis]) + scale(lift, normal[axis]);
    }
    set_locals(pair, 0, middle, point);
    rotate(pair.shape[0]->rotation, normal, out.normal);
    point.feature = edges.edge_a << kEdgeBits | edges.edge_b;
    out.point_count = 1;
}

/// Contact of two edges where their nearest points lie on both. False where not: a face then tells
/// more.
bool emit_edges(const Polytopes& pair, const EdgeResult& best, ManifoldGeometry& out) {
    const EdgePair edges = edge_pair(pair, best.edge_a, best.edge_b);
    const Segments& s = edges.segments;
    const std::int64_t sine_square = s.sine_square >> kUnitFraction;
    const std::int64_t on_a = (s.along_a * kUnitOne - s.cosine * s.along_b) / sine_square;
    const std::int64_t on_b = (s.cosine * s.along_a - s.along_b * kUnitOne) / sine_square;
    if (magnitude(on_a) > s.half_a || magnitude(on_b) > s.half_b) {
        return false;
    }
    std::int32_t normal[3] = {0, 0, 0};
    normalise(best.normal, normal);
    emit_between(
        pair, edges, static_cast<std::int32_t>(on_a), static_cast<std::int32_t>(on_b), normal, out);
    out.points[0].feature |= kEdgeFeature;
    return true;
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
    const Polytopes pair = make_polytopes(a, b, delta, room);
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
