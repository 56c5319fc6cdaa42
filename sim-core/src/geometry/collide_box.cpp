#include "geometry/box_face.h"
#include "geometry/pair_kernels.h"

namespace lockwind {

namespace {

// Axes of the cache: 1 .. 3 faces of A, 4 .. 6 faces of B, 7 .. 15 pairs of edges (A's slowest).
constexpr std::uint32_t kFirstFaceB = 4;
constexpr std::uint32_t kFirstEdge = 7;
constexpr std::uint32_t kLastAxis = 15;

// Features: a face contact's is (reference box, both faces, both edges), an edge contact's has
// bit 16.
constexpr std::uint32_t kReferenceIsB = 64;
constexpr std::uint32_t kEdgeFeature = 1U << 16;
constexpr std::uint32_t kDeepCornerFeature = 1U << 17;

/// Cosine (Q2.30) above which two edges are parallel: their cross product is no axis (1.1 degrees).
constexpr std::int32_t kParallelCosine = 1073540000;

/// B in A's frame.
struct Boxes {
    const ShapeInstance& a;
    const ShapeInstance& b;
    const std::int32_t* delta; // world
    std::int32_t cosines[9];   // [3 i + j]: A's axis i times B's axis j, Q2.30
    std::int32_t abs_cosines[9];
    std::int32_t centre[3];         // of B in A's frame
    std::int32_t centre_along_b[3]; // the same vector along B's axes
};

std::int32_t axis_cosine(const std::int32_t* a, int i, const std::int32_t* b, int j) {
    return round_unit(static_cast<std::int64_t>(a[i]) * b[j] +
                      static_cast<std::int64_t>(a[3 + i]) * b[3 + j] +
                      static_cast<std::int64_t>(a[6 + i]) * b[6 + j]);
}

std::int32_t along_axis(const std::int32_t* rotation, int axis, const std::int32_t v[3]) {
    return round_unit(static_cast<std::int64_t>(rotation[axis]) * v[0] +
                      static_cast<std::int64_t>(rotation[3 + axis]) * v[1] +
                      static_cast<std::int64_t>(rotation[6 + axis]) * v[2]);
}

/// Separation on axis `axis` of `first`, without the matrix of the pair; `delta` of either sign.
std::int64_t quick_separation(const ShapeInstance& first,
                              const ShapeInstance& second,
                              const std::int32_t delta[3],
                              int axis) {
    std::int64_t extent = 0;
    for (int other = 0; other < 3; ++other) {
        extent +=
            std::int64_t{magnitude(axis_cosine(first.rotation, axis, second.rotation, other))} *
            second.size[other];
    }
    return std::int64_t{magnitude(along_axis(first.rotation, axis, delta))} - first.size[axis] -
           round_unit_wide(extent);
}

Boxes make_boxes(const ShapeInstance& a, const ShapeInstance& b, const std::int32_t delta[3]) {
    Boxes boxes{a, b, delta, {}, {}, {}, {}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const std::int32_t cosine = axis_cosine(a.rotation, i, b.rotation, j);
            boxes.cosines[3 * i + j] = cosine;
            boxes.abs_cosines[3 * i + j] = magnitude(cosine);
        }
    }
    inverse_rotate(a.rotation, delta, boxes.centre);
    inverse_rotate(b.rotation, delta, boxes.centre_along_b);
    return boxes;
}

std::int64_t separation_on_a(const Boxes& boxes, int i) {
    const std::int32_t* row = boxes.abs_cosines + 3 * i;
    return std::int64_t{magnitude(boxes.centre[i])} - boxes.a.size[i] -
           round_unit_wide(dot_wide(row, boxes.b.size));
}

std::int64_t separation_on_b(const Boxes& boxes, int j) {
    const std::int32_t* c = boxes.abs_cosines + j;
    const std::int64_t extent = static_cast<std::int64_t>(c[0]) * boxes.a.size[0] +
                                static_cast<std::int64_t>(c[3]) * boxes.a.size[1] +
                                static_cast<std::int64_t>(c[6]) * boxes.a.size[2];
    return std::int64_t{magnitude(boxes.centre_along_b[j])} - boxes.b.size[j] -
           round_unit_wide(extent);
}

/// Separation along A's edge i x B's edge j times the sine between them: never farther from 0 than
/// the separation itself.
std::int64_t scaled_edge_separation(const Boxes& boxes, int i, int j) {
    const int i1 = (i + 1) % 3;
    const int i2 = (i + 2) % 3;
    const int j1 = (j + 1) % 3;
    const int j2 = (j + 2) % 3;
    const std::int32_t* c = boxes.cosines;
    const std::int32_t* abs_c = boxes.abs_cosines;
    const std::int32_t* t = boxes.centre;
    const std::int64_t distance = static_cast<std::int64_t>(t[i2]) * c[3 * i1 + j] -
                                  static_cast<std::int64_t>(t[i1]) * c[3 * i2 + j];
    const std::int64_t extent = static_cast<std::int64_t>(boxes.a.size[i1]) * abs_c[3 * i2 + j] +
                                static_cast<std::int64_t>(boxes.a.size[i2]) * abs_c[3 * i1 + j] +
                                static_cast<std::int64_t>(boxes.b.size[j1]) * abs_c[3 * i + j2] +
                                static_cast<std::int64_t>(boxes.b.size[j2]) * abs_c[3 * i + j1];
    return round_unit_wide(magnitude(distance) - extent);
}

/// Sine (Q2.30) between A's edge and B's edge; at least 0.019 unless they are parallel.
std::int64_t edge_sine(const Boxes& boxes, int edges) {
    const std::int64_t cosine = boxes.cosines[edges];
    return static_cast<std::int64_t>(
        floor_sqrt(static_cast<std::uint64_t>((std::int64_t{1} << 60) - cosine * cosine)));
}

bool parallel_edges(const Boxes& boxes, int edges) {
    return boxes.abs_cosines[edges] >= kParallelCosine;
}

/// Face contact with the face that `axis` (1 .. 6) names.
void clip_face(const Boxes& boxes, std::uint32_t axis, FaceContact& face) {
    IncidentBox incident{};
    incident.companion_separation = midway(boxes.a, boxes.b).companion_separation;
    if (axis < kFirstFaceB) {
        incident.reference_half_extents = boxes.a.size;
        incident.half_extents = boxes.b.size;
        for (int index = 0; index < 9; ++index) {
            incident.axes[index] = boxes.cosines[index];
        }
        for (int index = 0; index < 3; ++index) {
            incident.centre[index] = boxes.centre[index];
        }
        clip_to_reference_face(incident, static_cast<int>(axis - 1), face);
        return;
    }
    incident.reference_half_extents = boxes.b.size;
    incident.half_extents = boxes.a.size;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            incident.axes[3 * j + i] = boxes.cosines[3 * i + j];
        }
        incident.centre[i] = -boxes.centre_along_b[i];
    }
    clip_to_reference_face(incident, static_cast<int>(axis - kFirstFaceB), face);
    face.feature |= kReferenceIsB;
}

