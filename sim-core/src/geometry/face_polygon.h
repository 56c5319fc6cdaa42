#pragma once

#include "geometry/fixed_geometry.h"
#include "geometry/manifold.h"

#include <cstdint>

namespace lockwind {

// The part of a face that lies above another one, in that one's plane: how it is cut out, and which
// of its corners make the contact.

/// A corner. Its feature is the pair of edges that meet in it; their numbers are the caller's.
struct FacePoint {
    std::int64_t place[2];   // in the reference face's plane, Q9.22
    std::int64_t separation; // above it
    std::uint8_t edge_in;
    std::uint8_t edge_out;
};

template <int kCornersMax>
struct FacePolygon {
    FacePoint corners[kCornersMax];
    int count = 0;

    void add(const FacePoint& corner) { corners[count++] = corner; }
    FacePoint take(int index) {
        const FacePoint taken = corners[index];
        corners[index] = corners[--count];
        return taken;
    }
};

/// Where the edge from -> to crosses the side; the ends lie on different sides of it.
template <class Side>
FacePoint crossing(const Side& side, const FacePoint& from, const FacePoint& to) {
    const std::int64_t beyond = side.beyond(from);
    const std::int64_t fraction = beyond * kUnitOne / (beyond - side.beyond(to));
    const auto blend = [fraction](std::int64_t a, std::int64_t b) {
        return a + round_unit_wide((b - a) * fraction);
    };
    FacePoint point{};
    point.place[0] = blend(from.place[0], to.place[0]);
    point.place[1] = blend(from.place[1], to.place[1]);
    point.separation = blend(from.separation, to.separation);
    side.put_on(point);
    return point;
}

/// Sutherland and Hodgman's clip of a convex polygon to where side.beyond(point) <= 0; new corners
/// take the side's label. `out` has room for one corner more.
template <class Side, int kCornersMax>
void clip(const FacePolygon<kCornersMax>& in, const Side& side, FacePolygon<kCornersMax>& out) {
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
            FacePoint point = crossing(side, *from, *to);
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

/// The points of a face's contact.
struct FacePoints {
    FacePoint points[kManifoldPointsMax];
    int count = 0;
    std::int32_t min_separation = 0; // of all corners before the reduction to four
};

/// Twice the signed area of a triangle in the face.
inline std::int64_t area(const FacePoint& a, const FacePoint& b, const FacePoint& c) {
    return (b.place[0] - a.place[0]) * (c.place[1] - a.place[1]) -
           (b.place[1] - a.place[1]) * (c.place[0] - a.place[0]);
}

/// Index of the corner with the highest score; a later one must win by 1/32, so that rounding never
/// decides between equals. -1 where none reaches `least`.
template <int kCornersMax, class Score>
int best_corner(const FacePolygon<kCornersMax>& polygon, std::int64_t least, const Score& score) {
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
template <int kCornersMax>
void reduce(FacePolygon<kCornersMax>& polygon, FacePoints& out) {
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
template <int kCornersMax>
std::int32_t drop_far_corners(FacePolygon<kCornersMax>& polygon, std::int64_t limit) {
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

/// At most four corners, none above `limit`. Count 0 where nothing is within kSpeculativeMargin.
template <int kCornersMax>
void keep_contact(FacePolygon<kCornersMax>& polygon, std::int64_t limit, FacePoints& out) {
    out.count = 0;
    if (polygon.count == 0) {
        return;
    }
    out.min_separation = drop_far_corners(polygon, limit);
    if (out.min_separation > kSpeculativeMargin) {
        return;
    }
    if (polygon.count > static_cast<int>(kManifoldPointsMax)) {
        reduce(polygon, out);
        return;
    }
    for (int index = 0; index < polygon.count; ++index) {
        out.points[out.count++] = polygon.corners[index];
    }
}

} // namespace lockwind
