#include "geometry/pair_kernels.h"
#include "geometry/round_touch.h"
#include "geometry/segments.h"
#include "geometry/triangle.h"

#include <limits>

namespace lockwind {

namespace {

// Features: the face with the capsule's end, an edge, a corner.
constexpr std::uint32_t kFaceFeature = 1;
constexpr std::uint32_t kEdgeFeature = 16;
constexpr std::uint32_t kCornerFeature = 32;

std::uint32_t feature_of(const TrianglePlace& place) {
    switch (place.feature) {
    case TrianglePlace::Feature::edge:
        return kEdgeFeature + static_cast<std::uint32_t>(place.index);
    case TrianglePlace::Feature::corner:
        return kCornerFeature + static_cast<std::uint32_t>(place.index);
    case TrianglePlace::Feature::face:
        break;
    }
    return kFaceFeature;
}

void gap_between(const std::int32_t from[3], const std::int32_t to[3], std::int32_t gap[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        gap[axis] = raw_saturate<std::int32_t>(std::int64_t{to[axis]} - from[axis]);
    }
}

/// Straight below or above the point, on the triangle's plane.
RoundTouch touch_below(const Triangle& triangle,
                       const std::int32_t point[3],
                       std::int32_t radius,
                       std::uint32_t feature) {
    RoundTouch touch{{}, {}, 0, feature};
    const std::int64_t height = triangle.height(point);
    for (int axis = 0; axis < 3; ++axis) {
        touch.normal[axis] = triangle.normal[axis];
        touch.surface[axis] = raw_saturate<std::int32_t>(
            point[axis] - round_unit_wide(height * triangle.normal[axis]));
    }
    touch.separation = raw_saturate<std::int32_t>(height - radius);
    return touch;
}

/// A capsule's segment in the surface's frame.
struct TriangleSegment {
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
    /// Segments as `segments.h` has them: this one is A, the edge B.
    Segments with_edge(const Triangle& triangle, int index) const {
        const TriangleEdge& edge = triangle.edges[index];
        Segments s{};
        s.half_a = half;
        s.half_b = edge.length >> 1;
        for (int axis = 0; axis < 3; ++axis) {
            s.axis_a[axis] = direction[axis];
            s.axis_b[axis] = edge.direction[axis];
            const std::int64_t middle = (std::int64_t{triangle.corners[index][axis]} +
                                         triangle.corners[(index + 1) % 3][axis]) >>
                                        1;
            s.delta[axis] = raw_saturate<std::int32_t>(middle - centre[axis]);
        }
        complete(s);
        return s;
    }
};

/// Nearest places of a triangle and a segment, by their squared distance.
struct NearestPair {
    std::uint64_t square;
    std::int32_t along; // the segment
    TrianglePlace place;
};

class TriangleCapsule {
public:
    TriangleCapsule(const ShapeInstance& surface,
                    const ShapeInstance& capsule,
                    const std::int32_t delta[3],
                    const Triangle& triangle,
                    const TriangleSegment& segment)
        : surface_(surface), capsule_(capsule), delta_(delta), triangle_(triangle),
          segment_(segment), companion_(midway(surface, capsule).companion_separation) {}

    void touch(ManifoldGeometry& out) const;

private:
    Span above_face() const;
    NearestPair nearest() const;
    bool touch_face(const Span& span, std::int64_t separation, ManifoldGeometry& out) const;
    void add(const RoundTouch& touch, ManifoldGeometry& out) const {
        emit_touch(surface_, capsule_, delta_, touch, out);
    }

