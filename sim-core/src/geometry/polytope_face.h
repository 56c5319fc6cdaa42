#pragma once

#include "geometry/face_polygon.h"
#include "geometry/polytope.h"
#include "geometry/rotation.h"

#include <cstdint>

namespace lockwind {

/// Where a frame lies in another one: x_there = rotation x_here + centre.
struct FramePlace {
    std::int32_t rotation[9]; // Q2.30
    std::int32_t centre[3];   // Q9.22

    /// A point of a large polytope may lie more than 512 m from the other's centre.
    void move_far(const std::int32_t here[3], std::int64_t there[3]) const {
        std::int32_t turned[3];
        rotate(rotation, here, turned);
        for (int axis = 0; axis < 3; ++axis) {
            there[axis] = std::int64_t{turned[axis]} + centre[axis];
        }
    }
    /// Saturated: nothing touches that far.
    void move(const std::int32_t here[3], std::int32_t there[3]) const {
        std::int64_t far[3];
        move_far(here, far);
        for (int axis = 0; axis < 3; ++axis) {
            there[axis] = raw_saturate<std::int32_t>(far[axis]);
        }
    }
};

/// unit . v, exact; |v| < 2^32.
inline std::int64_t dot_far(const std::int32_t unit[3], const std::int64_t v[3]) {
    return unit[0] * v[0] + unit[1] * v[1] + unit[2] * v[2];
}

/// Separation along a face of `reference`: how high `incident`'s lowest vertex lies above it.
/// `place` is the incident polytope's frame in the reference's.
std::int64_t face_separation(const Polytope& reference,
                             std::uint32_t face,
                             const Polytope& incident,
                             const FramePlace& place);

/// Of the faces that meet in the vertex lowest along a direction (the polytope's frame, Q2.30), the
/// one that looks most against it. The lowest vertex alone would leave open which face lies there;
/// the face that looks back most, among all, need not reach that deep.
std::uint32_t face_against(const Polytope& polytope, const std::int32_t direction[3]);

/// Edges of the corners (FacePoint): 0 .. 63 the incident face's, 64 .. 127 the reference face's,
/// by their first corner.
struct PolytopeContact : FacePoints {
    std::uint32_t incident_face = 0;
    FaceAxes axes; // in which the points' places are
};

/// Clips the incident face against the sides of the reference face. Corners above `limit` go;
/// count 0 where nothing is within kSpeculativeMargin.
void clip_polytope_face(const Polytope& reference,
                        std::uint32_t face,
                        const Polytope& incident,
                        const FramePlace& place,
                        std::int64_t limit,
                        PolytopeContact& out);

} // namespace lockwind
