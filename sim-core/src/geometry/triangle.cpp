#include "geometry/triangle.h"

#include "geometry/polytope.h"

#include <algorithm>
#include <limits>

namespace lockwind {

namespace {

/// 2^-12: how far a direction may lie outside of the allowed ones.
constexpr int kSlackShift = 12;
constexpr std::int64_t kSlack = std::int64_t{1} << (2 * kUnitFraction - kSlackShift);

/// (a x b) . c / 2^30, |.| <= 1 each.
std::int64_t triple(const std::int32_t a[3], const std::int32_t b[3], const std::int32_t c[3]) {
    std::int32_t across[3];
    cross_units(a, b, across);
    return dot_wide(across, c);
}

/// Where the normals over an edge end: at the neighbour's, or past the end of the surface.
void open_edge(const Surface& surface,
               const SurfaceTriangle& triangle,
               int index,
               TriangleEdge& edge) {
    const std::uint32_t neighbour = triangle.neighbours[index];
    const std::int32_t* limit =
        neighbour == kNoIndex ? edge.outwards : surface.triangle(neighbour).normal;
    std::copy(limit, limit + 3, edge.limit);
    edge.is_open =
        triple(triangle.normal, limit, edge.direction) > std::int64_t{kFlatSine} * kUnitOne;
}

} // namespace

std::int64_t Triangle::beyond(int edge, const std::int32_t point[3]) const {
    return round_unit_wide(dot_between(edges[edge].outwards, corners[edge], point));
}

std::int64_t
Triangle::height_above(const Surface& surface, std::uint32_t index, const std::int32_t point[3]) {
    return round_unit_wide(
        dot_between(surface.triangle(index).normal, surface.corner(index, 0), point));
}

Triangle triangle_of(const Surface& surface, std::uint32_t index) {
    const SurfaceTriangle& from = surface.triangle(index);
    Triangle made{};
    made.surface = &surface;
    made.index = index;
    std::copy(from.normal, from.normal + 3, made.normal);
    for (int corner = 0; corner < 3; ++corner) {
        const std::int32_t* place = surface.place(from.corners[corner]);
        std::copy(place, place + 3, made.corners[corner]);
    }
    for (int index_of_edge = 0; index_of_edge < 3; ++index_of_edge) {
        TriangleEdge& edge = made.edges[index_of_edge];
        const std::int32_t* start = made.corners[index_of_edge];
        const std::int32_t* end = made.corners[(index_of_edge + 1) % 3];
        const std::int32_t way[3] = {end[0] - start[0], end[1] - start[1], end[2] - start[2]};
        edge.length = normalise(way, edge.direction);
        cross_units(edge.direction, made.normal, edge.outwards);
        open_edge(surface, from, index_of_edge, edge);
    }
    return made;
}

bool is_along_face(const Triangle& triangle, const std::int32_t direction[3]) {
    return round_unit_wide(dot_wide(triangle.normal, direction)) >= kAlongFaceCosine;
}

bool is_over_edge(const Triangle& triangle, int index, const std::int32_t direction[3]) {
    const TriangleEdge& edge = triangle.edges[index];
    return edge.is_open && triple(triangle.normal, direction, edge.direction) >= -kSlack &&
           triple(direction, edge.limit, edge.direction) >= -kSlack &&
           dot_wide(triangle.normal, direction) + dot_wide(edge.limit, direction) > 0;
}

bool is_over_corner(const Triangle& triangle, int corner, const std::int32_t direction[3]) {
    const Surface& surface = *triangle.surface;
    const std::uint32_t vertex = surface.triangle(triangle.index).corners[corner];
    if (dot_wide(surface.outwards(vertex), direction) <= 0) {
        return false;
    }
    const std::int32_t* from = surface.place(vertex);
    for (const std::uint32_t other : surface.ring(vertex)) {
        const std::int32_t* to = surface.place(other);
        std::int64_t size = 0;
        for (int axis = 0; axis < 3; ++axis) {
            size += magnitude(std::int64_t{to[axis]} - from[axis]);
        }
        if (dot_between(direction, from, to) > size << (kUnitFraction - kSlackShift)) {
            return false;
        }
    }
    return true;
}

TrianglePlace nearest_place(const Triangle& triangle, const std::int32_t point[3]) {
    TrianglePlace best{{}, TrianglePlace::Feature::face, 0};
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (int index = 0; index < 3; ++index) {
        if (triangle.beyond(index, point) <= 0) {
            continue;
        }
        const TriangleEdge& edge = triangle.edges[index];
        const std::int32_t* from = triangle.corners[index];
        const std::int64_t along = round_unit_wide(dot_between(edge.direction, from, point));
        if (along > 0 && along < edge.length) {
            // Nothing is nearer: not to be compared with a corner, from which a point just beside
            // it is as far but for rounding.
            TrianglePlace found{{}, TrianglePlace::Feature::edge, index};
            for (int axis = 0; axis < 3; ++axis) {
                found.place[axis] = from[axis] + round_unit(along * edge.direction[axis]);
            }
            return found;
        }
        const int corner = along <= 0 ? index : (index + 1) % 3;
        const std::int32_t* at = triangle.corners[corner];
        std::int32_t gap[3];
        for (int axis = 0; axis < 3; ++axis) {
            gap[axis] = raw_saturate<std::int32_t>(std::int64_t{point[axis]} - at[axis]);
        }
        if (squared_length(gap) < least) {
            least = squared_length(gap);
            best = {{at[0], at[1], at[2]}, TrianglePlace::Feature::corner, corner};
        }
    }
    if (best.feature == TrianglePlace::Feature::face) {
        const std::int64_t height = triangle.height(point);
        for (int axis = 0; axis < 3; ++axis) {
            best.place[axis] = raw_saturate<std::int32_t>(
                point[axis] - round_unit_wide(height * triangle.normal[axis]));
        }
    }
    return best;
}

bool is_normal_at(const Triangle& triangle,
                  const TrianglePlace& place,
                  const std::int32_t direction[3]) {
    switch (place.feature) {
    case TrianglePlace::Feature::face:
        return is_along_face(triangle, direction);
    case TrianglePlace::Feature::edge:
        return is_over_edge(triangle, place.index, direction);
    case TrianglePlace::Feature::corner:
        return is_over_corner(triangle, place.index, direction);
    }
    return false;
}

} // namespace lockwind
