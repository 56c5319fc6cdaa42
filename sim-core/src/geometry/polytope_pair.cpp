#include "geometry/polytope_pair.h"

namespace lockwind {

namespace {

/// Squared sine (Q60) of 1.1 degrees: below it two edges are parallel, and their cross product is
/// no axis.
constexpr std::int64_t kParallelEdges = (std::int64_t{1} << 60) / 2713;

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

} // namespace

Polytopes polytopes_of(const ShapeInstance& a,
                       const Polytope& polytope_a,
                       const ShapeInstance& b,
                       const Polytope& polytope_b,
                       const std::int32_t delta[3]) {
    Polytopes pair{{&a, &b}, {polytope_a, polytope_b}, {}};
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

void normal_of(const Polytopes& pair, const Reference& reference, std::int32_t normal[3]) {
    const std::int32_t* local = pair.polytope[reference.side].faces[reference.face].normal;
    rotate(pair.shape[reference.side]->rotation, local, normal);
    for (int axis = 0; axis < 3 && reference.side == 1; ++axis) {
        normal[axis] = -normal[axis];
    }
}

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

bool arcs_cross(const HullEdge& edge_a,
                std::uint64_t along_a,
                const HullEdge& edge_b,
                std::uint64_t along_b) {
    const std::uint64_t left_b = along_a >> edge_b.left & 1U;
    const std::uint64_t left_a = along_b >> edge_a.left & 1U;
    return left_b != (along_a >> edge_b.right & 1U) && left_a != (along_b >> edge_a.right & 1U) &&
           left_b == left_a;
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

bool EdgeTest::test(std::uint32_t edge_a, std::uint32_t edge_b, const std::int32_t direction_b[3]) {
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

} // namespace lockwind
