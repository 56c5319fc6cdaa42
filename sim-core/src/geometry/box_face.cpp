#include "geometry/box_face.h"

#include "geometry/fixed_geometry.h"

#include <utility>

namespace lockwind {

namespace {

/// Four corners, one more from each of four clips.
constexpr int kCornersMax = 8;

using Polygon = FacePolygon<kCornersMax>;

/// One side of the reference face: sign * place[kAxis] <= limit.
template <int kAxis>
struct Side {
    std::int64_t sign;
    std::int64_t limit;
    std::uint8_t label;

    std::int64_t beyond(const FacePoint& point) const { return sign * point.place[kAxis] - limit; }
    void put_on(FacePoint& point) const { point.place[kAxis] = sign * limit; }
};

/// Clips against both sides of one axis; `polygon` and `spare` change places at each.
template <int kAxis>
void clip_axis(std::int64_t centre,
               std::int64_t reach,
               std::int64_t limit,
               Polygon*& polygon,
               Polygon*& spare) {
    constexpr std::uint8_t kLabel = 4 + 2 * kAxis;
    if (centre + reach > limit) {
        clip(*polygon, Side<kAxis>{1, limit, kLabel}, *spare);
        std::swap(polygon, spare);
    }
    if (reach - centre > limit) {
        clip(*polygon, Side<kAxis>{-1, limit, kLabel + 1}, *spare);
        std::swap(polygon, spare);
    }
}

/// The incident face as seen along the reference axis: centre and half edges in (u, v, axis).
struct IncidentFace {
    std::int64_t centre[3];
    std::int64_t edge_u[3];
    std::int64_t edge_v[3];
};

IncidentFace incident_face(const IncidentBox& box, int axis, FaceContact& out) {
    const std::int32_t* towards = box.axes + 3 * axis;
    out.positive = box.centre[axis] >= 0;
    int face = 0;
    for (int column = 1; column < 3; ++column) {
        face = magnitude(towards[column]) > magnitude(towards[face]) ? column : face;
    }
    // The face that looks back at the reference face.
    const bool face_positive = (towards[face] > 0) != out.positive;
    const auto side = static_cast<std::uint32_t>(2 * axis + (out.positive ? 1 : 0));
    out.feature = side * 8 + static_cast<std::uint32_t>(2 * face + (face_positive ? 1 : 0));

    const int u = (face + 1) % 3;
    const int v = (face + 2) % 3;
    const int rows[3] = {(axis + 1) % 3, (axis + 2) % 3, axis};
    const std::int32_t half = box.half_extents[face];
    IncidentFace result{};
    for (int index = 0; index < 3; ++index) {
        const std::int32_t* row = box.axes + 3 * rows[index];
        result.centre[index] =
            std::int64_t{box.centre[rows[index]]} + scale(face_positive ? half : -half, row[face]);
        result.edge_u[index] = scale(box.half_extents[u], row[u]);
        result.edge_v[index] = scale(box.half_extents[v], row[v]);
    }
    return result;
}

Polygon corners_of(const IncidentFace& face, std::int32_t reference_height, bool positive) {
    constexpr int kSignU[4] = {1, -1, -1, 1};
    constexpr int kSignV[4] = {1, 1, -1, -1};
    Polygon polygon;
    for (int corner = 0; corner < 4; ++corner) {
        const auto at = [&](int index) {
            return face.centre[index] + kSignU[corner] * face.edge_u[index] +
                   kSignV[corner] * face.edge_v[index];
        };
        const std::int64_t height = at(2);
        polygon.add({{at(0), at(1)},
                     (positive ? height : -height) - reference_height,
                     static_cast<std::uint8_t>((corner + 3) & 3),
                     static_cast<std::uint8_t>(corner)});
    }
    return polygon;
}

} // namespace

void clip_to_reference_face(const IncidentBox& box, int axis, FaceContact& out) {
    const IncidentFace face = incident_face(box, axis, out);
    Polygon first = corners_of(face, box.reference_half_extents[axis], out.positive);
    Polygon second;
    Polygon* polygon = &first;
    Polygon* spare = &second;
    clip_axis<0>(face.centre[0],
                 magnitude(face.edge_u[0]) + magnitude(face.edge_v[0]),
                 box.reference_half_extents[(axis + 1) % 3],
                 polygon,
                 spare);
    clip_axis<1>(face.centre[1],
                 magnitude(face.edge_u[1]) + magnitude(face.edge_v[1]),
                 box.reference_half_extents[(axis + 2) % 3],
                 polygon,
                 spare);
    keep_contact(*polygon, box.companion_separation, out);
}

} // namespace lockwind
