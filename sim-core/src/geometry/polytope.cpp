#include "geometry/polytope.h"

#include "geometry/fixed_geometry.h"

#include <algorithm>
#include <array>
#include <limits>

namespace lockwind {

namespace {

// A box: bit i of a vertex says whether it lies on the positive side of axis i; face 2 i is the
// negative side of axis i, 2 i + 1 the positive one.
struct BoxTopology {
    std::array<HullEdge, 12> edges{};
    std::array<HullCorner, 24> corners{};
    std::uint8_t edge_count = 0;

    /// Index of the edge from `from` to `to` as the corner of this face; made if no face had it
    /// yet.
    constexpr std::uint8_t edge_between(std::uint8_t from, std::uint8_t to, std::uint8_t face) {
        for (std::uint8_t edge = 0; edge < edge_count; ++edge) {
            if (edges[edge].from == to && edges[edge].to == from) {
                edges[edge].right = face;
                return edge;
            }
        }
        HullEdge& made = edges[edge_count];
        made.from = from;
        made.to = to;
        made.left = face;
        for (std::size_t component = 0; component < 3; ++component) {
            const bool along = ((from ^ to) >> component & 1) != 0;
            const bool forth = (to >> component & 1) != 0;
            made.direction[component] = along ? (forth ? kUnitOne : -kUnitOne) : 0;
        }
        return edge_count++;
    }
};

constexpr BoxTopology make_box_topology() {
    BoxTopology box;
    for (std::size_t face = 0; face < 6; ++face) {
        const std::size_t axis = face / 2;
        const bool positive = face % 2 != 0;
        const auto u = static_cast<std::uint8_t>(1U << (axis + 1) % 3);
        const auto v = static_cast<std::uint8_t>(1U << (axis + 2) % 3);
        const auto side = static_cast<std::uint8_t>(positive ? 1U << axis : 0U);
        const std::uint8_t around[4] = {0, u, static_cast<std::uint8_t>(u | v), v};
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const std::size_t next = (corner + 1) % 4;
            const auto at = [&](std::size_t step) {
                return static_cast<std::uint8_t>(side | around[positive ? step : (4 - step) % 4]);
            };
            const std::uint8_t from = at(corner);
            const std::uint8_t to = at(next);
            box.corners[4 * face + corner] = {
                from, box.edge_between(from, to, static_cast<std::uint8_t>(face))};
        }
    }
    return box;
}

constexpr BoxTopology kBox = make_box_topology();

Polytope polytope_of_box(const std::int32_t half_extents[3], BoxFeatures& room) {
    for (std::uint32_t vertex = 0; vertex < 8; ++vertex) {
        HullVertex& made = room.vertices[vertex];
        made.faces = 0;
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            const std::uint32_t positive = vertex >> axis & 1U;
            made.place[axis] = positive != 0 ? half_extents[axis] : -half_extents[axis];
            made.faces |= std::uint64_t{1} << (2 * axis + positive);
        }
    }
    for (std::uint32_t face = 0; face < 6; ++face) {
        HullFace& made = room.faces[face];
        made = {{0, 0, 0}, half_extents[face / 2], static_cast<std::uint16_t>(4 * face), 4};
        made.normal[face / 2] = face % 2 != 0 ? kUnitOne : -kUnitOne;
    }
    return {room.vertices, room.faces, kBox.edges.data(), kBox.corners.data(), 8, 6, 12};
}

/// Direction from a face's corner to the next.
void way_along(const Polytope& polytope,
               std::uint32_t face,
               std::uint32_t corner,
               std::int32_t way[3]) {
    const HullEdge& edge = polytope.edges[polytope.corner(polytope.faces[face], corner).edge];
    for (int axis = 0; axis < 3; ++axis) {
        way[axis] = edge.left == face ? edge.direction[axis] : -edge.direction[axis];
    }
}

