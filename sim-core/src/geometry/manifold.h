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
    std::uint32_t axis; // separating or reference axis, for the cache; 0 for none. Two boxes:
                        // 1 .. 15; hulls: 1 .. 64 the faces of the hull that comes first, 65 .. 128
                        // of the other hull or box
    std::int32_t axis_separation; // Q9.22 m: separation of the reference face when it was chosen
};

/// What collide() may reuse of the pair's last result (boxes and hulls only).
struct ManifoldCache {
    std::uint32_t axis = 0;
    std::int32_t axis_separation = 0;
    bool touching = false;
};

} // namespace lockwind
