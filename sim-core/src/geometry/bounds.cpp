#include "geometry/bounds.h"

#include "geometry/compound.h"
#include "geometry/fixed_geometry.h"
#include "geometry/hull.h"
#include "geometry/surface.h"

#include "lockwind/assert.h"
#include "lockwind/integer.h"

#include <algorithm>

namespace lockwind {

namespace {

/// Rounding of the matrix's entries moves a corner 433 m away by 2 ulp at most.
constexpr std::int32_t kMatrixError = 2;

std::int32_t round_up(std::int64_t sum) {
    return raw_narrow<std::int32_t>((sum + kUnitOne - 1) >> kUnitFraction) + kMatrixError;
}

void box_half_extents(const std::int32_t* rotation,
                      const std::int32_t size[3],
                      std::int32_t half_extents[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t* row = rotation + 3 * axis;
        half_extents[axis] = round_up(static_cast<std::int64_t>(magnitude(row[0])) * size[0] +
                                      static_cast<std::int64_t>(magnitude(row[1])) * size[1] +
                                      static_cast<std::int64_t>(magnitude(row[2])) * size[2]);
    }
}

void hull_half_extents(const ShapeInstance& shape, std::int32_t half_extents[3]) {
    const Hull& hull = *shape.hull;
    std::int64_t farthest[3] = {0, 0, 0};
    for (std::uint32_t vertex = 0; vertex < hull.vertex_count; ++vertex) {
        for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t place =
                dot_wide(shape.rotation + 3 * axis, hull.vertices[vertex].place);
            farthest[axis] = std::max(farthest[axis], magnitude(place));
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        half_extents[axis] = round_up(farthest[axis]);
    }
}

void compound_half_extents(const ShapeInstance& shape, std::int32_t half_extents[3]) {
    std::fill(half_extents, half_extents + 3, 0);
    for (std::uint32_t child = 0; child < shape.compound->child_count; ++child) {
        const CompoundPart part(shape, child);
        std::int32_t extents[3];
        bounds_half_extents(part.shape, extents);
        for (int axis = 0; axis < 3; ++axis) {
            half_extents[axis] =
                std::max(half_extents[axis], magnitude(part.offset[axis]) + extents[axis]);
        }
    }
}

} // namespace

void bounds_half_extents(const ShapeInstance& shape, std::int32_t half_extents[3]) {
    LOCKWIND_ASSERT(is_bounded(shape.type));
    if (shape.type == ShapeType::hull) {
        hull_half_extents(shape, half_extents);
        return;
    }
    if (shape.type == ShapeType::compound) {
        compound_half_extents(shape, half_extents);
        return;
    }
    if (is_surface(shape.type)) {
        box_half_extents(shape.rotation, shape.surface->half_extents(), half_extents);
        return;
    }
    const std::int32_t* size = shape.size;
    for (int axis = 0; axis < 3; ++axis) {
        if (shape.type == ShapeType::sphere) {
            half_extents[axis] = size[0];
            continue;
        }
        const std::int32_t* row = shape.rotation + 3 * axis;
        if (shape.type == ShapeType::capsule) {
            half_extents[axis] =
                size[0] + round_up(static_cast<std::int64_t>(magnitude(row[1])) * size[1]);
        } else {
            box_half_extents(shape.rotation, size, half_extents);
            return;
        }
    }
}

std::int32_t bounding_radius(ShapeType type, const std::int32_t size[3]) {
    switch (type) {
    case ShapeType::sphere:
        return size[0];
    case ShapeType::capsule:
        return size[0] + size[1];
    case ShapeType::box: {
        const std::uint64_t square = squared_length(size);
        const std::uint64_t root = floor_sqrt(square);
        return static_cast<std::int32_t>(root + (root * root < square ? 1U : 0U));
    }
    case ShapeType::plane:
    case ShapeType::hull:
    case ShapeType::compound:
    case ShapeType::height_field:
    case ShapeType::mesh:
        break;
    }
    return 0;
}

} // namespace lockwind
