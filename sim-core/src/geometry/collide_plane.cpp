#include "geometry/pair_kernels.h"
#include "geometry/polytope_face.h"

#include <limits>

namespace lockwind {

namespace {

/// Places the point of B at `from_b` (world axes, from B's centre), `separation` above the plane.
void emit_plane_point(const ShapeInstance& plane,
                      const ShapeInstance& b,
                      const std::int32_t delta[3],
                      const std::int32_t from_b[3],
                      std::int32_t separation,
                      ManifoldGeometry& out) {
    const std::int32_t below = separation - midway(plane, b).from_first(separation);
    std::int32_t middle[3];
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = delta[axis] + from_b[axis] - scale(below, out.normal[axis]);
    }
    ManifoldPoint& point = out.points[out.point_count];
    place_point(plane, b, delta, middle, point);
    point.separation = separation;
    ++out.point_count;
}

/// A corner of a box: bit i set where it lies on the positive side of axis i.
struct Corner {
    std::uint32_t signs;
    std::int32_t separation;
};

/// The four corners that lie deepest, deepest first. Turning a corner's sign on axis i lifts it by
/// 2 |lift[i]|: with i <= j <= k by that cost, the deepest ones are none, i, j and the cheaper of
/// i and j together or k. Ties take the lower axis, and i and j.
void deepest_corners(const std::int32_t lift[3], std::int32_t height, Corner corners[4]) {
    std::uint32_t signs = 0;
    std::int64_t lowest = height;
    int order[3] = {0, 1, 2};
    for (int axis = 0; axis < 3; ++axis) {
        signs |= lift[axis] < 0 ? 1U << axis : 0U;
        lowest -= magnitude(lift[axis]);
    }
    const auto sort_pair = [&](int first, int second) {
        if (magnitude(lift[order[first]]) > magnitude(lift[order[second]])) {
            const int kept = order[first];
            order[first] = order[second];
            order[second] = kept;
        }
    };
    sort_pair(0, 1);
    sort_pair(1, 2);
    sort_pair(0, 1);
    const std::int64_t cost[3] = {2 * std::int64_t{magnitude(lift[order[0]])},
                                  2 * std::int64_t{magnitude(lift[order[1]])},
                                  2 * std::int64_t{magnitude(lift[order[2]])}};
    const std::uint32_t bit[3] = {1U << order[0], 1U << order[1], 1U << order[2]};
    const bool both = cost[0] + cost[1] <= cost[2];
    const auto corner = [&](std::uint32_t turned, std::int64_t lifted) {
        return Corner{signs ^ turned, raw_saturate<std::int32_t>(lowest + lifted)};
    };
    corners[0] = corner(0, 0);
    corners[1] = corner(bit[0], cost[0]);
    corners[2] = corner(bit[1], cost[1]);
    corners[3] = both ? corner(bit[0] | bit[1], cost[0] + cost[1]) : corner(bit[2], cost[2]);
}

} // namespace

void collide_plane_capsule(const ShapeInstance& plane,
                           const ShapeInstance& capsule,
                           const std::int32_t delta[3],
                           ManifoldGeometry& out) {
    axis_of(plane, 1, out.normal);
    std::int32_t direction[3];
    axis_of(capsule, 1, direction);
    const std::int32_t radius = capsule.size[0];
    const std::int32_t height = round_unit(dot_wide(out.normal, delta));
    const std::int32_t rise = scale(capsule.size[1], round_unit(dot_wide(out.normal, direction)));
    if (std::int64_t{height} - magnitude(rise) - radius > kSpeculativeMargin) {
        return;
    }
    for (int end = 0; end < 2; ++end) {
        const std::int32_t sign = end == 0 ? -1 : 1;
        std::int32_t from_b[3];
        for (int axis = 0; axis < 3; ++axis) {
            from_b[axis] =
                scale(sign * capsule.size[1], direction[axis]) - scale(radius, out.normal[axis]);
        }
        out.points[out.point_count].feature = end == 0 ? 1U : 2U;
        const std::int64_t separation = std::int64_t{height} + sign * rise - radius;
        emit_plane_point(
            plane, capsule, delta, from_b, raw_saturate<std::int32_t>(separation), out);
    }
}

