#pragma once

#include "geometry/collide.h"
#include "geometry/compound.h"
#include "geometry/fixed_geometry.h"
#include "geometry/hull.h"
#include "geometry/rotation.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <limits>

namespace lockwind {

// One kernel per pair of types; the first shape is the one whose type comes later in ShapeType.
// Each finds `out` with point_count 0 and axis 0. |delta| < 512 m.

void collide_spheres(const ShapeInstance& a,
                     const ShapeInstance& b,
                     const std::int32_t delta[3],
                     ManifoldGeometry& out);
void collide_capsule_sphere(const ShapeInstance& capsule,
                            const ShapeInstance& sphere,
                            const std::int32_t delta[3],
                            ManifoldGeometry& out);
void collide_box_sphere(const ShapeInstance& box,
                        const ShapeInstance& sphere,
                        const std::int32_t delta[3],
                        ManifoldGeometry& out);
void collide_capsules(const ShapeInstance& a,
                      const ShapeInstance& b,
                      const std::int32_t delta[3],
                      ManifoldGeometry& out);
void collide_box_capsule(const ShapeInstance& box,
                         const ShapeInstance& capsule,
                         const std::int32_t delta[3],
                         ManifoldGeometry& out);
void collide_boxes(const ShapeInstance& a,
                   const ShapeInstance& b,
                   const std::int32_t delta[3],
                   const ManifoldCache& cache,
                   ManifoldGeometry& out);
void collide_plane_sphere(const ShapeInstance& plane,
                          const ShapeInstance& sphere,
                          const std::int32_t delta[3],
                          ManifoldGeometry& out);
void collide_plane_capsule(const ShapeInstance& plane,
                           const ShapeInstance& capsule,
                           const std::int32_t delta[3],
                           ManifoldGeometry& out);
void collide_plane_box(const ShapeInstance& plane,
                       const ShapeInstance& box,
                       const std::int32_t delta[3],
                       ManifoldGeometry& out);
void collide_hull_sphere(const ShapeInstance& hull,
                         const ShapeInstance& sphere,
                         const std::int32_t delta[3],
                         ManifoldGeometry& out);
void collide_hull_capsule(const ShapeInstance& hull,
                          const ShapeInstance& capsule,
                          const std::int32_t delta[3],
                          ManifoldGeometry& out);
void collide_hull_plane(const ShapeInstance& hull,
                        const ShapeInstance& plane,
                        const std::int32_t delta[3],
                        ManifoldGeometry& out);
/// A hull and a hull or box.
void collide_polytopes(const ShapeInstance& a,
                       const ShapeInstance& b,
                       const std::int32_t delta[3],
                       const ManifoldCache& cache,
                       ManifoldGeometry& out);

// A surface is the one of its triangles that ShapeInstance::part tells.
void collide_triangle_sphere(const ShapeInstance& surface,
                             const ShapeInstance& sphere,
                             const std::int32_t delta[3],
                             ManifoldGeometry& out);
void collide_triangle_capsule(const ShapeInstance& surface,
                              const ShapeInstance& capsule,
                              const std::int32_t delta[3],
                              ManifoldGeometry& out);
/// A triangle and a hull or box.
void collide_triangle_polytope(const ShapeInstance& surface,
                               const ShapeInstance& polytope,
                               const std::int32_t delta[3],
                               ManifoldGeometry& out);

/// Half the longest and shortest way across, Q9.22; of planes and surfaces, more than any.
struct Girth {
    std::int32_t longest;
    std::int32_t shortest;
};

inline Girth girth_of(const ShapeInstance& shape);

/// Of the thinnest child.
inline Girth least_girth(const Compound& compound) {
    constexpr std::int32_t kEndless = std::numeric_limits<std::int32_t>::max();
    Girth least{kEndless, kEndless};
    for (std::uint32_t index = 0; index < compound.child_count; ++index) {
        const CompoundShape& child = compound.children[index];
        const Girth girth = girth_of(
            {child.type, {child.size[0], child.size[1], child.size[2]}, nullptr, child.hull});
        least.shortest = std::min(least.shortest, girth.shortest);
    }
    return least;
}

inline Girth girth_of(const ShapeInstance& shape) {
    constexpr std::int32_t kEndless = std::numeric_limits<std::int32_t>::max();
    const std::int32_t* size = shape.size;
    switch (shape.type) {
    case ShapeType::sphere:
        return {size[0], size[0]};
    case ShapeType::capsule:
        return {size[0] + size[1], size[0]};
    case ShapeType::box:
        return {std::max({size[0], size[1], size[2]}), std::min({size[0], size[1], size[2]})};
    case ShapeType::hull:
        return {shape.hull->width_most, shape.hull->width_least};
    case ShapeType::compound:
        LOCKWIND_ASSERT(shape.compound != nullptr);
        return least_girth(*shape.compound);
    case ShapeType::plane:
    case ShapeType::height_field:
    case ShapeType::mesh:
        break;
    }
    return {kEndless, kEndless};
}

/// Where on the line between two surfaces their common point lies: halfway; but where they overlap,
/// no deeper below the thinner shape's surface than a quarter of its half thickness, so that
/// however deep they overlap the solver's arms are not longer than the bodies (make_body relies on
/// it). Where on the line it lies does not change the torque of an impulse along the normal.
struct Midway {
    std::int32_t depth_max;
    bool first_is_thinner;
    /// Up to here a touching face brings its farther points along, so that a recycled manifold
    /// still holds when the body rocks.
    std::int32_t companion_separation;

    std::int32_t from_first(std::int32_t separation) const {
        const std::int32_t half = separation >> 1;
        if (half >= -depth_max) {
            return half;
        }
        return first_is_thinner ? -depth_max : separation + depth_max;
    }
};

inline Midway midway(const ShapeInstance& first, const ShapeInstance& second) {
    const Girth a = girth_of(first);
    const Girth b = girth_of(second);
    return {std::min(a.shortest, b.shortest) >> 2,
            a.shortest < b.shortest,
            kSpeculativeMargin + (std::min(a.longest, b.longest) >> 1)};
}

/// World direction of the body's axis `column`.
inline void axis_of(const ShapeInstance& shape, int column, std::int32_t axis[3]) {
    for (int row = 0; row < 3; ++row) {
        axis[row] = shape.rotation[3 * row + column];
    }
}

/// A world vector in the shape's frame; a sphere's frame never turns.
inline void to_local(const ShapeInstance& shape, const std::int32_t v[3], std::int32_t local[3]) {
    if (shape.type == ShapeType::sphere) {
        for (int axis = 0; axis < 3; ++axis) {
            local[axis] = v[axis];
        }
    } else {
        inverse_rotate(shape.rotation, v, local);
    }
}

/// Places a point: `middle` is the mid-surface point relative to A's centre, world axes.
inline void place_point(const ShapeInstance& a,
                        const ShapeInstance& b,
                        const std::int32_t delta[3],
                        const std::int32_t middle[3],
                        ManifoldPoint& point) {
    const std::int32_t from_b[3] = {
        middle[0] - delta[0], middle[1] - delta[1], middle[2] - delta[2]};
    to_local(a, middle, point.local_a);
    to_local(b, from_b, point.local_b);
}

} // namespace lockwind