/// A's local point in B's frame.
void local_b_of(const Boxes& boxes, const std::int32_t local_a[3], std::int32_t local_b[3]) {
    const std::int32_t from_b[3] = {
        local_a[0] - boxes.centre[0], local_a[1] - boxes.centre[1], local_a[2] - boxes.centre[2]};
    inverse_rotate(boxes.cosines, from_b, local_b);
}

/// B's local point in A's frame.
void local_a_of(const Boxes& boxes, const std::int32_t local_b[3], std::int32_t local_a[3]) {
    rotate(boxes.cosines, local_b, local_a);
    for (int component = 0; component < 3; ++component) {
        local_a[component] += boxes.centre[component];
    }
}

void emit_face(const Boxes& boxes,
               std::uint32_t axis,
               const FaceContact& face,
               ManifoldGeometry& out) {
    const bool on_a = axis < kFirstFaceB;
    const ShapeInstance& reference = on_a ? boxes.a : boxes.b;
    const int w = static_cast<int>(on_a ? axis - 1 : axis - kFirstFaceB);
    const int u = (w + 1) % 3;
    const int v = (w + 2) % 3;
    const std::int32_t side = face.positive ? 1 : -1;
    const Midway between = on_a ? midway(boxes.a, boxes.b) : midway(boxes.b, boxes.a);
    axis_of(reference, w, out.normal);
    for (std::int32_t& component : out.normal) {
        component *= on_a ? side : -side;
    }
    for (int index = 0; index < face.count; ++index) {
        const FacePoint& from = face.points[index];
        ManifoldPoint& point = out.points[index];
        std::int32_t* local = on_a ? point.local_a : point.local_b;
        point.separation = raw_saturate<std::int32_t>(from.separation);
        local[u] = static_cast<std::int32_t>(from.place[0]);
        local[v] = static_cast<std::int32_t>(from.place[1]);
        local[w] = side * (reference.size[w] + between.from_first(point.separation));
        if (on_a) {
            local_b_of(boxes, point.local_a, point.local_b);
        } else {
            local_a_of(boxes, point.local_b, point.local_a);
        }
        point.feature =
            face.feature << 6U | static_cast<std::uint32_t>(from.edge_in) << 3U | from.edge_out;
    }
    out.point_count = static_cast<std::uint32_t>(face.count);
}

