#include "geometry/pair_kernels.h"

namespace lockwind {

namespace {

// Features: face (axis and side) with the segment's end, box edge axis, or the nearest point.
constexpr std::uint32_t kFaceFeature = 16;
constexpr std::uint32_t kEdgeFeature = 64;
constexpr std::uint32_t kNearestFeature = 1;

/// cos 3.6 degrees, Q2.30: a normal this close to a face's gives way to it, so that a lying capsule
/// keeps two points of one face.
constexpr std::int32_t kFaceCosine = 1071594000;
/// Squared sine (Q60) of 1 mrad between a segment and an edge: below it they are parallel.
constexpr std::int64_t kParallelSquare = (std::int64_t{1} << 60) / 1000000;

/// The capsule's segment in the box's frame.
struct Segment {
    const std::int32_t* half_extents; // of the box
    std::int32_t centre[3];
    std::int32_t direction[3];
    std::int32_t half;
    std::int32_t radius;

    std::int64_t at(int axis, std::int64_t along) const {
        return centre[axis] + round_unit_wide(along * direction[axis]);
    }
    /// From the box's nearest point to the segment's.
    void gap(std::int32_t along, std::int64_t out[3]) const {
        for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t value = at(axis, along);
            out[axis] =
                value - clamped<std::int64_t>(value, -half_extents[axis], half_extents[axis]);
        }
    }
    /// Half the derivative, Q52, of the squared distance to the box: never falls, linear between
    /// the crossings of face planes.
    std::int64_t slope(std::int32_t along) const {
        std::int64_t out[3];
        gap(along, out);
        return out[0] * direction[0] + out[1] * direction[1] + out[2] * direction[2];
    }
};

struct Bracket {
    std::int32_t low;
    std::int32_t high;
    std::int64_t slope_low;  // < 0
    std::int64_t slope_high; // > 0
};

std::int32_t zero_of(const Bracket& bracket) {
    // Both slopes scaled to 62 bits, the quotient in Q30.
    const std::int64_t range = bracket.slope_high - bracket.slope_low;
    const int shift = std::countl_zero(static_cast<std::uint64_t>(range)) - 1;
    // Bit 32 is the leading one of the scaled range, which is not 0: naming it changes nothing.
    const std::int64_t divisor = ((range << shift) >> kUnitFraction) | (std::int64_t{1} << 32);
    const std::int64_t fraction =
        clamped<std::int64_t>((-bracket.slope_low << shift) / divisor, 0, kUnitOne);
    return bracket.low + round_unit((std::int64_t{bracket.high} - bracket.low) * fraction);
}

/// The segment's point nearest to the box: narrows the range at each crossing of a face plane until
/// the slope is linear in it.
std::int32_t nearest_point(const Segment& segment) {
    Bracket bracket{
        -segment.half, segment.half, segment.slope(-segment.half), segment.slope(segment.half)};
    if (bracket.slope_low >= 0) {
        return bracket.low;
    }
    if (bracket.slope_high <= 0) {
        return bracket.high;
    }
    for (int plane = 0; plane < 6; ++plane) {
        const int axis = plane >> 1;
        if (segment.direction[axis] == 0) {
            continue;
        }
        const std::int64_t face =
            (plane & 1) != 0 ? segment.half_extents[axis] : -segment.half_extents[axis];
        const std::int64_t crossing =
            (face - segment.centre[axis]) * kUnitOne / segment.direction[axis];
        if (crossing <= bracket.low || crossing >= bracket.high) {
            continue;
        }
        const auto along = static_cast<std::int32_t>(crossing);
        const std::int64_t slope = segment.slope(along);
        if (slope == 0) {
            return along;
        }
        if (slope < 0) {
            bracket.low = along;
            bracket.slope_low = slope;
        } else {
            bracket.high = along;
            bracket.slope_high = slope;
        }
    }
    return zero_of(bracket);
}

/// The part of the segment that lies above a face.
struct Span {
    std::int32_t low;
    std::int32_t high;
};

Span clip_to_face(const Segment& segment, int face) {
    std::int64_t low = -segment.half;
    std::int64_t high = segment.half;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t extent = segment.half_extents[axis];
        const std::int64_t direction = segment.direction[axis];
        if (axis == face || (magnitude(segment.at(axis, low)) <= extent &&
                             magnitude(segment.at(axis, high)) <= extent)) {
            continue;
        }
        if (direction == 0) {
            return {1, 0};
        }
        const std::int64_t first = (-extent - segment.centre[axis]) * kUnitOne / direction;
        const std::int64_t second = (extent - segment.centre[axis]) * kUnitOne / direction;
        const std::int64_t enter = first < second ? first : second;
        const std::int64_t leave = first < second ? second : first;
        low = enter > low ? enter : low;
        high = leave < high ? leave : high;
        if (low > high) {
            return {1, 0};
        }
    }
    return {static_cast<std::int32_t>(low), static_cast<std::int32_t>(high)};
}

class Contact {
public:
    Contact(const ShapeInstance& box, const ShapeInstance& capsule, const std::int32_t* delta)
        : box_(box), capsule_(capsule), delta_(delta), midway_(midway(box, capsule)) {}

