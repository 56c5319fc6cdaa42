#include "dynamics/pair_parts.h"

#include "geometry/compound.h"
#include "geometry/fixed_geometry.h"
#include "geometry/rotation.h"

#include "lockwind/overflow.h"

#include <algorithm>

namespace lockwind {

ShapeInstance
shape_of_row(const BodyProperties& body, const ShapeLibrary* shapes, const std::int32_t* rotation) {
    ShapeInstance shape{ShapeType::sphere, {body.size[0], body.size[1], body.size[2]}, rotation};
    const auto type = static_cast<ShapeType>(body.shape);
    if (body.shape < static_cast<std::uint8_t>(ShapeType::hull)) {
        shape.type = type;
    } else if (shapes != nullptr && body.shape_index < shapes->count(type)) {
        shape.type = type;
        shapes->set_shape(shape, body.shape_index);
    }
    return shape;
}

Bounds bounds_in_frame(const Bounds& bounds, const BodyMotion& motion) {
    constexpr int kFiner = 32 - kBoundsFraction;
    std::int32_t rotation[9];
    rotation_matrix(motion.orientation, rotation);
    std::int64_t middle[3]; // Q31.32, from the surface's origin
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t sum = std::int64_t{bounds.low[axis]} + bounds.high[axis];
        middle[axis] = sum * (std::int64_t{1} << (kFiner - 1)) - motion.position[axis];
    }
    std::int64_t turned[3];
    inverse_rotate(rotation, middle, turned);
    Bounds local{};
    for (int axis = 0; axis < 3; ++axis) {
        std::int64_t extent = 0;
        for (int row = 0; row < 3; ++row) {
            const std::int64_t size = std::int64_t{bounds.high[row]} - bounds.low[row];
            extent += magnitude(rotation[3 * row + axis]) * ((size + 1) >> 1);
        }
        const std::int64_t reach = (extent >> kUnitFraction) + 3; // for roundings
        local.low[axis] = raw_saturate<std::int32_t>((turned[axis] >> kFiner) - reach);
        local.high[axis] = raw_saturate<std::int32_t>((turned[axis] >> kFiner) + reach);
    }
    return local;
}

std::uint32_t child_count(const ShapeInstance& shape) {
    return shape.type == ShapeType::compound ? shape.compound->child_count : 1;
}

bool PartedPair::is_near(std::uint32_t child, const Bounds& bounds) const {
    if (!has_surface_) {
        return true;
    }
    const std::uint32_t triangle = (child - 1) / kCompoundChildrenMax;
    return triangle < surface_.surface->triangle_count() &&
           overlaps(surface_.surface->triangle_bounds(triangle),
                    bounds_in_frame(bounds, surface_motion_));
}

} // namespace lockwind
