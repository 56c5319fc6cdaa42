#include "geometry/collide.h"

#include "geometry/pair_kernels.h"
#include "geometry/surface.h"

#include "lockwind/assert.h"

#include <utility>

namespace lockwind {

namespace {

/// 511 m, Q9.22: pairs of allowed sizes whose centres are farther apart are separated.
constexpr std::int64_t kDeltaMax = std::int64_t{511} << kLengthFraction;
/// 400 m, Q31.32: leaves room for the other body's points.
constexpr std::int64_t kHeightMax = std::int64_t{400} << 32;

constexpr int kTypes = 8;

constexpr int pair_key(ShapeType first, ShapeType second) {
    return static_cast<int>(first) * kTypes + static_cast<int>(second);
}

/// A surface's triangle; `other` is no compound.
void collide_surface(const ShapeInstance& surface,
                     const ShapeInstance& other,
                     const std::int32_t delta[3],
                     ManifoldGeometry& out) {
    switch (other.type) {
    case ShapeType::sphere:
        return collide_triangle_sphere(surface, other, delta, out);
    case ShapeType::capsule:
        return collide_triangle_capsule(surface, other, delta, out);
    case ShapeType::box:
    case ShapeType::hull:
        return collide_triangle_polytope(surface, other, delta, out);
    default:
        return; // neither planes nor surfaces move
    }
}

/// `first.type` >= `second.type`.
void collide_ordered(const ShapeInstance& first,
                     const ShapeInstance& second,
                     const std::int32_t delta[3],
                     const ManifoldCache& cache,
                     ManifoldGeometry& out) {
    if (is_surface(first.type)) {
        if (first.part < first.surface->triangle_count()) {
            collide_surface(first, second, delta, out);
        }
        return;
    }
    switch (pair_key(first.type, second.type)) {
    case pair_key(ShapeType::sphere, ShapeType::sphere):
        return collide_spheres(first, second, delta, out);
    case pair_key(ShapeType::capsule, ShapeType::sphere):
        return collide_capsule_sphere(first, second, delta, out);
    case pair_key(ShapeType::capsule, ShapeType::capsule):
        return collide_capsules(first, second, delta, out);
    case pair_key(ShapeType::box, ShapeType::sphere):
        return collide_box_sphere(first, second, delta, out);
    case pair_key(ShapeType::box, ShapeType::capsule):
        return collide_box_capsule(first, second, delta, out);
    case pair_key(ShapeType::box, ShapeType::box):
        return collide_boxes(first, second, delta, cache, out);
    case pair_key(ShapeType::plane, ShapeType::sphere):
        return collide_plane_sphere(first, second, delta, out);
    case pair_key(ShapeType::plane, ShapeType::capsule):
        return collide_plane_capsule(first, second, delta, out);
    case pair_key(ShapeType::plane, ShapeType::box):
        return collide_plane_box(first, second, delta, out);
    case pair_key(ShapeType::hull, ShapeType::sphere):
        return collide_hull_sphere(first, second, delta, out);
    case pair_key(ShapeType::hull, ShapeType::capsule):
        return collide_hull_capsule(first, second, delta, out);
    case pair_key(ShapeType::hull, ShapeType::plane):
        return collide_hull_plane(first, second, delta, out);
    case pair_key(ShapeType::hull, ShapeType::box):
    case pair_key(ShapeType::hull, ShapeType::hull):
        return collide_polytopes(first, second, delta, cache, out);
    default:
        return; // two planes do not meet; a compound's children do, one by one
    }
}

void swap_sides(ManifoldGeometry& manifold) {
    if (manifold.point_count == 0) {
        return; // nor is there a normal
    }
    for (std::int32_t& component : manifold.normal) {
        component = -component;
    }
    for (std::uint32_t index = 0; index < manifold.point_count; ++index) {
        ManifoldPoint& point = manifold.points[index];
        for (int axis = 0; axis < 3; ++axis) {
            std::swap(point.local_a[axis], point.local_b[axis]);
        }
    }
}

} // namespace

void centre_delta_plane(const ShapeInstance& a,
                        const std::int64_t position_a[3],
                        const ShapeInstance& b,
                        const std::int64_t position_b[3],
                        std::int32_t delta[3]) {
    LOCKWIND_ASSERT((a.type == ShapeType::plane) != (b.type == ShapeType::plane));
    std::int32_t normal[3];
    axis_of(a.type == ShapeType::plane ? a : b, 1, normal);
    std::int64_t difference[3];
    for (int axis = 0; axis < 3; ++axis) {
        difference[axis] = position_b[axis] - position_a[axis];
    }
    const std::int64_t height = clamped(dot_unit(normal, difference), -kHeightMax, kHeightMax);
    const auto length = static_cast<std::int32_t>(height >> (32 - kLengthFraction));
    for (int axis = 0; axis < 3; ++axis) {
        delta[axis] = scale(length, normal[axis]);
    }
}

void collide(const ShapeInstance& a,
             const ShapeInstance& b,
             const std::int32_t delta[3],
             const ManifoldCache& cache,
             ManifoldGeometry& out) {
    out.point_count = 0;
    out.axis = 0;
    out.axis_separation = 0;
    if (squared_length(delta) >= static_cast<std::uint64_t>(kDeltaMax * kDeltaMax)) {
        return;
    }
    if (a.type >= b.type) {
        collide_ordered(a, b, delta, cache, out);
        return;
    }
    const std::int32_t reverse[3] = {-delta[0], -delta[1], -delta[2]};
    collide_ordered(b, a, reverse, cache, out);
    swap_sides(out);
}

} // namespace lockwind
