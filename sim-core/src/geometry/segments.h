#pragma once

#include "geometry/fixed_geometry.h"

#include <cstdint>
#include <initializer_list>

namespace lockwind {

/// Squared sine (Q60) of 1 mrad: below it axes are taken for parallel.
inline constexpr std::int64_t kParallelSquare = (std::int64_t{1} << 60) / 1000000;

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

inline std::int32_t on_segment(std::int64_t along, std::int32_t half) {
    return static_cast<std::int32_t>(clamped<std::int64_t>(along, -half, half));
}

/// `axis_a`, `axis_b`, `half_a`, `half_b` and `delta` are given; this adds what follows from them.
inline void complete(Segments& s) {
    s.cosine = round_unit(dot_wide(s.axis_a, s.axis_b));
    s.sine_square = (std::int64_t{1} << 60) - static_cast<std::int64_t>(s.cosine) * s.cosine;
    s.along_a = round_unit_wide(dot_wide(s.axis_a, s.delta));
    s.along_b = round_unit_wide(dot_wide(s.axis_b, s.delta));
}

/// B's point nearest to A's point `on_a`.
inline std::int32_t nearest_on_b(const Segments& s, std::int32_t on_a) {
    return on_segment(scale(on_a, s.cosine) - s.along_b, s.half_b);
}

inline std::int32_t nearest_on_a(const Segments& s, std::int32_t on_b) {
    return on_segment(scale(on_b, s.cosine) + s.along_a, s.half_a);
}

/// A's range that lies beside B; empty where low >= high.
struct Overlap {
    std::int32_t low;
    std::int32_t high;
};

inline Overlap overlap(const Segments& s) {
    const std::int32_t reach = magnitude(scale(s.half_b, s.cosine));
    return {on_segment(s.along_a - reach, s.half_a), on_segment(s.along_a + reach, s.half_a)};
}

/// A's point nearest to B (Ericson, Real-Time Collision Detection, 5.1.9).
inline std::int32_t nearest_to_b(const Segments& s, const Overlap& beside) {
    if (s.sine_square < kParallelSquare) {
        // All of the overlap is nearest, but for rounding: its middle does not jump about.
        return static_cast<std::int32_t>((std::int64_t{beside.low} + beside.high) >> 1);
    }
    const std::int64_t numerator = s.along_a * kUnitOne - s.along_b * s.cosine;
    const std::int32_t on_a = on_segment(numerator / (s.sine_square >> kUnitFraction), s.half_a);
    return nearest_on_a(s, nearest_on_b(s, on_a));
}

/// From A's to B's point, saturated: then they do not touch.
inline void between(const Segments& s, std::int32_t on_a, std::int32_t on_b, std::int32_t gap[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        gap[axis] =
            raw_saturate<std::int32_t>(std::int64_t{s.delta[axis]} + scale(on_b, s.axis_b[axis]) -
                                       scale(on_a, s.axis_a[axis]));
    }
}

/// A's point nearest to B, and the squared distance.
struct NearestOnA {
    std::int32_t along;
    std::uint64_t square;
};

/// The same for any two segments: where they are nearly parallel, the ends of the overlap too.
inline NearestOnA nearest_of(const Segments& s) {
    const Overlap beside = overlap(s);
    const auto square_at = [&](std::int32_t along) {
        std::int32_t gap[3];
        between(s, along, nearest_on_b(s, along), gap);
        return squared_length(gap);
    };
    const std::int32_t along = nearest_to_b(s, beside);
    NearestOnA nearest{along, square_at(along)};
    for (const std::int32_t end : {beside.low, beside.high}) {
        const std::uint64_t square =
            s.sine_square < kParallelSquare ? square_at(end) : nearest.square;
        if (square < nearest.square) {
            nearest = {end, square};
        }
    }
    return nearest;
}

} // namespace lockwind
