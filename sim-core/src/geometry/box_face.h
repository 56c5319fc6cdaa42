#pragma once

#include "geometry/face_polygon.h"

#include <cstdint>

namespace lockwind {

/// One box seen from another's frame (the reference box, whose face may carry the contact).
struct IncidentBox {
    const std::int32_t* reference_half_extents; // Q9.22 m
    const std::int32_t* half_extents;
    std::int32_t axes[9];              // columns: the incident box's axes, Q2.30
    std::int32_t centre[3];            // Q9.22
    std::int32_t companion_separation; // Q9.22, see Midway
};

/// Edges of the corners (FacePoint): 0 .. 3 of the incident face, 4 .. 7 sides of the reference
/// face.
struct FaceContact : FacePoints {
    bool positive = true;      // which of the axis' two faces
    std::uint32_t feature = 0; // reference and incident face, 6 bits
};

/// Clips the incident face against the sides of the reference box's face on `axis`. Leaves count 0
/// where nothing of it is within kSpeculativeMargin.
void clip_to_reference_face(const IncidentBox& box, int axis, FaceContact& out);

} // namespace lockwind