/// The two edges that face each other along the cross product of A's edge i and B's edge j, in A's
/// frame.
struct EdgePair {
    int i;
    int j;
    std::int32_t normal[3];
    std::int64_t on_a[3]; // a point of each edge: its middle
    std::int64_t on_b[3];
    std::uint32_t sides = 0;
};

EdgePair face_edges(const Boxes& boxes, int edges) {
    EdgePair pair{edges / 3, edges % 3, {}, {}, {}};
    const int i1 = (pair.i + 1) % 3;
    const int i2 = (pair.i + 2) % 3;
    const std::int32_t* c = boxes.cosines;
    std::int32_t across[3] = {0, 0, 0};
    across[i1] = -c[3 * i2 + pair.j];
    across[i2] = c[3 * i1 + pair.j];
    normalise(across, pair.normal);
    if (dot_wide(pair.normal, boxes.centre) < 0) {
        pair.normal[i1] = -pair.normal[i1];
        pair.normal[i2] = -pair.normal[i2];
    }
    for (int axis = 0; axis < 3; ++axis) {
        const bool positive = pair.normal[axis] >= 0;
        const std::int64_t half = boxes.a.size[axis];
        pair.on_a[axis] = axis == pair.i ? 0 : (positive ? half : -half);
        pair.on_b[axis] = boxes.centre[axis];
        pair.sides = pair.sides * 2 + (axis != pair.i && positive ? 1U : 0U);
    }
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t column[3] = {c[axis], c[3 + axis], c[6 + axis]};
        const bool positive = axis != pair.j && dot_wide(pair.normal, column) <= 0;
        pair.sides = pair.sides * 2 + (positive ? 1U : 0U);
        if (axis != pair.j) {
            const std::int32_t half = positive ? boxes.b.size[axis] : -boxes.b.size[axis];
            for (int row = 0; row < 3; ++row) {
                pair.on_b[row] += scale(half, column[row]);
            }
        }
    }
    return pair;
}

/// Contact of two edges where their nearest points lie on both. False where not: a face then tells
/// more.
bool emit_edges(const Boxes& boxes, int edges, ManifoldGeometry& out) {
    const EdgePair pair = face_edges(boxes, edges);
    const std::int64_t cosine = boxes.cosines[edges];
    const std::int32_t direction_b[3] = {
        boxes.cosines[pair.j], boxes.cosines[3 + pair.j], boxes.cosines[6 + pair.j]};
    std::int32_t between[3];
    for (int axis = 0; axis < 3; ++axis) {
        between[axis] = raw_saturate<std::int32_t>(pair.on_b[axis] - pair.on_a[axis]);
    }
    const std::int64_t along_a = between[pair.i];
    const std::int64_t along_b = round_unit_wide(dot_wide(between, direction_b));
    const std::int64_t sine_square = ((std::int64_t{1} << 60) - cosine * cosine) >> kUnitFraction;
    const std::int64_t on_a = (along_a * kUnitOne - cosine * along_b) / sine_square;
    const std::int64_t on_b = (cosine * along_a - along_b * kUnitOne) / sine_square;
    if (magnitude(on_a) > boxes.a.size[pair.i] || magnitude(on_b) > boxes.b.size[pair.j]) {
        return false;
    }
    std::int64_t from[3];
    std::int32_t gap[3];
    for (int axis = 0; axis < 3; ++axis) {
        from[axis] = pair.on_a[axis] + (axis == pair.i ? on_a : 0);
        const std::int64_t to = pair.on_b[axis] + round_unit_wide(on_b * direction_b[axis]);
        gap[axis] = raw_saturate<std::int32_t>(to - from[axis]);
    }
    ManifoldPoint& point = out.points[0];
    point.separation = round_unit(dot_wide(gap, pair.normal));
    const std::int32_t lift = midway(boxes.a, boxes.b).from_first(point.separation);
    std::int32_t middle[3];
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = static_cast<std::int32_t>(from[axis]) + scale(lift, pair.normal[axis]);
    }
    for (int axis = 0; axis < 3; ++axis) {
        point.local_a[axis] = middle[axis];
    }
    local_b_of(boxes, middle, point.local_b);
    point.feature = kEdgeFeature | static_cast<std::uint32_t>(edges) << 6U | pair.sides;
    rotate(boxes.a.rotation, pair.normal, out.normal);
    out.point_count = 1;
    return true;
}

