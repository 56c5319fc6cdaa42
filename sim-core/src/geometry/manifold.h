#pragma once

#include <cstdint>

namespace lockwind {

inline constexpr std::uint32_t kManifoldPointsMax = 4;

/// One contact point of a fresh manifold; lengths Q9.22 m.
struct ManifoldPoint {
    std::int32_t local_a[3]; // midpoint of the two surfaces, in A's frame
    std::int32_t local_b[3]; // the same point in B's frame
    std::int32_t separation; // along the normal; negative when overlapping
    std::uint32_t feature;   // id of the features that made it, stable while they touch
};

/// Contact of a pair A, B as collide() finds it.
struct ManifoldGeometry {
    std::int32_t normal[3];    // Q2.30, world, from A to B
    std::uint32_t point_count; // 0: separated by more than the speculative margin
    ManifoldPoint points[kManifoldPointsMax];
    std::uint32_t axis; // box-box: separating or reference axis, 1 .. 15; 0 for none; for the cache
    std::int32_t axis_separation; // Q9.22 m: separation of the reference face when it was chosen
};

/// What collide() may reuse of the pair's last result (box-box only).
struct ManifoldCache {
    std::uint32_t axis = 0;
    std::int32_t axis_separation = 0;
    bool touching = false;
};

} // namespace lockwind
