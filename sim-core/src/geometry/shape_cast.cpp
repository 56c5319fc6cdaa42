#include "geometry/shape_cast.h"

#include "geometry/fixed_geometry.h"
#include "geometry/rotation.h"
#include "geometry/shape_distance.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr int kTimeFraction = 62;
constexpr std::int64_t kTimeEnd = std::int64_t{1} << kTimeFraction;
/// Each step at least halves the distance or the speed along the normal: from 2^18 m to kCastGap,
/// and from 2^18 m per cast to what moves less than that.
constexpr int kStepsMax = 96;

/// Part of the way, Q1.62, in which bounding boxes are near each other.
struct Times {
    std::int64_t first;
    std::int64_t last;
};

bool clip(const ConvexCore& shape,
          const ConvexCore& body,
          const std::int64_t delta[3],
          const std::int64_t way[3],
          Times& times) {
    constexpr std::int64_t kMargin = std::int64_t{1} << 22; // 1 mm
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t extent =
            ((std::int64_t{shape.half_extents[axis]} + body.half_extents[axis])
             << (32 - kLengthFraction)) +
            kMargin;
        // Seen along the way: from -extent to extent.
        const std::int64_t along = way[axis] < 0 ? -delta[axis] : delta[axis];
        if (way[axis] == 0) {
            if (magnitude(along) > extent) {
                return false;
            }
            continue;
        }
        if (along > extent) {
            return false;
        }
        const std::int64_t size = magnitude(way[axis]);
        if (along < -extent) {
            times.first = std::max(times.first, multiply_divide(-extent - along, kTimeEnd, size));
        }
        times.last = std::min(times.last, multiply_divide(extent - along, kTimeEnd, size));
    }
    return times.first <= times.last;
}

void place_at(const std::int64_t delta[3],
              const std::int64_t way[3],
              std::int64_t time,
              std::int64_t place[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        place[axis] = delta[axis] + raw_narrow<std::int64_t>(round_shift(
                                        wide_product<Int128>(way[axis], time), kTimeFraction));
    }
}

} // namespace

bool shape_cast(const ConvexCore& shape,
                const std::int64_t start[3],
                const std::int64_t way[3],
                const ConvexCore& body,
                const std::int64_t centre[3],
                ConvexCastHit& hit) {
    std::int64_t delta[3];
    for (int axis = 0; axis < 3; ++axis) {
        delta[axis] = start[axis] - centre[axis];
    }
    Times times{0, kTimeEnd};
    if (body.count != 0 && !clip(shape, body, delta, way, times)) {
        return false;
    }
    std::int64_t time = times.first;
    bool overlapping = false;
    ShapeDistance found{}; // of the last place without overlap
    for (int step = 0; step < kStepsMax; ++step) {
        std::int64_t place[3];
        place_at(delta, way, time, place);
        ShapeDistance now{};
        shape_distance(shape, body, place, now);
        overlapping = now.overlapping;
        if (overlapping) {
            break;
        }
        found = now;
        const std::int64_t speed = -dot_unit(found.normal, way);
        if (speed <= 0) {
            return false;
        }
        if (found.separation <= kCastGapMost) {
            break;
        }
        const std::int64_t advance = multiply_divide(found.separation - kCastGap, kTimeEnd, speed);
        if (advance > times.last - time) {
            return false;
        }
        time += advance;
    }
    hit.overlapping = overlapping && time == 0;
    hit.fraction = time >> (kTimeFraction - 32);
    for (int axis = 0; axis < 3; ++axis) {
        hit.normal[axis] = found.normal[axis];
        hit.point[axis] = hit.overlapping ? start[axis] : centre[axis] + found.point[axis];
    }
    return true;
}

} // namespace lockwind