    void add(const std::int32_t normal[3],
             const std::int32_t middle[3],
             std::int32_t separation,
             std::uint32_t feature,
             ManifoldGeometry& out) const {
        if (out.point_count == 0) {
            rotate(box_.rotation, normal, out.normal);
        }
        ManifoldPoint& point = out.points[out.point_count];
        std::int32_t from_b[3];
        rotate(box_.rotation, middle, from_b);
        for (int axis = 0; axis < 3; ++axis) {
            point.local_a[axis] = middle[axis];
            from_b[axis] -= delta_[axis];
        }
        inverse_rotate(capsule_.rotation, from_b, point.local_b);
        point.separation = separation;
        point.feature = feature;
        ++out.point_count;
    }

    const Midway& between() const { return midway_; }

private:
    const ShapeInstance& box_;
    const ShapeInstance& capsule_;
    const std::int32_t* delta_;
    Midway midway_;
};

/// Both ends of the segment's part above the face, where the nearer one is as near as `separation`
/// says.
bool touch_face(const Contact& contact,
                const Segment& segment,
                int face,
                std::int32_t separation,
                ManifoldGeometry& out) {
    const Span span = clip_to_face(segment, face);
    if (span.low > span.high) {
        return false;
    }
    const bool positive = segment.centre[face] >= 0;
    const std::int32_t ends[2] = {span.low, span.high};
    std::int32_t separations[2];
    for (int end = 0; end < 2; ++end) {
        const std::int64_t value = segment.at(face, ends[end]);
        separations[end] = raw_saturate<std::int32_t>((positive ? value : -value) -
                                                      segment.half_extents[face] - segment.radius);
    }
    const std::int32_t nearer = separations[0] < separations[1] ? separations[0] : separations[1];
    if (nearer > kSpeculativeMargin || magnitude(std::int64_t{nearer} - separation) > kLinearSlop) {
        return false;
    }
    std::int32_t normal[3] = {0, 0, 0};
    normal[face] = positive ? kUnitOne : -kUnitOne;
    const auto tag = kFaceFeature + static_cast<std::uint32_t>(face) * 4 + (positive ? 2U : 0U);
    const bool single = span.high - std::int64_t{span.low} <= kLinearSlop;
    for (int end = 0; end < 2; ++end) {
        if (separations[end] > contact.between().companion_separation ||
            (single && separations[end] != nearer)) {
            continue;
        }
        std::int32_t middle[3];
        for (int axis = 0; axis < 3; ++axis) {
            middle[axis] = static_cast<std::int32_t>(segment.at(axis, ends[end]));
        }
        const std::int32_t height =
            segment.half_extents[face] + contact.between().from_first(separations[end]);
        middle[face] = positive ? height : -height;
        contact.add(normal, middle, separations[end], tag + static_cast<std::uint32_t>(end), out);
    }
    return true;
}

/// The segment crosses the box: an axis of least overlap, as for two boxes.
struct DeepAxis {
    int face = 0;
    std::int32_t face_separation = 0; // without the radius
    int edge = -1;                    // box edge direction; -1 where a face is as good
    std::int32_t edge_separation = 0;
    std::int32_t edge_normal[3] = {0, 0, 0};
};

/// Separation along direction x (box axis), with its normal, towards the segment.
std::int32_t edge_axis(const Segment& segment, int edge, std::int32_t normal[3]) {
    const int j = (edge + 1) % 3;
    const int k = (edge + 2) % 3;
    std::int32_t across[3] = {0, 0, 0};
    across[j] = segment.direction[k];
    across[k] = -segment.direction[j];
    normalise(across, normal);
    normal[edge] = 0;
    std::int64_t distance = dot_wide(normal, segment.centre);
    if (distance < 0) {
        normal[j] = -normal[j];
        normal[k] = -normal[k];
        distance = -distance;
    }
    const std::int64_t extent =
        static_cast<std::int64_t>(magnitude(normal[j])) * segment.half_extents[j] +
        static_cast<std::int64_t>(magnitude(normal[k])) * segment.half_extents[k];
    return round_unit(distance - extent);
}

DeepAxis find_deep_axis(const Segment& segment) {
    DeepAxis deep;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t separation = raw_saturate<std::int32_t>(
            std::int64_t{magnitude(segment.centre[axis])} - segment.half_extents[axis] -
            magnitude(scale(segment.half, segment.direction[axis])));
        if (axis == 0 || separation > deep.face_separation) {
            deep.face = axis;
            deep.face_separation = separation;
        }
    }
    std::int64_t best = std::int64_t{deep.face_separation} + kLinearSlop;
    for (int edge = 0; edge < 3; ++edge) {
        const std::int64_t cosine = segment.direction[edge];
        if ((std::int64_t{1} << 60) - cosine * cosine < kParallelSquare) {
            continue;
        }
        std::int32_t normal[3];
        const std::int32_t separation = edge_axis(segment, edge, normal);
        if (separation > best) {
            best = separation;
            deep.edge = edge;
            deep.edge_separation = separation;
            for (int axis = 0; axis < 3; ++axis) {
                deep.edge_normal[axis] = normal[axis];
            }
        }
    }
    return deep;
}

