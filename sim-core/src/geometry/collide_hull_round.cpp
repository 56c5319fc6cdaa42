#include "geometry/pair_kernels.h"
#include "geometry/polytope.h"
#include "geometry/round_touch.h"
#include "geometry/segments.h"

#include <limits>

namespace lockwind {

namespace {

// Features: a face with the segment's end, an edge, or the nearest point.
constexpr std::uint32_t kNearestFeature = 1;
constexpr std::uint32_t kFaceFeature = 256;
constexpr std::uint32_t kEdgeFeature = 512;

/// The capsule's segment in the hull's frame.
struct HullSegment {
    const Polytope& hull;
    std::int32_t centre[3];
    std::int32_t direction[3];
    std::int32_t half;
    std::int32_t radius;

    void at(std::int64_t along, std::int32_t point[3]) const {
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] =
                raw_saturate<std::int32_t>(centre[axis] + round_unit_wide(along * direction[axis]));
        }
    }
    std::int64_t height(const HullFace& face, std::int64_t along) const {
        std::int32_t point[3];
        at(along, point);
        return height_above(face, point);
    }
    /// Segments as `segments.h` has them: this one is A.
    Segments with_edge(const HullEdge& edge) const;
};

Segments HullSegment::with_edge(const HullEdge& edge) const {
    const std::int32_t* from = hull.vertices[edge.from].place;
    const std::int32_t* to = hull.vertices[edge.to].place;
    Segments s{};
    s.half_a = half;
    s.half_b =
        static_cast<std::int32_t>(round_unit_wide(dot_between(edge.direction, from, to)) >> 1);
    for (int axis = 0; axis < 3; ++axis) {
        s.axis_a[axis] = direction[axis];
        s.axis_b[axis] = edge.direction[axis];
        const std::int64_t middle = (std::int64_t{from[axis]} + to[axis]) >> 1;
        s.delta[axis] = raw_saturate<std::int32_t>(middle - centre[axis]);
    }
    complete(s);
    return s;
}

/// Whether a part of the segment lies inside (Cyrus and Beck's clip).
bool crosses(const HullSegment& segment) {
    Span span{-segment.half, segment.half};
    for (std::uint32_t index = 0; index < segment.hull.face_count; ++index) {
        const HullFace& face = segment.hull.faces[index];
        keep_below(segment.height(face, span.low), segment.height(face, span.high), span);
        if (span.low > span.high) {
            return false;
        }
    }
    return true;
}

/// The segment's and the hull's nearest points.
struct NearestPair {
    std::int32_t along;
    std::int32_t surface[3];
};

/// Of a segment outside: an end above a face, or a point of an edge.
NearestPair nearest_pair(const HullSegment& segment) {
    NearestPair best{};
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (const std::int32_t along : {-segment.half, segment.half}) {
        std::int32_t point[3];
        NearestPoint nearest{};
        segment.at(along, point);
        if (!nearest_point(segment.hull, point, nearest)) {
            continue;
        }
        std::int32_t gap[3];
        for (int axis = 0; axis < 3; ++axis) {
            gap[axis] = raw_saturate<std::int32_t>(std::int64_t{point[axis]} - nearest.place[axis]);
        }
        if (squared_length(gap) < least) {
            least = squared_length(gap);
            best = {along, {nearest.place[0], nearest.place[1], nearest.place[2]}};
        }
    }
    for (std::uint32_t index = 0; index < segment.hull.edge_count; ++index) {
        const Segments s = segment.with_edge(segment.hull.edges[index]);
        const NearestOnA nearest = nearest_of(s);
        if (nearest.square < least) {
            least = nearest.square;
            best.along = nearest.along;
            std::int32_t point[3];
            std::int32_t gap[3];
            segment.at(nearest.along, point);
            between(s, nearest.along, nearest_on_b(s, nearest.along), gap);
            for (int axis = 0; axis < 3; ++axis) {
                best.surface[axis] =
                    raw_saturate<std::int32_t>(std::int64_t{point[axis]} + gap[axis]);
            }
        }
    }
    return best;
}

