#pragma once

#include "dynamics/dynamics.h"
#include "geometry/shape_instance.h"
#include "geometry/shape_library.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// What follows from a body's orientation and shape. The first two members are what it was made
/// from: a frame is a cache that is checked against its key each time, so it may survive ticks.
struct BodyFrame {
    std::int32_t orientation[4];
    std::int32_t rotation[9]; // row-major, Q2.30; identity for a sphere, so that rolling spheres
                              // keep their contact points
    std::int32_t half_extents[3]; // Q9.22 m of the tight bounds; 0 for a plane
    ShapeInstance shape;          // `rotation` points into this frame
};

/// Frames by row, recomputed where orientation, size or shape differ from the key. A shape that
/// there is not (in damaged tables) is a sphere.
class BodyFrames {
public:
    /// `shapes` must outlive this; none: no body is a hull.
    explicit BodyFrames(std::uint32_t capacity, const ShapeLibrary* shapes = nullptr);
    void refresh(const DynamicsTables& tables, std::span<const BodyRow> rows);
    void drop();
    const BodyFrame& operator[](BodyRow row) const { return frames_[row]; }

private:
    std::vector<BodyFrame> frames_;
    const ShapeLibrary* shapes_;
};

/// From centre A to centre B, Q9.22 m; of a plane, from or to the nearest point.
void pair_delta(const BodyFrame& a,
                const BodyFrame& b,
                const BodyMotion& motion_a,
                const BodyMotion& motion_b,
                std::int32_t delta[3]);

} // namespace lockwind