/// The result of the separating-axis test over faces, or the axis that separates.
struct FaceAxes {
    std::uint32_t separating = 0;
    std::uint32_t best = 1;
    std::int64_t best_separation = 0;
};

FaceAxes test_faces(const Boxes& boxes) {
    std::int64_t best[2] = {-(std::int64_t{1} << 40), -(std::int64_t{1} << 40)};
    std::uint32_t axis[2] = {0, 0};
    for (std::uint32_t face = 0; face < 6; ++face) {
        const std::uint32_t side = face / 3;
        const int index = static_cast<int>(face % 3);
        const std::int64_t separation =
            side == 0 ? separation_on_a(boxes, index) : separation_on_b(boxes, index);
        if (separation > kSpeculativeMargin) {
            return {1 + face, 0, separation};
        }
        if (separation > best[side]) {
            best[side] = separation;
            axis[side] = 1 + face;
        }
    }
    // A's face is the reference unless B's is clearly better: equals do not take turns.
    const std::uint32_t side = best[0] + (kLinearSlop >> 2) >= best[1] ? 0 : 1;
    return {0, axis[side], best[side]};
}

constexpr int kNoEdges = -1;

struct EdgeAxes {
    std::uint32_t separating = 0;
    int best = kNoEdges;
    std::int64_t best_separation = 0; // or the threshold
};

/// Looks for edges that separate, or whose separation beats `threshold`. The un-normalised
/// separations decide nearly all of them without a root: scaled by a sine they are never farther
/// from 0.
EdgeAxes test_edges(const Boxes& boxes, std::int64_t threshold) {
    EdgeAxes result{0, kNoEdges, threshold};
    for (int edges = 0; edges < 9; ++edges) {
        if (parallel_edges(boxes, edges)) {
            continue;
        }
        const std::int64_t scaled = scaled_edge_separation(boxes, edges / 3, edges % 3);
        if (scaled > kSpeculativeMargin) {
            return {kFirstEdge + static_cast<std::uint32_t>(edges), kNoEdges, 0};
        }
        if (scaled <= 0 && scaled <= result.best_separation) {
            continue;
        }
        const std::int64_t separation = scaled * kUnitOne / edge_sine(boxes, edges);
        if (separation > kSpeculativeMargin) {
            return {kFirstEdge + static_cast<std::uint32_t>(edges), kNoEdges, 0};
        }
        if (separation > result.best_separation) {
            result.best_separation = separation;
            result.best = edges;
        }
    }
    return result;
}

/// Moves a point to the nearest one of the box that is centred in its frame. False where it is in
/// the box already.
bool move_into(const ShapeInstance& box, std::int32_t point[3]) {
    bool moved = false;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t inside = clamped(point[axis], -box.size[axis], box.size[axis]);
        moved = moved || inside != point[axis];
        point[axis] = inside;
    }
    return moved;
}

/// Moves a point of the incident box (in its frame) towards where the boxes overlap, by nearest
/// points on one and the other in turn (von Neumann's alternating projections).
void move_to_overlap(const Boxes& boxes, bool incident_is_b, std::int32_t point[3]) {
    constexpr int kRounds = 8; // two or three do where this is needed
    for (int round = 0; round < kRounds; ++round) {
        std::int32_t seen[3]; // from the reference box
        if (incident_is_b) {
            local_a_of(boxes, point, seen);
        } else {
            local_b_of(boxes, point, seen);
        }
        if (!move_into(incident_is_b ? boxes.a : boxes.b, seen)) {
            return;
        }
        if (incident_is_b) {
            local_b_of(boxes, seen, point);
        } else {
            local_a_of(boxes, seen, point);
        }
        move_into(incident_is_b ? boxes.b : boxes.a, point);
    }
}