/// The face whose normal is nearest to a direction.
std::uint32_t face_along(const Polytope& polytope, const std::int32_t direction[3]) {
    std::uint32_t best = 0;
    std::int64_t most = std::numeric_limits<std::int64_t>::min();
    for (std::uint32_t face = 0; face < polytope.face_count; ++face) {
        const std::int64_t cosine = dot_wide(direction, polytope.faces[face].normal);
        best = cosine > most ? face : best;
        most = cosine > most ? cosine : most;
    }
    return best;
}

class HullCapsule {
public:
    HullCapsule(const ShapeInstance& hull,
                const ShapeInstance& capsule,
                const std::int32_t* delta,
                const HullSegment& segment)
        : hull_(hull), capsule_(capsule), delta_(delta), segment_(segment),
          companion_(midway(hull, capsule).companion_separation) {}

    /// Both ends of the segment's part above the face, where the nearer one is as near as
    /// `separation` says.
    bool touch_face(std::uint32_t face, std::int64_t separation, ManifoldGeometry& out) const;
    void touch_nearest(const NearestPair& pair,
                       const std::int32_t normal[3],
                       std::int32_t separation,
                       ManifoldGeometry& out) const;
    /// The segment crosses the hull: an axis of least overlap.
    void touch_deep(ManifoldGeometry& out) const;

private:
    Span above_face(std::uint32_t face) const;
    void add(const RoundTouch& touch, ManifoldGeometry& out) const {
        emit_touch(hull_, capsule_, delta_, touch, out);
    }
    RoundTouch touch_at(std::int64_t along, std::uint32_t face) const;
    bool touch_edge(std::int64_t threshold, ManifoldGeometry& out) const;

    const ShapeInstance& hull_;
    const ShapeInstance& capsule_;
    const std::int32_t* delta_;
    const HullSegment& segment_;
    std::int32_t companion_;
};

/// The part of the segment above or below the face itself, not beside it.
Span HullCapsule::above_face(std::uint32_t face) const {
    Span span{-segment_.half, segment_.half};
    const HullFace& plane = segment_.hull.faces[face];
    for (std::uint32_t corner = 0; corner < plane.corner_count && span.low <= span.high; ++corner) {
        std::int32_t normal[3];
        side_normal(segment_.hull, face, corner, normal);
        const std::int32_t* from = segment_.hull.place(plane, corner);
        const auto beyond = [&](std::int64_t along) {
            std::int32_t point[3];
            segment_.at(along, point);
            return round_unit_wide(dot_between(normal, from, point));
        };
        keep_below(beyond(span.low), beyond(span.high), span);
    }
    return span;
}

/// The segment's point `along` against a face: the hull's point is straight below or above it.
RoundTouch HullCapsule::touch_at(std::int64_t along, std::uint32_t face) const {
    const HullFace& plane = segment_.hull.faces[face];
    RoundTouch touch{};
    segment_.at(along, touch.surface);
    const std::int64_t height = height_above(plane, touch.surface);
    for (int axis = 0; axis < 3; ++axis) {
        touch.normal[axis] = plane.normal[axis];
        touch.surface[axis] -= round_unit(height * plane.normal[axis]);
    }
    touch.separation = raw_saturate<std::int32_t>(height - segment_.radius);
    return touch;
}

