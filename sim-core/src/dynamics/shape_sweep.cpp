#include "dynamics/shape_sweep.h"

#include "dynamics/turn.h"
#include "geometry/compound.h"
#include "geometry/convex_core.h"
#include "geometry/fixed_geometry.h"
#include "geometry/pair_kernels.h"
#include "geometry/rotation.h"
#include "geometry/shape_distance.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"

#include <algorithm>
#include <utility>

namespace lockwind {

namespace {

constexpr int kStepsMax = 64;
constexpr int kFiner = 32 - kLengthFraction;

std::int64_t part_of(std::int64_t whole, std::int64_t time) {
    return raw_narrow<std::int64_t>(
        round_shift(wide_product<Int128>(whole, time), kSweepTimeFraction));
}

/// A shape while it moves.
class Mover {
public:
    explicit Mover(const ShapePath& path) : path_(path) {
        turns_ = path.shape.type != ShapeType::sphere &&
                 (path.turn[0] | path.turn[1] | path.turn[2]) != 0;
        place_at(0);
    }
    void place_at(std::int64_t time) {
        place_on_path(path_, time, place_);
        if (turns_ || time == 0) {
            std::int32_t orientation[4];
            std::int32_t rotation[9];
            turn_on_path(path_, time, orientation);
            rotation_matrix(orientation, rotation);
            ShapeInstance shape = path_.shape;
            shape.rotation = rotation;
            if (is_surface(shape.type)) {
                make_triangle_core(shape, shape.part, core_);
            } else if (shape.type == ShapeType::compound) {
                const CompoundPart part(shape, shape.part);
                make_shrunk_core(part.shape);
                move_core(part.offset);
            } else {
                make_shrunk_core(shape);
            }
        }
    }
    const ConvexCore& core() const { return core_; }
    const std::int64_t* place() const { return place_; }
    /// Q31.32 m in the whole way: how far its points may go along a normal by its turn.
    std::int64_t swept_along(const std::int32_t normal[3]) const {
        if (!turns_) {
            return 0;
        }
        std::int64_t square = 0; // Q.40 rad^2 of |turn x normal|
        for (int axis = 0; axis < 3; ++axis) {
            const int next = (axis + 1) % 3;
            const int last = (axis + 2) % 3;
            const std::int64_t part = raw_narrow<std::int64_t>(
                round_shift(raw_subtract(wide_product<Int128>(path_.turn[next], normal[last]),
                                         wide_product<Int128>(path_.turn[last], normal[next])),
                            40));
            square += part * part;
        }
        const auto angle = // Q.20, rounded up
            static_cast<std::int64_t>(floor_sqrt(static_cast<std::uint64_t>(square))) + 2;
        return (angle * core_.reach) >> (20 - kFiner);
    }

private:
    void make_shrunk_core(ShapeInstance shape) {
        shrink(shape);
        make_core(shape, core_);
        if (shape.type == ShapeType::hull) {
            shrink_core();
        }
    }
    /// From a child's centre to its body's.
    void move_core(const std::int32_t offset[3]) {
        for (std::uint32_t point = 0; point < core_.count; ++point) {
            for (int axis = 0; axis < 3; ++axis) {
                core_.points[point][axis] += offset[axis];
            }
        }
        core_.reach += static_cast<std::int32_t>(floor_sqrt(squared_length(offset))) + 1;
    }
    void shrink(ShapeInstance& shape) const {
        const std::int32_t shortest = girth_of(shape).shortest;
        const std::int32_t depth = shortest - (shortest >> path_.level);
        if (shape.type == ShapeType::box) {
            for (std::int32_t& half : shape.size) {
                half -= depth;
            }
        } else if (shape.type == ShapeType::sphere || shape.type == ShapeType::capsule) {
            shape.size[0] -= depth; // the radius
        }
    }
    void shrink_core() {
        for (std::uint32_t point = 0; point < core_.count; ++point) {
            for (std::int32_t& coordinate : core_.points[point]) {
                coordinate >>= path_.level;
            }
        }
    }

    const ShapePath& path_;
    bool turns_;
    std::int64_t place_[3];
    ConvexCore core_;
};

} // namespace

void place_on_path(const ShapePath& path, std::int64_t time, std::int64_t place[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        place[axis] = raw_add(path.start[axis], part_of(path.way[axis], time));
    }
}

void turn_on_path(const ShapePath& path, std::int64_t time, std::int32_t orientation[4]) {
    const std::int64_t half[3] = {part_of(path.turn[0], time) >> 1,
                                  part_of(path.turn[1], time) >> 1,
                                  part_of(path.turn[2], time) >> 1};
    std::int64_t change[4];
    turn_quaternion(half, change);
    std::int64_t turned[4];
    std::copy(path.orientation, path.orientation + 4, turned);
    multiply_quaternions(change, turned, turned);
    normalize_quaternion(turned, orientation);
}

SweepResult shape_sweep(const ShapePath& first, const ShapePath& second, std::int64_t& time) {
    // shape_distance takes a half space second.
    const bool swapped = first.shape.type == ShapeType::plane;
    Mover a(swapped ? second : first);
    Mover b(swapped ? first : second);
    const ShapePath& path_a = swapped ? second : first;
    const ShapePath& path_b = swapped ? first : second;
    std::int64_t way[3];
    for (int axis = 0; axis < 3; ++axis) {
        way[axis] = raw_subtract(path_a.way[axis], path_b.way[axis]);
    }
    time = 0;
    for (int step = 0; step < kStepsMax; ++step) {
        std::int64_t delta[3];
        for (int axis = 0; axis < 3; ++axis) {
            delta[axis] = raw_subtract(a.place()[axis], b.place()[axis]);
        }
        ShapeDistance found{};
        shape_distance(a.core(), b.core(), delta, found);
        if (found.overlapping || found.separation <= kSweepGapMost) {
            return time > 0 ? SweepResult::met : SweepResult::near_at_start;
        }
        const std::int64_t speed = -dot_unit(found.normal, way) + a.swept_along(found.normal) +
                                   b.swept_along(found.normal);
        if (speed <= 0) {
            return SweepResult::apart;
        }
        const std::int64_t advance =
            multiply_divide(found.separation - kSweepGap, kSweepTimeEnd, speed);
        if (advance >= kSweepTimeEnd - time) {
            return SweepResult::apart;
        }
        time += advance;
        a.place_at(time);
        b.place_at(time);
    }
    return SweepResult::met;
}

} // namespace lockwind