    const ShapeInstance& surface_;
    const ShapeInstance& capsule_;
    const std::int32_t* delta_;
    const Triangle& triangle_;
    const TriangleSegment& segment_;
    std::int32_t companion_;
};

/// The part of the segment above or below the triangle itself, not beside it.
Span TriangleCapsule::above_face() const {
    Span span{-segment_.half, segment_.half};
    for (int edge = 0; edge < 3 && span.low <= span.high; ++edge) {
        const auto beyond = [&](std::int64_t along) {
            std::int32_t point[3];
            segment_.at(along, point);
            return triangle_.beyond(edge, point);
        };
        keep_below(beyond(span.low), beyond(span.high), span);
    }
    return span;
}

/// Of a segment that does not cross the triangle: an end, or a place on an edge.
NearestPair TriangleCapsule::nearest() const {
    NearestPair best{std::numeric_limits<std::uint64_t>::max(), 0, {}};
    // The place always follows from the segment's point: of an edge and its corner that are as near
    // but for rounding, the one over which that point lies.
    const auto offer = [&](std::int32_t along) {
        std::int32_t point[3];
        std::int32_t gap[3];
        segment_.at(along, point);
        const TrianglePlace place = nearest_place(triangle_, point);
        gap_between(place.place, point, gap);
        const std::uint64_t square = squared_length(gap);
        if (square < best.square) {
            best = {square, along, place};
        }
    };
    offer(-segment_.half);
    offer(segment_.half);
    for (int edge = 0; edge < 3; ++edge) {
        offer(nearest_of(segment_.with_edge(triangle_, edge)).along);
    }
    return best;
}

/// Both ends of the segment's part above the face, where the nearer one is as near as `separation`
/// says.
bool TriangleCapsule::touch_face(const Span& span,
                                 std::int64_t separation,
                                 ManifoldGeometry& out) const {
    if (span.low > span.high) {
        return false;
    }
    RoundTouch ends[2];
    const std::int64_t along[2] = {span.low, span.high};
    for (std::uint32_t end = 0; end < 2; ++end) {
        std::int32_t point[3];
        segment_.at(along[end], point);
        ends[end] = touch_below(triangle_, point, segment_.radius, kFaceFeature + end);
    }
    const std::int32_t nearer = std::min(ends[0].separation, ends[1].separation);
    if (nearer > kSpeculativeMargin || nearer > separation + kLinearSlop) {
        return false;
    }
    const bool single = span.high - span.low <= kLinearSlop;
    for (const RoundTouch& end : ends) {
        if (end.separation > companion_ || (single && end.separation != nearer)) {
            continue;
        }
        add(end, out);
        if (single) {
            break;
        }
    }
    return true;
}

void TriangleCapsule::touch(ManifoldGeometry& out) const {
    const Span span = above_face();
    if (span.low <= span.high) {
        std::int32_t ends[2][3];
        segment_.at(span.low, ends[0]);
        segment_.at(span.high, ends[1]);
        if (triangle_.height(ends[0]) <= 0 || triangle_.height(ends[1]) <= 0) {
            touch_face(span, kSpeculativeMargin, out); // it crosses the triangle
            return;
        }
    }
    const NearestPair pair = nearest();
    const auto reach =
        static_cast<std::uint64_t>(std::int64_t{segment_.radius} + kSpeculativeMargin);
    if (pair.square > reach * reach) {
        return;
    }
    std::int32_t point[3];
    std::int32_t gap[3];
    std::int32_t normal[3] = {0, 0, 0};
    segment_.at(pair.along, point);
    gap_between(pair.place.place, point, gap);
    const std::int32_t distance = normalise(gap, normal);
    const bool lies = distance < kDirectionMin ||
                      round_unit_wide(dot_wide(normal, triangle_.normal)) >= kFaceCosine;
    if (lies && touch_face(span, std::int64_t{distance} - segment_.radius, out)) {
        return;
    }
    if (distance < kDirectionMin) {
        return;
    }
    if (is_along_face(triangle_, normal)) {
        add(touch_below(triangle_, point, segment_.radius, feature_of(pair.place)), out);
    } else if (is_normal_at(triangle_, pair.place, normal)) {
        const std::int32_t* at = pair.place.place;
        add({{at[0], at[1], at[2]},
             {normal[0], normal[1], normal[2]},
             distance - segment_.radius,
             feature_of(pair.place)},
            out);
    }
}

} // namespace

void collide_triangle_sphere(const ShapeInstance& surface,
                             const ShapeInstance& sphere,
                             const std::int32_t delta[3],
                             ManifoldGeometry& out) {
    std::int32_t centre[3];
    inverse_rotate(surface.rotation, delta, centre);
    const std::int64_t reach = std::int64_t{sphere.size[0]} + kSpeculativeMargin;
    if (magnitude(Triangle::height_above(*surface.surface, surface.part, centre)) > reach) {
        return;
    }
    const Triangle triangle = triangle_of(*surface.surface, surface.part);
    const TrianglePlace place = nearest_place(triangle, centre);
    std::int32_t gap[3];
    gap_between(place.place, centre, gap);
    if (squared_length(gap) > static_cast<std::uint64_t>(reach * reach)) {
        return;
    }
    std::int32_t normal[3] = {0, 0, 0};
    const std::int32_t distance = normalise(gap, normal);
    const bool on_face = place.feature == TrianglePlace::Feature::face;
    if (on_face ? triangle.height(centre) >= 0
                : distance < kDirectionMin || is_along_face(triangle, normal)) {
        // Exactly the triangle's normal, so that a rolling ball keeps it.
        const RoundTouch touch = touch_below(triangle, centre, sphere.size[0], feature_of(place));
        if (touch.separation <= kSpeculativeMargin) {
            emit_touch(surface, sphere, delta, touch, out);
        }
    } else if (!on_face && is_normal_at(triangle, place, normal)) {
        const std::int32_t separation = distance - sphere.size[0];
        const RoundTouch touch{{place.place[0], place.place[1], place.place[2]},
                               {normal[0], normal[1], normal[2]},
                               separation,
                               feature_of(place)};
        emit_touch(surface, sphere, delta, touch, out);
    }
}

void collide_triangle_capsule(const ShapeInstance& surface,
                              const ShapeInstance& capsule,
                              const std::int32_t delta[3],
                              ManifoldGeometry& out) {
    TriangleSegment segment{{}, {}, capsule.size[1], capsule.size[0]};
    std::int32_t direction[3];
    axis_of(capsule, 1, direction);
    inverse_rotate(surface.rotation, delta, segment.centre);
    inverse_rotate(surface.rotation, direction, segment.direction);
    const std::int64_t reach = std::int64_t{segment.radius} + segment.half + kSpeculativeMargin;
    const std::int64_t height =
        Triangle::height_above(*surface.surface, surface.part, segment.centre);
    // What has its centre behind a triangle is left to others, or let go.
    if (height < 0 || height > reach) {
        return;
    }
    const Triangle triangle = triangle_of(*surface.surface, surface.part);
    TriangleCapsule(surface, capsule, delta, triangle, segment).touch(out);
}

} // namespace lockwind
