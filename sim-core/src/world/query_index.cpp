#include "world/query_index.h"

#include "dynamics/make_body.h"
#include "geometry/bounds.h"
#include "geometry/rotation.h"

#include "lockwind/overflow.h"

namespace lockwind {

QueryIndex::QueryIndex(std::uint32_t body_capacity)
    : rotations_(body_capacity), bounds_(body_capacity), tree_(body_capacity) {}

void QueryIndex::refresh(const DynamicsTables& tables, const ShapeLibrary& shapes) {
    if (is_current_) {
        return;
    }
    const std::uint32_t count = tables.motion.count();
    for (BodyRow row = 0; row < count; ++row) {
        const BodyMotion& motion = tables.motion[row];
        rotation_matrix(motion.orientation, rotations_[row].data());
        const ShapeInstance instance = shape(row, tables, shapes);
        bounds_[row] =
            is_bounded(instance.type) ? query_bounds(instance, motion.position) : kUnbounded;
    }
    tree_.build({bounds_.data(), count});
    is_current_ = true;
}

ShapeInstance
QueryIndex::shape(BodyRow row, const DynamicsTables& tables, const ShapeLibrary& shapes) const {
    const BodyProperties& properties = tables.properties[row];
    const bool turns = properties.shape != static_cast<std::uint8_t>(ShapeType::sphere);
    return shape_of(properties, shapes, turns ? rotations_[row].data() : kIdentityRotation);
}

Bounds query_bounds(const ShapeInstance& shape, const std::int64_t centre[3]) {
    std::int32_t half_extents[3];
    bounds_half_extents(shape, half_extents);
    Bounds bounds{};
    for (int axis = 0; axis < 3; ++axis) {
        // Both shifts round down: one unit each makes up for it, and one for the shapes' rounding.
        const std::int64_t place = centre[axis] >> (32 - kBoundsFraction);
        const std::int64_t extent = (half_extents[axis] >> (kLengthFraction - kBoundsFraction)) + 3;
        bounds.low[axis] = raw_saturate<std::int32_t>(place - extent);
        bounds.high[axis] = raw_saturate<std::int32_t>(place + extent);
    }
    return bounds;
}

} // namespace lockwind