void collide_plane_box(const ShapeInstance& plane,
                       const ShapeInstance& box,
                       const std::int32_t delta[3],
                       ManifoldGeometry& out) {
    axis_of(plane, 1, out.normal);
    const std::int32_t height = round_unit(dot_wide(out.normal, delta));
    std::int32_t lift[3];
    std::int32_t half_axis[3][3];
    for (int axis = 0; axis < 3; ++axis) {
        std::int32_t direction[3];
        axis_of(box, axis, direction);
        lift[axis] = scale(box.size[axis], round_unit(dot_wide(out.normal, direction)));
        for (int row = 0; row < 3; ++row) {
            half_axis[axis][row] = scale(box.size[axis], direction[row]);
        }
    }
    Corner corners[4];
    deepest_corners(lift, height, corners);
    if (corners[0].separation > kSpeculativeMargin) {
        return;
    }
    for (const Corner& corner : corners) {
        std::int32_t from_b[3] = {0, 0, 0};
        for (int axis = 0; axis < 3; ++axis) {
            const std::int32_t sign = (corner.signs >> axis & 1U) != 0 ? 1 : -1;
            for (int row = 0; row < 3; ++row) {
                from_b[row] += sign * half_axis[axis][row];
            }
        }
        out.points[out.point_count].feature = corner.signs + 1;
        emit_plane_point(plane, box, delta, from_b, corner.separation, out);
    }
}

/// The corners of the face that lies lowest, all of them, or four.
void collide_hull_plane(const ShapeInstance& hull,
                        const ShapeInstance& plane,
                        const std::int32_t delta[3],
                        ManifoldGeometry& out) {
    std::int32_t up[3];
    std::int32_t direction[3];
    axis_of(plane, 1, up);
    inverse_rotate(hull.rotation, up, direction);
    BoxFeatures room;
    const Polytope polytope = polytope_of(hull, room);
    const std::uint32_t face = face_against(polytope, direction);
    // In the plane's own axes z and x; the hull's centre stands -delta from the plane's foot.
    const std::int64_t height = -round_unit_wide(dot_wide(up, delta));
    std::int32_t axes[2][3];
    for (int index = 0; index < 2; ++index) {
        std::int32_t axis[3];
        axis_of(plane, index == 0 ? 2 : 0, axis);
        inverse_rotate(hull.rotation, axis, axes[index]);
    }
    FacePolygon<kHullVerticesMax> polygon;
    for (std::uint32_t corner = 0; corner < polytope.faces[face].corner_count; ++corner) {
        const std::int32_t* place = polytope.place(polytope.faces[face], corner);
        const std::uint8_t vertex = polytope.corner(polytope.faces[face], corner).vertex;
        polygon.add(
            {{round_unit_wide(dot_wide(axes[0], place)), round_unit_wide(dot_wide(axes[1], place))},
             height + round_unit_wide(dot_wide(direction, place)),
             vertex,
             vertex});
    }
    FacePoints contact;
    keep_contact(polygon, std::numeric_limits<std::int64_t>::max(), contact);
    const Midway between = midway(hull, plane);
    for (int index = 0; index < contact.count; ++index) {
        const FacePoint& from = contact.points[index];
        ManifoldPoint& point = out.points[index];
        point.separation = raw_saturate<std::int32_t>(from.separation);
        const std::int32_t lift = between.from_first(point.separation);
        std::int32_t middle[3];
        for (int axis = 0; axis < 3; ++axis) {
            point.local_a[axis] =
                polytope.vertices[from.edge_in].place[axis] - scale(lift, direction[axis]);
        }
        rotate(hull.rotation, point.local_a, middle);
        for (int axis = 0; axis < 3; ++axis) {
            middle[axis] -= delta[axis];
        }
        to_local(plane, middle, point.local_b);
        point.feature = from.edge_in + 1U;
    }
    for (int axis = 0; axis < 3; ++axis) {
        out.normal[axis] = -up[axis];
    }
    out.point_count = static_cast<std::uint32_t>(contact.count);
}

} // namespace lockwind
