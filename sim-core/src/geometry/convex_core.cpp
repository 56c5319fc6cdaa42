#include "geometry/convex_core.h"

#include "geometry/fixed_geometry.h"
#include "geometry/hull.h"
#include "geometry/rotation.h"
#include "geometry/surface.h"

#include "lockwind/assert.h"

#include <algorithm>

namespace lockwind {

namespace {

void add_point(const ShapeInstance& shape, const std::int32_t place[3], ConvexCore& core) {
    std::int32_t* point = core.points[core.count++];
    rotate(shape.rotation, place, point);
    const std::uint64_t square = squared_length(point);
    core.reach = std::max(core.reach, static_cast<std::int32_t>(floor_sqrt(square)) + 1);
    for (int axis = 0; axis < 3; ++axis) {
        core.half_extents[axis] =
            std::max(core.half_extents[axis], magnitude(point[axis]) + core.radius);
    }
}

void add_corners(const ShapeInstance& shape, ConvexCore& core) {
    for (int corner = 0; corner < 8; ++corner) {
        std::int32_t place[3];
        for (int axis = 0; axis < 3; ++axis) {
            place[axis] = (corner >> axis & 1) != 0 ? shape.size[axis] : -shape.size[axis];
        }
        add_point(shape, place, core);
    }
}

void clear(ConvexCore& core, std::int32_t radius) {
    core.count = 0;
    core.radius = radius;
    core.reach = 0;
    std::fill(core.half_extents, core.half_extents + 3, radius);
    std::fill(core.normal, core.normal + 3, 0);
}

void add_centre(ConvexCore& core) {
    std::fill(core.points[0], core.points[0] + 3, 0);
    core.count = 1;
}

} // namespace

void make_core(const ShapeInstance& shape, ConvexCore& core) {
    const bool is_round = shape.type == ShapeType::sphere || shape.type == ShapeType::capsule;
    clear(core, is_round ? shape.size[0] : 0);
    switch (shape.type) {
    case ShapeType::sphere:
        add_centre(core);
        return;
    case ShapeType::capsule:
        for (const std::int32_t end : {-shape.size[1], shape.size[1]}) {
            const std::int32_t place[3] = {0, end, 0};
            add_point(shape, place, core);
        }
        return;
    case ShapeType::box:
        add_corners(shape, core);
        return;
    case ShapeType::hull:
        for (std::uint32_t vertex = 0; vertex < shape.hull->vertex_count; ++vertex) {
            add_point(shape, shape.hull->vertices[vertex].place, core);
        }
        return;
    case ShapeType::plane:
        for (int row = 0; row < 3; ++row) {
            core.normal[row] = shape.rotation[3 * row + 1];
        }
        return;
    case ShapeType::compound:
    case ShapeType::height_field:
    case ShapeType::mesh:
        break;
    }
    LOCKWIND_ASSERT(!is_composite(shape.type));
}

void make_triangle_core(const ShapeInstance& surface, std::uint32_t index, ConvexCore& core) {
    clear(core, 0);
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
        add_point(surface, surface.surface->corner(index, corner), core);
    }
}

void make_point_core(ConvexCore& core) {
    clear(core, 0);
    add_centre(core);
}

} // namespace lockwind
