#include "dynamics/body_frame.h"

#include "dynamics/pair_parts.h"
#include "geometry/bounds.h"
#include "geometry/collide.h"
#include "geometry/rotation.h"

#include <algorithm>

namespace lockwind {

namespace {

bool is_current(const BodyFrame& frame, const ShapeInstance& shape, const BodyMotion& motion) {
    if (frame.shape.rotation == nullptr || frame.shape.type != shape.type ||
        frame.shape.hull != shape.hull || frame.shape.compound != shape.compound ||
        frame.shape.surface != shape.surface ||
        !std::equal(shape.size, shape.size + 3, frame.shape.size)) {
        return false;
    }
    return frame.shape.type == ShapeType::sphere ||
           std::equal(motion.orientation, motion.orientation + 4, frame.orientation);
}

void make_frame(BodyFrame& frame, const ShapeInstance& shape, const BodyMotion& motion) {
    frame.shape = shape;
    std::copy(motion.orientation, motion.orientation + 4, frame.orientation);
    if (frame.shape.type == ShapeType::sphere) {
        std::copy(kIdentityRotation, kIdentityRotation + 9, frame.rotation);
    } else {
        rotation_matrix(motion.orientation, frame.rotation);
    }
    if (is_bounded(frame.shape.type)) {
        bounds_half_extents(frame.shape, frame.half_extents);
    } else {
        std::fill(frame.half_extents, frame.half_extents + 3, 0);
    }
}

} // namespace

BodyFrames::BodyFrames(std::uint32_t capacity, const ShapeLibrary* shapes)
    : frames_(capacity), shapes_(shapes) {}

void BodyFrames::refresh(const DynamicsTables& tables, std::span<const BodyRow> rows) {
    for (const BodyRow row : rows) {
        BodyFrame& frame = frames_[row];
        const ShapeInstance shape = shape_of_row(tables.properties[row], shapes_, frame.rotation);
        if (!is_current(frame, shape, tables.motion[row])) {
            make_frame(frame, shape, tables.motion[row]);
        }
    }
}

void BodyFrames::drop() {
    std::fill(frames_.begin(), frames_.end(), BodyFrame{});
}

void pair_delta(const BodyFrame& a,
                const BodyFrame& b,
                const BodyMotion& motion_a,
                const BodyMotion& motion_b,
                std::int32_t delta[3]) {
    if (is_bounded(a.shape.type) && is_bounded(b.shape.type)) {
        centre_delta(motion_a.position, motion_b.position, delta);
    } else {
        centre_delta_plane(a.shape, motion_a.position, b.shape, motion_b.position, delta);
    }
}

} // namespace lockwind