bool HullCapsule::touch_face(std::uint32_t face,
                             std::int64_t separation,
                             ManifoldGeometry& out) const {
    const Span span = above_face(face);
    if (span.low > span.high) {
        return false;
    }
    RoundTouch ends[2] = {touch_at(span.low, face), touch_at(span.high, face)};
    const std::int32_t nearer =
        ends[0].separation < ends[1].separation ? ends[0].separation : ends[1].separation;
    if (nearer > kSpeculativeMargin || magnitude(nearer - separation) > kLinearSlop) {
        return false;
    }
    const bool single = span.high - span.low <= kLinearSlop;
    for (std::uint32_t end = 0; end < 2; ++end) {
        if (ends[end].separation > companion_ || (single && ends[end].separation != nearer)) {
            continue;
        }
        ends[end].feature = kFaceFeature + 2 * face + end;
        add(ends[end], out);
        if (single) {
            break;
        }
    }
    return true;
}

void HullCapsule::touch_nearest(const NearestPair& pair,
                                const std::int32_t normal[3],
                                std::int32_t separation,
                                ManifoldGeometry& out) const {
    RoundTouch touch{{pair.surface[0], pair.surface[1], pair.surface[2]},
                     {normal[0], normal[1], normal[2]},
                     separation,
                     kNearestFeature};
    add(touch, out);
}

/// The edge whose cross product with the segment separates them best, where that beats
/// `threshold`. The segment's normals are a great circle of the Gauss map: an edge counts whose arc
/// crosses it.
bool HullCapsule::touch_edge(std::int64_t threshold, ManifoldGeometry& out) const {
    std::int64_t best = threshold;
    RoundTouch touch{};
    for (std::uint32_t index = 0; index < segment_.hull.edge_count; ++index) {
        const HullEdge& edge = segment_.hull.edges[index];
        const std::int32_t* left = segment_.hull.faces[edge.left].normal;
        const std::int32_t* right = segment_.hull.faces[edge.right].normal;
        if ((dot_wide(segment_.direction, left) > 0) == (dot_wide(segment_.direction, right) > 0)) {
            continue;
        }
        const Segments s = segment_.with_edge(edge);
        if (s.sine_square < kParallelSquare) {
            continue;
        }
        std::int32_t across[3];
        for (int axis = 0; axis < 3; ++axis) {
            const int j = (axis + 1) % 3;
            const int k = (axis + 2) % 3;
            across[axis] = round_unit(static_cast<std::int64_t>(s.axis_a[j]) * s.axis_b[k] -
                                      static_cast<std::int64_t>(s.axis_a[k]) * s.axis_b[j]);
        }
        std::int32_t normal[3] = {0, 0, 0};
        normalise(across, normal);
        for (int axis = 0; axis < 3 && dot_wide(across, left) + dot_wide(across, right) < 0;
             ++axis) {
            normal[axis] = -normal[axis];
        }
        const std::int64_t separation = -round_unit_wide(dot_wide(normal, s.delta));
        if (separation <= best) {
            continue;
        }
        best = separation;
        const std::int32_t on_b = nearest_on_b(s, nearest_to_b(s, overlap(s)));
        touch.separation = raw_saturate<std::int32_t>(separation - segment_.radius);
        touch.feature = kEdgeFeature + index;
        for (int axis = 0; axis < 3; ++axis) {
            touch.normal[axis] = normal[axis];
            touch.surface[axis] = raw_saturate<std::int32_t>(
                std::int64_t{segment_.centre[axis]} + s.delta[axis] + scale(on_b, s.axis_b[axis]));
        }
    }
    if (best == threshold) {
        return false;
    }
    add(touch, out);
    return true;
}

void HullCapsule::touch_deep(ManifoldGeometry& out) const {
    std::uint32_t best = 0;
    std::int64_t separation = std::numeric_limits<std::int64_t>::min();
    std::int64_t deepest = 0; // the end that is deepest below the best face
    for (std::uint32_t face = 0; face < segment_.hull.face_count; ++face) {
        const std::int64_t low = segment_.height(segment_.hull.faces[face], -segment_.half);
        const std::int64_t high = segment_.height(segment_.hull.faces[face], segment_.half);
        const std::int64_t lower = low < high ? low : high;
        if (lower > separation) {
            separation = lower;
            best = face;
            deepest = low < high ? -segment_.half : segment_.half;
        }
    }
    if (touch_edge(separation + kLinearSlop, out) ||
        touch_face(best, separation - segment_.radius, out)) {
        return;
    }
    // The deepest end lies beside the face: it alone is the contact.
    RoundTouch touch = touch_at(deepest, best);
    touch.feature = kNearestFeature;
    add(touch, out);
}

} // namespace

