#include "geometry/polytope_face.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lockwind {

namespace {

/// A face's corners, and one more from each side that clips it.
using Polygon = FacePolygon<2 * kHullVerticesMax>;

constexpr std::uint8_t kFirstSide = 64;

/// A side of the reference face, in its plane: normal . place <= limit.
struct Side {
    std::int64_t normal[2]; // Q2.30, out of the face
    std::int64_t limit;     // Q9.22
    std::uint8_t label;

    std::int64_t along(const FacePoint& point) const {
        return round_unit_wide(normal[0] * point.place[0] + normal[1] * point.place[1]);
    }
    std::int64_t beyond(const FacePoint& point) const { return along(point) - limit; }
    void put_on(FacePoint& /*point*/) const {} // an ulp off the side is as good
};

std::int64_t
lowest_along(const Polytope& polytope, const std::int32_t direction[3], std::uint32_t& lowest) {
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (std::uint32_t vertex = 0; vertex < polytope.vertex_count; ++vertex) {
        const std::int64_t height = dot_wide(direction, polytope.vertices[vertex].place);
        if (height < least) {
            least = height;
            lowest = vertex;
        }
    }
    return least;
}

/// The incident face's corners in the reference face's axes.
void place_corners(const Polytope& incident,
                   const FramePlace& place,
                   const HullFace& reference,
                   const PolytopeContact& contact,
                   Polygon& polygon) {
    const HullFace& face = incident.faces[contact.incident_face];
    for (std::uint32_t corner = 0; corner < face.corner_count; ++corner) {
        std::int64_t point[3];
        place.move_far(incident.place(face, corner), point);
        const std::uint32_t before = corner == 0 ? face.corner_count - 1U : corner - 1;
        polygon.add({{round_unit_wide(dot_far(contact.axes.u, point)),
                      round_unit_wide(dot_far(contact.axes.v, point))},
                     round_unit_wide(dot_far(reference.normal, point)) - reference.offset,
                     static_cast<std::uint8_t>(before),
                     static_cast<std::uint8_t>(corner)});
    }
}

Side side_of(const Polytope& reference,
             std::uint32_t face,
             std::uint32_t corner,
             const FaceAxes& axes) {
    std::int32_t normal[3];
    side_normal(reference, face, corner, normal);
    const std::int32_t* from = reference.place(reference.faces[face], corner);
    return {{round_unit_wide(dot_wide(normal, axes.u)), round_unit_wide(dot_wide(normal, axes.v))},
            round_unit_wide(dot_wide(normal, from)),
            static_cast<std::uint8_t>(kFirstSide + corner)};
}

} // namespace

std::int64_t face_separation(const Polytope& reference,
                             std::uint32_t face,
                             const Polytope& incident,
                             const FramePlace& place) {
    const HullFace& plane = reference.faces[face];
    std::int32_t direction[3];
    inverse_rotate(place.rotation, plane.normal, direction);
    std::uint32_t lowest = 0;
    return round_unit_wide(lowest_along(incident, direction, lowest)) +
           height_above(plane, place.centre);
}

std::uint32_t face_against(const Polytope& polytope, const std::int32_t direction[3]) {
    std::uint32_t lowest = 0;
    lowest_along(polytope, direction, lowest);
    std::uint32_t best = 0;
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (std::uint32_t face = 0; face < polytope.face_count; ++face) {
        if ((polytope.vertices[lowest].faces >> face & 1U) == 0) {
            continue;
        }
        const std::int64_t cosine = dot_wide(direction, polytope.faces[face].normal);
        if (cosine < least) {
            least = cosine;
            best = face;
        }
    }
    return best;
}

void clip_polytope_face(const Polytope& reference,
                        std::uint32_t face,
                        const Polytope& incident,
                        const FramePlace& place,
                        std::int64_t limit,
                        PolytopeContact& out) {
    const HullFace& plane = reference.faces[face];
    std::int32_t direction[3];
    inverse_rotate(place.rotation, plane.normal, direction);
    out.incident_face = face_against(incident, direction);
    out.axes = axes_of(reference, plane);
    Polygon first;
    Polygon second;
    Polygon* polygon = &first;
    Polygon* spare = &second;
    place_corners(incident, place, plane, out, first);
    for (std::uint32_t corner = 0; corner < plane.corner_count; ++corner) {
        const Side side = side_of(reference, face, corner, out.axes);
        const bool cuts =
            std::any_of(polygon->corners,
                        polygon->corners + polygon->count,
                        [&](const FacePoint& point) { return side.beyond(point) > 0; });
        if (cuts) {
            clip(*polygon, side, *spare);
            std::swap(polygon, spare);
        }
    }
    keep_contact(*polygon, limit, out);
}

} // namespace lockwind