/// Whether a point lies above the face itself, not beside it.
bool is_above_face(const Polytope& polytope, std::uint32_t face, const std::int32_t point[3]) {
    const std::uint32_t count = polytope.faces[face].corner_count;
    for (std::uint32_t corner = 0; corner < count; ++corner) {
        std::int32_t normal[3];
        side_normal(polytope, face, corner, normal);
        if (dot_between(normal, polytope.place(polytope.faces[face], corner), point) > 0) {
            return false;
        }
    }
    return true;
}

/// The edge's point nearest to `point`.
void nearest_on_edge(const Polytope& polytope,
                     const HullEdge& edge,
                     const std::int32_t point[3],
                     std::int32_t place[3]) {
    const std::int32_t* from = polytope.vertices[edge.from].place;
    const std::int32_t* to = polytope.vertices[edge.to].place;
    const std::int64_t along = round_unit_wide(dot_between(edge.direction, from, point));
    const std::int64_t whole = round_unit_wide(dot_between(edge.direction, from, to));
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t way = clamped<std::int64_t>(along, 0, whole) * edge.direction[axis];
        place[axis] = static_cast<std::int32_t>(from[axis] + round_unit_wide(way));
    }
    if (along >= whole) {
        std::copy(to, to + 3, place);
    }
}

} // namespace

Polytope polytope_of(const ShapeInstance& shape, BoxFeatures& room) {
    if (shape.type != ShapeType::hull) {
        return polytope_of_box(shape.size, room);
    }
    const Hull& hull = *shape.hull;
    return {hull.vertices.data(),
            hull.faces.data(),
            hull.edges.data(),
            hull.corners.data(),
            hull.vertex_count,
            hull.face_count,
            hull.edge_count};
}

FaceAxes axes_of(const Polytope& polytope, const HullFace& face) {
    FaceAxes axes{};
    way_along(polytope, static_cast<std::uint32_t>(&face - polytope.faces), 0, axes.u);
    cross_units(face.normal, axes.u, axes.v);
    return axes;
}

void side_normal(const Polytope& polytope,
                 std::uint32_t face,
                 std::uint32_t corner,
                 std::int32_t normal[3]) {
    std::int32_t way[3];
    way_along(polytope, face, corner, way);
    cross_units(way, polytope.faces[face].normal, normal);
}

bool nearest_point(const Polytope& polytope, const std::int32_t point[3], NearestPoint& out) {
    std::uint64_t visible = 0;
    std::int64_t highest = std::numeric_limits<std::int64_t>::min();
    for (std::uint32_t face = 0; face < polytope.face_count; ++face) {
        const std::int64_t height = height_above(polytope.faces[face], point);
        visible |= height > 0 ? std::uint64_t{1} << face : 0;
        if (height > highest) {
            highest = height;
            out.face = face;
        }
        if (height > 0 && is_above_face(polytope, face, point)) {
            out.face = face;
            out.in_edge = false;
            for (int axis = 0; axis < 3; ++axis) {
                out.place[axis] =
                    point[axis] - round_unit(height * polytope.faces[face].normal[axis]);
            }
            return true;
        }
    }
    if (visible == 0) {
        return false;
    }
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (std::uint32_t index = 0; index < polytope.edge_count; ++index) {
        const HullEdge& edge = polytope.edges[index];
        if (((visible >> edge.left | visible >> edge.right) & 1U) == 0) {
            continue;
        }
        std::int32_t place[3];
        std::int32_t gap[3];
        nearest_on_edge(polytope, edge, point, place);
        for (int axis = 0; axis < 3; ++axis) {
            gap[axis] = raw_saturate<std::int32_t>(std::int64_t{point[axis]} - place[axis]);
        }
        const std::uint64_t square = squared_length(gap);
        if (square < least) {
            least = square;
            out.face = (visible >> edge.left & 1U) != 0 ? edge.left : edge.right;
            out.in_edge = true;
            std::copy(place, place + 3, out.place);
        }
    }
    return true;
}

} // namespace lockwind