void collide_hull_sphere(const ShapeInstance& hull,
                         const ShapeInstance& sphere,
                         const std::int32_t delta[3],
                         ManifoldGeometry& out) {
    BoxFeatures room;
    const Polytope polytope = polytope_of(hull, room);
    std::int32_t centre[3];
    inverse_rotate(hull.rotation, delta, centre);
    NearestPoint nearest{};
    const bool outside = nearest_point(polytope, centre, nearest);
    const HullFace& face = polytope.faces[nearest.face];
    RoundTouch touch{{}, {}, 0, kNearestFeature};
    std::int32_t gap[3];
    for (int axis = 0; axis < 3; ++axis) {
        touch.surface[axis] = nearest.place[axis];
        gap[axis] = raw_saturate<std::int32_t>(std::int64_t{centre[axis]} - nearest.place[axis]);
    }
    std::int64_t distance = height_above(face, centre);
    if (!outside || !nearest.in_edge) {
        // Exactly the face's normal, so that a rolling ball keeps it.
        for (int axis = 0; axis < 3; ++axis) {
            touch.normal[axis] = face.normal[axis];
            touch.surface[axis] = centre[axis] - round_unit(distance * face.normal[axis]);
        }
    } else if (normalise(gap, touch.normal) >= kDirectionMin) {
        distance = round_unit_wide(dot_wide(gap, touch.normal));
    } else {
        std::copy(face.normal, face.normal + 3, touch.normal);
    }
    if (distance - sphere.size[0] > kSpeculativeMargin) {
        return;
    }
    touch.separation = static_cast<std::int32_t>(distance - sphere.size[0]);
    emit_touch(hull, sphere, delta, touch, out);
}

void collide_hull_capsule(const ShapeInstance& hull,
                          const ShapeInstance& capsule,
                          const std::int32_t delta[3],
                          ManifoldGeometry& out) {
    BoxFeatures room;
    const Polytope polytope = polytope_of(hull, room);
    HullSegment segment{polytope, {}, {}, capsule.size[1], capsule.size[0]};
    std::int32_t direction[3];
    axis_of(capsule, 1, direction);
    inverse_rotate(hull.rotation, delta, segment.centre);
    inverse_rotate(hull.rotation, direction, segment.direction);
    const HullCapsule contact(hull, capsule, delta, segment);
    if (crosses(segment)) {
        contact.touch_deep(out);
        return;
    }
    const NearestPair pair = nearest_pair(segment);
    std::int32_t point[3];
    std::int32_t gap[3];
    segment.at(pair.along, point);
    for (int axis = 0; axis < 3; ++axis) {
        gap[axis] = raw_saturate<std::int32_t>(std::int64_t{point[axis]} - pair.surface[axis]);
    }
    const auto reach =
        static_cast<std::uint64_t>(std::int64_t{segment.radius} + kSpeculativeMargin);
    if (squared_length(gap) > reach * reach) {
        return;
    }
    std::int32_t normal[3] = {0, 0, 0};
    const std::int32_t distance = normalise(gap, normal);
    if (distance < kDirectionMin) {
        contact.touch_deep(out);
        return;
    }
    const std::int32_t separation = distance - segment.radius;
    const std::uint32_t face = face_along(polytope, normal);
    const std::int64_t cosine = round_unit_wide(dot_wide(normal, polytope.faces[face].normal));
    if (cosine < kFaceCosine || !contact.touch_face(face, separation, out)) {
        contact.touch_nearest(pair, normal, separation, out);
    }
}

} // namespace lockwind
