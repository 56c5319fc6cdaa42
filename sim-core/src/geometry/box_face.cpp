#include "geometry/box_face.h"

#include "geometry/fixed_geometry.h"

#include <utility>

namespace lockwind {

namespace {

/// Four corners, one more from each of four clips.
constexpr int kCornersMax = 8;

struct Polygon {
    FacePoint corners[kCornersMax];
    int count = 0;

    void add(const FacePoint& corner) { corners[count++] = corner; }
    FacePoint take(int index) {
        const FacePoint taken = corners[index];
        corners[index] = corners[--count];
        return taken;
    }
};

/// One side of the reference face: sign * place[kAxis] <= limit.
template <int kAxis>
struct Side {
    std::int64_t sign;
    std::int64_t limit;
    std::uint8_t label;

    std::int64_t beyond(const FacePoint& point) const { return sign * point.place[kAxis] - limit; }
};

/// Where the edge from -> to crosses the side; the ends lie on different sides of it.
template <int kAxis>
FacePoint cross(const Side<kAxis>& side, const FacePoint& from, const FacePoint& to) {
    const std::int64_t beyond = side.beyond(from);
    const std::int64_t fraction = beyond * kUnitOne / (beyond - side.beyond(to));
    const auto blend = [fraction](std::int64_t a, std::int64_t b) {
        return a + round_unit_wide((b - a) * fraction);
    };
    FacePoint point{};
    point.place[kAxis] = side.sign * side.limit;
    point.place[1 - kAxis] = blend(from.place[1 - kAxis], to.place[1 - kAxis]);
    point.separation = blend(from.separation, to.separation);
    return point;
}

/// Sutherland and Hodgman's clip of a convex polygon; new corners take the side's label.
template <int kAxis>
void clip(const Polygon& in, const Side<kAxis>& side, Polygon& out) {
    out.count = 0;
    if (in.count == 0) {
        return;
    }
    const FacePoint* from = &in.corners[in.count - 1];
    bool from_inside = side.beyond(*from) <= 0;
    for (int index = 0; index < in.count; ++index) {
        const FacePoint* to = &in.corners[index];
        const bool to_inside = side.beyond(*to) <= 0;
        if (from_inside != to_inside) {
            FacePoint point = cross(side, *from, *to);
            point.edge_in = from_inside ? to->edge_in : side.label;
            point.edge_out = from_inside ? side.label : to->edge_in;
            out.add(point);
        }
        if (to_inside) {
            out.add(*to);
        }
        from = to;
        from_inside = to_inside;
    }
}

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

/// Twice the signed area of a triangle in the face.
std::int64_t area(const FacePoint& a, const FacePoint& b, const FacePoint& c) {
    return (b.place[0] - a.place[0]) * (c.place[1] - a.place[1]) -
           (b.place[1] - a.place[1]) * (c.place[0] - a.place[0]);
}

/// Index of the corner with the highest score; a later one must win by 1/32, so that rounding never
/// decides between equals. -1 where none reaches `least`.
template <class Score>
int best_corner(const Polygon& polygon, std::int64_t least, const Score& score) {
    int best = -1;
    std::int64_t threshold = least;
    for (int index = 0; index < polygon.count; ++index) {
        const std::int64_t value = score(polygon.corners[index]);
        if (value - (magnitude(value) >> 5) > threshold) {
            threshold = value;
            best = index;
        }
    }
    return best;
}

/// Keeps four corners that carry what all would: deep and extreme in a fixed direction, the
/// farthest from it, then the largest triangle on either side.
void reduce(Polygon& polygon, FaceContact& out) {
    constexpr std::int64_t kAreaMin = std::int64_t{kSpeculativeMargin} * kSpeculativeMargin;
    constexpr std::int64_t kFarScore = -(std::int64_t{1} << 62);
    FacePoint* kept = out.points;
    const auto keep = [&](int index) { kept[out.count++] = polygon.take(index); };

    const int first = best_corner(polygon, 2 * kFarScore, [](const FacePoint& point) {
        // The direction is no axis of common scenes, so that ties are rare.
        return point.separation > kSpeculativeMargin
                   ? kFarScore
                   : -point.separation * 1024 - point.place[0] * 464 + point.place[1] * 913;
    });
    keep(first);
    const int second = best_corner(polygon, 0, [&](const FacePoint& point) {
        const std::int64_t u = point.place[0] - kept[0].place[0];
        const std::int64_t v = point.place[1] - kept[0].place[1];
        const std::int64_t depth = point.separation < 0 ? point.separation : 0;
        return (u * u >> 2) + (v * v >> 2) + depth * depth;
    });
    if (second < 0) {
        return;
    }
    keep(second);
    std::int64_t sign = 1;
    const int third = best_corner(polygon, kAreaMin, [&](const FacePoint& point) {
        return magnitude(area(kept[0], kept[1], point));
    });
    if (third < 0) {
        return;
    }
    sign = area(kept[0], kept[1], polygon.corners[third]) < 0 ? -1 : 1;
    keep(third);
    const int fourth = best_corner(polygon, kAreaMin, [&](const FacePoint& point) {
        const std::int64_t outside[3] = {-sign * area(kept[0], kept[1], point),
                                         -sign * area(kept[1], kept[2], point),
                                         -sign * area(kept[2], kept[0], point)};
        const std::int64_t larger = outside[0] > outside[1] ? outside[0] : outside[1];
        return larger > outside[2] ? larger : outside[2];
    });
    if (fourth >= 0) {
        keep(fourth);
    }
}

/// Drops corners above `limit`, in place. Returns the lowest separation of all.
std::int32_t drop_far_corners(Polygon& polygon, std::int64_t limit) {
    std::int64_t lowest = polygon.corners[0].separation;
    int kept = 0;
    for (int index = 0; index < polygon.count; ++index) {
        const FacePoint corner = polygon.corners[index];
        lowest = corner.separation < lowest ? corner.separation : lowest;
        if (corner.separation <= limit) {
            polygon.corners[kept++] = corner;
        }
    }
    polygon.count = kept;
    return raw_saturate<std::int32_t>(lowest);
}

} // namespace

void clip_to_reference_face(const IncidentBox& box, int axis, FaceContact& out) {
    out.count = 0;
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
    if (polygon->count == 0) {
        return;
    }
    out.min_separation = drop_far_corners(*polygon, box.companion_separation);
    if (out.min_separation > kSpeculativeMargin) {
        return;
    }
    if (polygon->count > static_cast<int>(kManifoldPointsMax)) {
        reduce(*polygon, out);
        return;
    }
    for (int index = 0; index < polygon->count; ++index) {
        out.points[out.count++] = polygon->corners[index];
    }
}

} // namespace lockwind
