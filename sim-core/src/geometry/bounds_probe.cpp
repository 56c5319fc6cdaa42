#include "geometry/bounds_probe.h"

#include "geometry/fixed_geometry.h"
#include "math/integer.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr int kProbeFraction = 10;
constexpr int kCoarser = 32 - kProbeFraction;
constexpr std::int64_t kMargin = 3;

std::int64_t low_of(const Bounds& bounds, int axis) {
    return (bounds.low[axis] >> (kBoundsFraction - kProbeFraction)) - kMargin;
}

std::int64_t high_of(const Bounds& bounds, int axis) {
    return (bounds.high[axis] >> (kBoundsFraction - kProbeFraction)) + 1 + kMargin;
}

} // namespace

SegmentProbe::SegmentProbe(const std::int64_t from[3],
                           const std::int64_t way[3],
                           const std::int32_t half_extents[3]) {
    std::int64_t end[3];
    for (int axis = 0; axis < 3; ++axis) {
        from_raw_[axis] = from[axis];
        way_raw_[axis] = way[axis];
        half_extents_[axis] = (half_extents[axis] >> (kLengthFraction - kProbeFraction)) + 1;
        from_[axis] = from[axis] >> kCoarser;
        end[axis] = from[axis] + way[axis];
    }
    set_end(end);
}

void SegmentProbe::set_end(const std::int64_t end[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t to = end[axis] >> kCoarser;
        sum_[axis] = from_[axis] + to;
        way_[axis] = to - from_[axis];
    }
}

void SegmentProbe::shorten(std::int64_t fraction) {
    std::int64_t end[3];
    for (int axis = 0; axis < 3; ++axis) {
        end[axis] = from_raw_[axis] + multiply_shift_wide(way_raw_[axis], fraction, 32);
    }
    set_end(end);
}

/// Separating axes of a segment and a box (Ericson, Real-Time Collision Detection, 5.3.3), all
/// lengths doubled; products stay below 2^60.
std::int64_t SegmentProbe::operator()(const Bounds& bounds) const {
    std::int64_t middle[3];
    std::int64_t extent[3];
    std::int64_t cost = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t low = low_of(bounds, axis) - half_extents_[axis];
        const std::int64_t high = high_of(bounds, axis) + half_extents_[axis];
        middle[axis] = low + high - sum_[axis];
        extent[axis] = high - low;
        if (magnitude(middle[axis]) > extent[axis] + magnitude(way_[axis])) {
            return -1;
        }
        cost += (low + high - 2 * from_[axis]) * way_[axis];
    }
    for (int axis = 0; axis < 3; ++axis) {
        const int j = (axis + 1) % 3;
        const int k = (axis + 2) % 3;
        if (magnitude(middle[j] * way_[k] - middle[k] * way_[j]) >
            extent[j] * magnitude(way_[k]) + extent[k] * magnitude(way_[j])) {
            return -1;
        }
    }
    return std::max<std::int64_t>(cost, 0);
}

PointProbe::PointProbe(const std::int64_t point[3], std::int64_t distance) {
    for (int axis = 0; axis < 3; ++axis) {
        point_[axis] = point[axis] >> kCoarser;
    }
    shorten(distance);
}

void PointProbe::shorten(std::int64_t distance) {
    const std::int64_t limit = (distance >> kCoarser) + 1;
    square_ = limit * limit;
}

std::int64_t PointProbe::operator()(const Bounds& bounds) const {
    std::int64_t square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t below = low_of(bounds, axis) - point_[axis];
        const std::int64_t above = point_[axis] - high_of(bounds, axis);
        const std::int64_t beyond = std::max<std::int64_t>({below, above, 0});
        square += beyond * beyond;
    }
    return square > square_ ? -1 : square;
}

} // namespace lockwind
