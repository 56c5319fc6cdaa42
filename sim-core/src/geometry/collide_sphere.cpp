#include "geometry/pair_kernels.h"

namespace lockwind {

namespace {

constexpr std::uint32_t kSphereFeature = 1;

/// True where a vector of that squared length is longer than `reach`, which is positive.
bool beyond(std::uint64_t square, std::int64_t reach) {
    return square > static_cast<std::uint64_t>(reach * reach);
}

/// The one contact of a rounded shape A and sphere B: `core` is A's core point nearest to B's
/// centre, `radius_a` A's radius about it, `normal` the direction from it to B's centre, `distance`
/// the way.
struct RoundContact {
    std::int32_t core[3];
    std::int32_t normal[3];
    std::int32_t radius_a;
    std::int32_t distance;
};

void emit_round(const ShapeInstance& a,
                const ShapeInstance& sphere,
                const std::int32_t delta[3],
                const RoundContact& contact,
                ManifoldGeometry& out) {
    const std::int32_t separation = contact.distance - contact.radius_a - sphere.size[0];
    if (separation > kSpeculativeMargin) {
        return;
    }
    const std::int32_t reach = contact.radius_a + midway(a, sphere).from_first(separation);
    std::int32_t middle[3];
    for (int axis = 0; axis < 3; ++axis) {
        out.normal[axis] = contact.normal[axis];
        middle[axis] = contact.core[axis] + scale(reach, contact.normal[axis]);
    }
    ManifoldPoint& point = out.points[0];
    place_point(a, sphere, delta, middle, point);
    point.separation = separation;
    point.feature = kSphereFeature;
    out.point_count = 1;
}

/// For a centre inside a box or on its surface: the way out through the nearest face. Returns the
/// face's axis.
int leave_through_face(const ShapeInstance& box,
                       const std::int32_t centre[3],
                       std::int32_t normal[3],
                       std::int32_t& distance) {
    normal[0] = normal[1] = normal[2] = 0;
    int face = 0;
    distance = magnitude(centre[0]) - box.size[0];
    for (int axis = 1; axis < 3; ++axis) {
        const std::int32_t separation = magnitude(centre[axis]) - box.size[axis];
        if (separation > distance) {
            distance = separation;
            face = axis;
        }
    }
    normal[face] = centre[face] < 0 ? -kUnitOne : kUnitOne;
    return face;
}

} // namespace

void collide_spheres(const ShapeInstance& a,
                     const ShapeInstance& b,
                     const std::int32_t delta[3],
                     ManifoldGeometry& out) {
    const std::int64_t reach = std::int64_t{a.size[0]} + b.size[0] + kSpeculativeMargin + 1;
    if (beyond(squared_length(delta), reach)) {
        return;
    }
    RoundContact contact{{0, 0, 0}, {0, kUnitOne, 0}, a.size[0], 0};
    contact.distance = normalise(delta, contact.normal);
    emit_round(a, b, delta, contact, out);
}

void collide_capsule_sphere(const ShapeInstance& capsule,
                            const ShapeInstance& sphere,
                            const std::int32_t delta[3],
                            ManifoldGeometry& out) {
    std::int32_t direction[3];
    axis_of(capsule, 1, direction);
    const std::int64_t along = round_unit_wide(dot_wide(direction, delta));
    const auto nearest =
        static_cast<std::int32_t>(clamped<std::int64_t>(along, -capsule.size[1], capsule.size[1]));
    RoundContact contact{};
    contact.radius_a = capsule.size[0];
    std::int32_t offset[3];
    for (int axis = 0; axis < 3; ++axis) {
        contact.core[axis] = scale(nearest, direction[axis]);
        offset[axis] = delta[axis] - contact.core[axis];
    }
    const std::int64_t reach =
        std::int64_t{capsule.size[0]} + sphere.size[0] + kSpeculativeMargin + 1;
    if (beyond(squared_length(offset), reach)) {
        return;
    }
    contact.distance = normalise(offset, contact.normal);
    if (contact.distance < kDirectionMin) { // a centre on the segment leaves sideways
        axis_of(capsule, 0, contact.normal);
    }
    emit_round(capsule, sphere, delta, contact, out);
}

void collide_box_sphere(const ShapeInstance& box,
                        const ShapeInstance& sphere,
                        const std::int32_t delta[3],
                        ManifoldGeometry& out) {
    std::int32_t centre[3];
    inverse_rotate(box.rotation, delta, centre);
    std::int32_t surface[3];
    std::int32_t offset[3];
    const std::int64_t reach = std::int64_t{sphere.size[0]} + kSpeculativeMargin + 1;
    for (int axis = 0; axis < 3; ++axis) {
        surface[axis] = clamped(centre[axis], -box.size[axis], box.size[axis]);
        offset[axis] = centre[axis] - surface[axis];
    }
    if (beyond(squared_length(offset), reach)) {
        return;
    }
    std::int32_t normal[3] = {0, 0, 0};
    std::int32_t distance = normalise(offset, normal);
    if (distance < kDirectionMin) {
        const int face = leave_through_face(box, centre, normal, distance);
        surface[face] = normal[face] < 0 ? -box.size[face] : box.size[face];
    }
    const std::int32_t separation = distance - sphere.size[0];
    if (separation > kSpeculativeMargin) {
        return;
    }
    ManifoldPoint& point = out.points[0];
    const std::int32_t lift = midway(box, sphere).from_first(separation);
    std::int32_t from_sphere[3];
    for (int axis = 0; axis < 3; ++axis) {
        point.local_a[axis] = surface[axis] + scale(lift, normal[axis]);
        from_sphere[axis] = point.local_a[axis] - centre[axis];
    }
    rotate(box.rotation, from_sphere, point.local_b);
    rotate(box.rotation, normal, out.normal);
    point.separation = separation;
    point.feature = kSphereFeature;
    out.point_count = 1;
}

void collide_plane_sphere(const ShapeInstance& plane,
                          const ShapeInstance& sphere,
                          const std::int32_t delta[3],
                          ManifoldGeometry& out) {
    RoundContact contact{};
    axis_of(plane, 1, contact.normal);
    contact.distance = round_unit(dot_wide(contact.normal, delta));
    for (int axis = 0; axis < 3; ++axis) {
        contact.core[axis] = delta[axis] - scale(contact.distance, contact.normal[axis]);
    }
    emit_round(plane, sphere, delta, contact, out);
}

} // namespace lockwind