/// The segment's point nearest to the box's edge that `deep` names; beyond an end, that end.
void touch_edge(const Contact& contact,
                const Segment& segment,
                const DeepAxis& deep,
                ManifoldGeometry& out) {
    const std::int32_t separation = deep.edge_separation - segment.radius;
    std::int32_t offset[3]; // from the segment's centre to the edge
    std::int64_t along_segment = 0;
    std::uint32_t sides = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t corner =
            deep.edge_normal[axis] < 0 ? -segment.half_extents[axis] : segment.half_extents[axis];
        offset[axis] = axis == deep.edge ? 0 : corner - segment.centre[axis];
        sides = sides * 2 + (axis != deep.edge && corner > 0 ? 1U : 0U);
        along_segment += static_cast<std::int64_t>(offset[axis]) * segment.direction[axis];
    }
    // Across the edge's direction the segment's own direction has the squared length 1 - cosine^2.
    const std::int64_t cosine = segment.direction[deep.edge];
    const std::int64_t square = (std::int64_t{1} << 60) - cosine * cosine;
    const auto along = static_cast<std::int32_t>(clamped<std::int64_t>(
        along_segment / (square >> kUnitFraction), -segment.half, segment.half));
    const std::int32_t way_back =
        segment.radius + separation - contact.between().from_first(separation);
    std::int32_t middle[3];
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t back = scale(way_back, deep.edge_normal[axis]);
        middle[axis] = static_cast<std::int32_t>(segment.at(axis, along)) - back;
    }
    contact.add(deep.edge_normal,
                middle,
                separation,
                kEdgeFeature + static_cast<std::uint32_t>(deep.edge) * 8 + sides,
                out);
}

void touch_deep(const Contact& contact, const Segment& segment, ManifoldGeometry& out) {
    const DeepAxis deep = find_deep_axis(segment);
    if (deep.edge >= 0) {
        touch_edge(contact, segment, deep, out);
        return;
    }
    const std::int32_t separation = deep.face_separation - segment.radius;
    if (touch_face(contact, segment, deep.face, separation, out)) {
        return;
    }
    // The deepest end lies beside the face: it alone is the contact.
    const bool positive = segment.centre[deep.face] >= 0;
    const bool low_end = (segment.direction[deep.face] > 0) == positive;
    const std::int32_t along = low_end ? -segment.half : segment.half;
    std::int32_t normal[3] = {0, 0, 0};
    normal[deep.face] = positive ? kUnitOne : -kUnitOne;
    std::int32_t middle[3];
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = static_cast<std::int32_t>(segment.at(axis, along));
    }
    const std::int32_t height =
        segment.half_extents[deep.face] + contact.between().from_first(separation);
    middle[deep.face] = positive ? height : -height;
    contact.add(normal, middle, separation, kNearestFeature, out);
}

} // namespace

void collide_box_capsule(const ShapeInstance& box,
                         const ShapeInstance& capsule,
                         const std::int32_t delta[3],
                         ManifoldGeometry& out) {
    Segment segment{box.size, {}, {}, capsule.size[1], capsule.size[0]};
    std::int32_t direction[3];
    axis_of(capsule, 1, direction);
    inverse_rotate(box.rotation, delta, segment.centre);
    inverse_rotate(box.rotation, direction, segment.direction);
    const Contact contact(box, capsule, delta);

    const std::int32_t along = nearest_point(segment);
    std::int64_t wide_gap[3];
    segment.gap(along, wide_gap);
    std::int32_t gap[3];
    for (int axis = 0; axis < 3; ++axis) {
        gap[axis] = raw_saturate<std::int32_t>(wide_gap[axis]);
    }
    const auto reach =
        static_cast<std::uint64_t>(std::int64_t{segment.radius} + kSpeculativeMargin);
    if (squared_length(gap) > reach * reach) {
        return;
    }
    std::int32_t normal[3] = {0, 0, 0};
    const std::int32_t distance = normalise(gap, normal);
    if (distance < kDirectionMin) {
        touch_deep(contact, segment, out);
        return;
    }
    const std::int32_t separation = distance - segment.radius;
    int face = 0;
    for (int axis = 1; axis < 3; ++axis) {
        face = magnitude(normal[axis]) > magnitude(normal[face]) ? axis : face;
    }
    const bool outwards = (normal[face] >= 0) == (segment.centre[face] >= 0);
    if (magnitude(normal[face]) > kFaceCosine && outwards &&
        touch_face(contact, segment, face, separation, out)) {
        return;
    }
    const std::int32_t way_back =
        segment.radius + separation - contact.between().from_first(separation);
    std::int32_t middle[3];
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t back = scale(way_back, normal[axis]);
        middle[axis] = static_cast<std::int32_t>(segment.at(axis, along)) - back;
    }
    contact.add(normal, middle, separation, kNearestFeature, out);
}

} // namespace lockwind
