#include "geometry/pair_kernels.h"
#include "geometry/segments.h"

#include <initializer_list>

namespace lockwind {

namespace {

// Features: where along A's segment a point lies.
constexpr std::uint32_t kFeatureLow = 1;
constexpr std::uint32_t kFeatureHigh = 2;
constexpr std::uint32_t kFeatureBetween = 3;

/// Squared sine (Q60) of 14 degrees: above it capsules touch in one point.
constexpr std::int64_t kLineSquare = (std::int64_t{1} << 60) / 16;

Segments
make_segments(const ShapeInstance& a, const ShapeInstance& b, const std::int32_t delta[3]) {
    Segments s{};
    axis_of(a, 1, s.axis_a);
    axis_of(b, 1, s.axis_b);
    for (int axis = 0; axis < 3; ++axis) {
        s.delta[axis] = delta[axis];
    }
    s.half_a = a.size[1];
    s.half_b = b.size[1];
    complete(s);
    return s;
}

/// Where the segments meet: across both, else sideways out of A; from A to B.
void crossing_normal(const Segments& s, const ShapeInstance& a, std::int32_t normal[3]) {
    axis_of(a, 0, normal);
    if (s.sine_square >= kParallelSquare) {
        std::int32_t across[3];
        for (int axis = 0; axis < 3; ++axis) {
            const int j = (axis + 1) % 3;
            const int k = (axis + 2) % 3;
            across[axis] = round_unit(static_cast<std::int64_t>(s.axis_a[j]) * s.axis_b[k] -
                                      static_cast<std::int64_t>(s.axis_a[k]) * s.axis_b[j]);
        }
        normalise(across, normal);
    }
    if (dot_wide(normal, s.delta) < 0) {
        for (int axis = 0; axis < 3; ++axis) {
            normal[axis] = -normal[axis];
        }
    }
}

struct CapsulePair {
    const ShapeInstance& a;
    const ShapeInstance& b;
    Segments segments;
};

void emit_between(const CapsulePair& pair,
                  std::int32_t on_a,
                  std::uint32_t feature,
                  ManifoldGeometry& out) {
    const Segments& s = pair.segments;
    const std::int32_t on_b = nearest_on_b(s, on_a);
    std::int32_t gap[3];
    between(s, on_a, on_b, gap);
    ManifoldPoint& point = out.points[out.point_count];
    const std::int32_t radius = pair.a.size[0];
    point.separation = round_unit(dot_wide(out.normal, gap)) - radius - pair.b.size[0];
    point.feature = feature;
    const std::int32_t half_way = radius + midway(pair.a, pair.b).from_first(point.separation);
    std::int32_t middle[3];
    for (int axis = 0; axis < 3; ++axis) {
        // Half the gap's part across the normal is split between the two surfaces.
        const std::int32_t aside =
            gap[axis] - scale(point.separation + radius + pair.b.size[0], out.normal[axis]);
        middle[axis] =
            scale(on_a, s.axis_a[axis]) + scale(half_way, out.normal[axis]) + (aside >> 1);
    }
    place_point(pair.a, pair.b, s.delta, middle, point);
    ++out.point_count;
}

/// True where the segments run so close along their whole overlap that its ends carry the contact:
/// they are all but parallel, or touch at one of the ends and open slowly to the other.
bool touch_along_line(const Segments& s,
                      const Overlap& beside,
                      std::int32_t on_a,
                      std::int32_t distance) {
    if (s.sine_square > kLineSquare || beside.high - std::int64_t{beside.low} <= kLinearSlop) {
        return false;
    }
    if (on_a - std::int64_t{beside.low} <= kLinearSlop ||
        beside.high - std::int64_t{on_a} <= kLinearSlop) {
        return true;
    }
    const auto reach = static_cast<std::uint64_t>(distance) + kLinearSlop;
    for (const std::int32_t end : {beside.low, beside.high}) {
        std::int32_t gap[3];
        between(s, end, nearest_on_b(s, end), gap);
        if (squared_length(gap) > reach * reach) {
            return false;
        }
    }
    return true;
}

} // namespace

void collide_capsules(const ShapeInstance& a,
                      const ShapeInstance& b,
                      const std::int32_t delta[3],
                      ManifoldGeometry& out) {
    const CapsulePair pair{a, b, make_segments(a, b, delta)};
    const Segments& s = pair.segments;
    const Overlap beside = overlap(s);
    const std::int32_t on_a = nearest_to_b(s, beside);
    std::int32_t gap[3];
    between(s, on_a, nearest_on_b(s, on_a), gap);
    const auto reach =
        static_cast<std::uint64_t>(std::int64_t{a.size[0]} + b.size[0] + kSpeculativeMargin);
    if (squared_length(gap) > reach * reach) {
        return;
    }
    const std::int32_t distance = normalise(gap, out.normal);
    if (distance < kDirectionMin) {
        crossing_normal(s, a, out.normal);
    }
    if (touch_along_line(s, beside, on_a, distance)) {
        emit_between(pair, beside.low, kFeatureLow, out);
        emit_between(pair, beside.high, kFeatureHigh, out);
        return;
    }
    std::uint32_t feature = kFeatureBetween;
    if (on_a <= beside.low) {
        feature = kFeatureLow;
    } else if (on_a >= beside.high) {
        feature = kFeatureHigh;
    }
    emit_between(pair, on_a, feature, out);
}

} // namespace lockwind