/// Overlapping boxes of which neither faces nor edges gave a point (rounding between nearly equal
/// axes): the other box's deepest corner below the face is the contact. Where an edge lies nearly
/// flat on the face its deepest corner may stand far beside the face: the contact is then where
/// that edge meets the box.
void emit_deep_corner(const Boxes& boxes,
                      std::uint32_t axis,
                      std::int64_t separation,
                      ManifoldGeometry& out) {
    const bool on_a = axis < kFirstFaceB;
    const int w = static_cast<int>(on_a ? axis - 1 : axis - kFirstFaceB);
    const ShapeInstance& reference = on_a ? boxes.a : boxes.b;
    const bool positive = (on_a ? boxes.centre[w] : -boxes.centre_along_b[w]) >= 0;
    ManifoldPoint& point = out.points[0];
    std::int32_t corner[3];
    for (int axis_other = 0; axis_other < 3; ++axis_other) {
        const std::int32_t cosine = boxes.cosines[on_a ? 3 * w + axis_other : 3 * axis_other + w];
        const std::int32_t half = (on_a ? boxes.b : boxes.a).size[axis_other];
        corner[axis_other] = (cosine > 0) == positive ? -half : half;
    }
    move_to_overlap(boxes, on_a, corner);
    axis_of(reference, w, out.normal);
    if (on_a != positive) {
        for (std::int32_t& component : out.normal) {
            component = -component;
        }
    }
    point.separation = raw_saturate<std::int32_t>(separation);
    const Midway between = on_a ? midway(boxes.b, boxes.a) : midway(boxes.a, boxes.b);
    const std::int32_t way = between.from_first(point.separation);
    const std::int32_t lift = positive ? -way : way;
    if (on_a) {
        local_a_of(boxes, corner, point.local_a);
        point.local_a[w] += lift;
        local_b_of(boxes, point.local_a, point.local_b);
    } else {
        local_b_of(boxes, corner, point.local_b);
        point.local_b[w] += lift;
        local_a_of(boxes, point.local_b, point.local_a);
    }
    point.feature = kDeepCornerFeature | axis;
    out.point_count = 1;
}

/// True where the cached axis still separates.
bool still_separated(const ShapeInstance& a,
                     const ShapeInstance& b,
                     const std::int32_t delta[3],
                     std::uint32_t axis) {
    if (axis == 0 || axis >= kFirstEdge) {
        return false;
    }
    const std::int64_t separation =
        axis < kFirstFaceB ? quick_separation(a, b, delta, static_cast<int>(axis - 1))
                           : quick_separation(b, a, delta, static_cast<int>(axis - kFirstFaceB));
    return separation > kSpeculativeMargin;
}

/// The reference face of the last manifold, kept while its separation has changed by less than a
/// slop since it was chosen: a resting box keeps its face.
bool keep_reference_face(const Boxes& boxes, const ManifoldCache& cache, ManifoldGeometry& out) {
    if (cache.axis == 0 || cache.axis >= kFirstEdge) {
        return false;
    }
    FaceContact face;
    clip_face(boxes, cache.axis, face);
    if (face.count == 0 ||
        magnitude(std::int64_t{face.min_separation} - cache.axis_separation) >= kLinearSlop) {
        return false;
    }
    emit_face(boxes, cache.axis, face, out);
    out.axis = cache.axis;
    out.axis_separation = cache.axis_separation;
    return true;
}

void find_contact(const Boxes& boxes, ManifoldGeometry& out) {
    const FaceAxes faces = test_faces(boxes);
    if (faces.separating != 0) {
        out.axis = faces.separating;
        return;
    }
    FaceContact face;
    clip_face(boxes, faces.best, face);
    // A face is preferred, as it gives more points and lasts longer: edges must beat it by a slop.
    const std::int64_t face_separation =
        face.count != 0 ? std::int64_t{face.min_separation} : faces.best_separation;
    const EdgeAxes edges = test_edges(boxes, face_separation + kLinearSlop);
    if (edges.separating != 0) {
        out.axis = edges.separating;
        return;
    }
    if (edges.best != kNoEdges && emit_edges(boxes, edges.best, out)) {
        return;
    }
    if (face.count != 0) {
        emit_face(boxes, faces.best, face, out);
        out.axis = faces.best;
        out.axis_separation = face.min_separation;
    } else if (faces.best_separation <= 0 &&
               (edges.best == kNoEdges || edges.best_separation <= 0)) {
        emit_deep_corner(boxes, faces.best, faces.best_separation, out);
    }
}

} // namespace

void collide_boxes(const ShapeInstance& a,
                   const ShapeInstance& b,
                   const std::int32_t delta[3],
                   const ManifoldCache& cache,
                   ManifoldGeometry& out) {
    if (!cache.touching && still_separated(a, b, delta, cache.axis)) {
        out.axis = cache.axis;
        return;
    }
    const Boxes boxes = make_boxes(a, b, delta);
    if (cache.touching && keep_reference_face(boxes, cache, out)) {
        return;
    }
    if (!cache.touching && cache.axis >= kFirstEdge && cache.axis <= kLastAxis) {
        const int edges = static_cast<int>(cache.axis - kFirstEdge);
        if (!parallel_edges(boxes, edges) &&
            scaled_edge_separation(boxes, edges / 3, edges % 3) > kSpeculativeMargin) {
            out.axis = cache.axis;
            return;
        }
    }
    find_contact(boxes, out);
}

} // namespace lockwind
