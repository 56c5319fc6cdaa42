#pragma once

#include <cstdint>
#include <limits>

namespace lockwind {

inline constexpr int kBoundsFraction = 16; // Q15.16 m

/// Axis-aligned bounds, Q15.16 m.
struct Bounds {
    std::int32_t low[3];
    std::int32_t high[3];

    bool operator==(const Bounds&) const = default;
};

/// Of a plane: meets everything.
inline constexpr Bounds kUnbounded{{std::numeric_limits<std::int32_t>::min(),
                                    std::numeric_limits<std::int32_t>::min(),
                                    std::numeric_limits<std::int32_t>::min()},
                                   {std::numeric_limits<std::int32_t>::max(),
                                    std::numeric_limits<std::int32_t>::max(),
                                    std::numeric_limits<std::int32_t>::max()}};

constexpr bool overlaps(const Bounds& a, const Bounds& b) {
    return a.low[0] <= b.high[0] && b.low[0] <= a.high[0] && a.low[1] <= b.high[1] &&
           b.low[1] <= a.high[1] && a.low[2] <= b.high[2] && b.low[2] <= a.high[2];
}

constexpr bool contains(const Bounds& outer, const Bounds& inner) {
    return inner.low[0] >= outer.low[0] && inner.high[0] <= outer.high[0] &&
           inner.low[1] >= outer.low[1] && inner.high[1] <= outer.high[1] &&
           inner.low[2] >= outer.low[2] && inner.high[2] <= outer.high[2];
}

} // namespace lockwind
