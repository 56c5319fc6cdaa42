#pragma once

#include "geometry/hull.h"
#include "geometry/shape_instance.h"

#include <cstdint>

namespace lockwind {

/// A convex polytope in its own frame: a hull, or a box seen as one. Points into what it is made
/// of.
struct Polytope {
    const HullVertex* vertices;
    const HullFace* faces;
    const HullEdge* edges;
    const HullCorner* corners;
    std::uint32_t vertex_count;
    std::uint32_t face_count;
    std::uint32_t edge_count;

    const HullCorner& corner(const HullFace& face, std::uint32_t index) const {
        return corners[face.first_corner + index];
    }
    const std::int32_t* place(const HullFace& face, std::uint32_t index) const {
        return vertices[corner(face, index).vertex].place;
    }
};

/// Room for the vertices and faces of a box; its edges are those of any.
struct BoxFeatures {
    HullVertex vertices[8];
    HullFace faces[6];
};

/// Of a hull or a box; `room` must outlive the polytope of a box.
Polytope polytope_of(const ShapeInstance& shape, BoxFeatures& room);

/// Two directions that are perpendicular in a face's plane, in which its corners go
/// counter-clockwise: along its first edge, and across. Q2.30.
struct FaceAxes {
    std::int32_t u[3];
    std::int32_t v[3];
};
FaceAxes axes_of(const Polytope& polytope, const HullFace& face);

/// unit . (to - from), exact; places within 512 m.
inline std::int64_t
dot_between(const std::int32_t unit[3], const std::int32_t from[3], const std::int32_t to[3]) {
    std::int64_t sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        sum += unit[axis] * (std::int64_t{to[axis]} - from[axis]);
    }
    return sum;
}

/// Height of a point above a face, Q9.22; |point| < 512 m.
inline std::int64_t height_above(const HullFace& face, const std::int32_t point[3]) {
    return round_unit_wide(dot_wide(face.normal, point)) - face.offset;
}

/// Unit vector (Q2.30) in the face's plane that points out of it across the edge from a corner to
/// the next.
void side_normal(const Polytope& polytope,
                 std::uint32_t face,
                 std::uint32_t corner,
                 std::int32_t normal[3]);

/// The polytope's point nearest to one outside of it, or on its surface.
struct NearestPoint {
    std::int32_t place[3];
    std::uint32_t face; // that it lies in
    bool in_edge;       // or in a vertex
};

/// False for a point inside; `out.face` is then the face that it is least deep below.
bool nearest_point(const Polytope& polytope, const std::int32_t point[3], NearestPoint& out);

} // namespace lockwind
