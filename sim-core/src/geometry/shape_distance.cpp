#include "geometry/shape_distance.h"

#include "geometry/core_distance.h"
#include "geometry/fixed_geometry.h"
#include "geometry/rotation.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr int kFiner = 32 - kLengthFraction;

std::int64_t widened(std::int32_t length) {
    return std::int64_t{length} << kFiner;
}

void half_space_distance(const ConvexCore& a,
                         const ConvexCore& half_space,
                         const std::int64_t delta[3],
                         ShapeDistance& out) {
    const std::int32_t* normal = half_space.normal;
    std::int64_t lowest = 0;
    std::uint32_t nearest = 0;
    for (std::uint32_t index = 0; index < a.count; ++index) {
        const std::int64_t height = dot_wide(normal, a.points[index]);
        if (index == 0 || height < lowest) {
            lowest = height;
            nearest = index;
        }
    }
    out.distance =
        dot_unit(normal, delta) + (lowest >> (kUnitFraction - kFiner)) - widened(a.radius);
    out.overlapping = out.distance <= 0;
    out.separation = out.distance;
    std::copy(normal, normal + 3, out.normal);
    const std::int64_t down = out.distance + widened(a.radius);
    for (int axis = 0; axis < 3; ++axis) {
        out.point[axis] = delta[axis] + widened(a.points[nearest][axis]) -
                          multiply_divide(down, normal[axis], kUnitOne);
    }
}

} // namespace

void shape_distance(const ConvexCore& a,
                    const ConvexCore& b,
                    const std::int64_t delta[3],
                    ShapeDistance& out) {
    if (b.count == 0) {
        half_space_distance(a, b, delta, out);
        return;
    }
    CoreDistance cores{};
    core_distance(a, b, delta, cores);
    const std::int64_t radii = widened(a.radius) + widened(b.radius);
    out.overlapping = cores.overlapping || cores.distance <= radii;
    if (out.overlapping) {
        return;
    }
    out.distance = cores.distance - radii;
    out.separation = cores.separation - radii;
    for (int axis = 0; axis < 3; ++axis) {
        out.normal[axis] = cores.normal[axis];
        out.point[axis] =
            cores.point_b[axis] + multiply_divide(widened(b.radius), cores.normal[axis], kUnitOne);
    }
}

} // namespace lockwind
