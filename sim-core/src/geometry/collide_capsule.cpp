#include "geometry/pair_kernels.h"

#include <initializer_list>

namespace lockwind {

namespace {

// Features: where along A's segment a point lies.
constexpr std::uint32_t kFeatureLow = 1;
constexpr std::uint32_t kFeatureHigh = 2;
constexpr std::uint32_t kFeatureBetween = 3;

/// Squared sine (Q60) of 1 mrad: below it axes are taken for parallel.
constexpr std::int64_t kParallelSquare = (std::int64_t{1} << 60) / 1000000;
/// Squared sine (Q60) of 14 degrees: above it capsules touch in one point.
constexpr std::int64_t kLineSquare = (std::int64_t{1} << 60) / 16;

/// Two segments: A's about the origin, B's about `delta`, points named by their length along each.
struct Segments {
    std::int32_t delta[3];
    std::int32_t axis_a[3];
    std::int32_t axis_b[3];
    std::int32_t half_a;
    std::int32_t half_b;
    std::int32_t cosine;      // Q2.30
    std::int64_t sine_square; // Q60
    std::int64_t along_a;     // of delta
    std::int64_t along_b;
};

std::int32_t on_segment(std::int64_t along, std::int32_t half) {
    return static_cast<std::int32_t>(clamped<std::int64_t>(along, -half, half));
}

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
    s.cosine = round_unit(dot_wide(s.axis_a, s.axis_b));
    s.sine_square = (std::int64_t{1} << 60) - static_cast<std::int64_t>(s.cosine) * s.cosine;
    s.along_a = round_unit_wide(dot_wide(s.axis_a, delta));
    s.along_b = round_unit_wide(dot_wide(s.axis_b, delta));
    return s;
}

/// B's point nearest to A's point `on_a`.
std::int32_t nearest_on_b(const Segments& s, std::int32_t on_a) {
    return on_segment(scale(on_a, s.cosine) - s.along_b, s.half_b);
}

std::int32_t nearest_on_a(const Segments& s, std::int32_t on_b) {
    return on_segment(scale(on_b, s.cosine) + s.along_a, s.half_a);
}

/// A's range that lies beside B; empty where low >= high.
struct Overlap {
    std::int32_t low;
    std::int32_t high;
};

Overlap overlap(const Segments& s) {
    const std::int32_t reach = magnitude(scale(s.half_b, s.cosine));
    return {on_segment(s.along_a - reach, s.half_a), on_segment(s.along_a + reach, s.half_a)};
}

/// A's point nearest to B (Ericson, Real-Time Collision Detection, 5.1.9).
std::int32_t nearest_to_b(const Segments& s, const Overlap& beside) {
    if (s.sine_square < kParallelSquare) {
        // All of the overlap is nearest, but for rounding: its middle does not jump about.
        return static_cast<std::int32_t>((std::int64_t{beside.low} + beside.high) >> 1);
    }
    const std::int64_t numerator = s.along_a * kUnitOne - s.along_b * s.cosine;
    const std::int32_t on_a = on_segment(numerator / (s.sine_square >> kUnitFraction), s.half_a);
    return nearest_on_a(s, nearest_on_b(s, on_a));
}

/// From A's to B's point, saturated: then they do not touch.
void between(const Segments& s, std::int32_t on_a, std::int32_t on_b, std::int32_t gap[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        gap[axis] =
            raw_saturate<std::int32_t>(std::int64_t{s.delta[axis]} + scale(on_b, s.axis_b[axis]) -
                                       scale(on_a, s.axis_a[axis]));
    }
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
