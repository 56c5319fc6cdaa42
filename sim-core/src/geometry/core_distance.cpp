#include "geometry/core_distance.h"

#include "geometry/fixed_geometry.h"
#include "geometry/simplex.h"

#include "lockwind/assert.h"
#include "lockwind/integer.h"

#include <algorithm>
#include <bit>

namespace lockwind {

namespace {

constexpr int kPlaceBits = 29;
constexpr int kFinerBits = 32 - kLengthFraction;
constexpr int kRoundsMax = 128;
/// 2^-8 of a grid unit, in its Q.30: a vertex that lies no lower brings nothing.
constexpr std::int64_t kProgressMin = std::int64_t{1} << 22;

/// A core's points on the grid.
struct GridPoints {
    std::int64_t places[kHullVerticesMax][3];
    std::uint32_t count;

    GridPoints(const ConvexCore& core, int shift) : count(core.count) {
        for (std::uint32_t index = 0; index < count; ++index) {
            for (int axis = 0; axis < 3; ++axis) {
                places[index][axis] = round_shift(std::int64_t{core.points[index][axis]}, shift);
            }
        }
    }
    /// The point farthest along `direction` x `sign`; of equal ones the first.
    std::uint32_t farthest(const std::int32_t direction[3], int sign) const {
        std::uint32_t best = 0;
        std::int64_t most = 0;
        for (std::uint32_t index = 0; index < count; ++index) {
            const std::int64_t* place = places[index];
            const std::int64_t along = sign * (direction[0] * place[0] + direction[1] * place[1] +
                                               direction[2] * place[2]);
            if (index == 0 || along > most) {
                most = along;
                best = index;
            }
        }
        return best;
    }
};

/// How many bits of Q9.22 the grid leaves out, so that places fit.
int grid_shift(const ConvexCore& a, const ConvexCore& b, const std::int64_t delta[3]) {
    std::int64_t bound = std::int64_t{a.reach} + b.reach + 8;
    for (int axis = 0; axis < 3; ++axis) {
        bound += magnitude(delta[axis]) >> kFinerBits;
    }
    return std::max(
        static_cast<int>(std::bit_width(static_cast<std::uint64_t>(bound))) - kPlaceBits, 0);
}

class Gjk {
public:
    Gjk(const ConvexCore& a, const ConvexCore& b, const std::int64_t delta[3])
        : shift_(grid_shift(a, b, delta)), a_(a, shift_), b_(b, shift_) {
        for (int axis = 0; axis < 3; ++axis) {
            delta_[axis] = round_shift(delta[axis], kFinerBits + shift_);
        }
    }
    void run(CoreDistance& out);

private:
    SimplexCorner lowest(const std::int32_t direction[3]) const;
    SimplexCorner first() const;
    void take_point(const SimplexFeature& feature, CoreDistance& out) const;

    int shift_;
    GridPoints a_;
    GridPoints b_;
    std::int64_t delta_[3] = {};
};

SimplexCorner Gjk::lowest(const std::int32_t direction[3]) const {
    SimplexCorner corner{{}, a_.farthest(direction, -1), b_.farthest(direction, 1)};
    for (int axis = 0; axis < 3; ++axis) {
        corner.place[axis] = a_.places[corner.a][axis] + delta_[axis] - b_.places[corner.b][axis];
    }
    return corner;
}

SimplexCorner Gjk::first() const {
    std::int32_t direction[3];
    for (int axis = 0; axis < 3; ++axis) {
        direction[axis] = static_cast<std::int32_t>(delta_[axis]);
    }
    return lowest(direction);
}

void Gjk::take_point(const SimplexFeature& feature, CoreDistance& out) const {
    Int128 sum(0);
    for (std::uint32_t index = 0; index < feature.count; ++index) {
        sum = raw_add(sum, feature.weights[index]);
    }
    constexpr std::int64_t kWholeMax = std::int64_t{1} << 62;
    int spare = 0; // bits of the weights that int64 does not hold
    while (shift_right(sum, spare) >= Int128(kWholeMax)) {
        ++spare;
    }
    std::int64_t weights[3] = {0, 0, 0};
    std::int64_t whole = 0;
    for (std::uint32_t index = 0; index < feature.count; ++index) {
        weights[index] = raw_narrow<std::int64_t>(shift_right(feature.weights[index], spare));
        whole += weights[index];
    }
    const int finer = kFinerBits + shift_;
    const std::int64_t* base = b_.places[feature.corners[0].b];
    for (int axis = 0; axis < 3; ++axis) {
        out.point_b[axis] = base[axis] * (std::int64_t{1} << finer);
        for (std::uint32_t index = 1; index < feature.count; ++index) {
            const std::int64_t way = b_.places[feature.corners[index].b][axis] - base[axis];
            out.point_b[axis] +=
                multiply_divide(way * (std::int64_t{1} << finer), weights[index], whole);
        }
    }
}

bool holds(const SimplexFeature& feature, const SimplexCorner& corner) {
    for (std::uint32_t index = 0; index < feature.count; ++index) {
        if (std::equal(corner.place, corner.place + 3, feature.corners[index].place)) {
            return true;
        }
    }
    return false;
}

void Gjk::run(CoreDistance& out) {
    // Q.30 of a grid unit to Q31.32 of a metre.
    const int coarser = kLengthFraction - 2 - shift_;
    Simplex simplex{{first()}, 1};
    SimplexFeature best{};
    for (int round = 0; round < kRoundsMax; ++round) {
        const SimplexFeature feature = nearest_feature(simplex);
        if (feature.count == 0) {
            out.overlapping = true;
            return;
        }
        if (round != 0 && feature.distance >= best.distance) {
            break;
        }
        best = feature;
        const SimplexCorner next = lowest(best.normal);
        const std::int64_t separation = best.normal[0] * next.place[0] +
                                        best.normal[1] * next.place[1] +
                                        best.normal[2] * next.place[2];
        out.separation = separation >> coarser;
        if (holds(best, next) || best.distance - separation <= kProgressMin) {
            break;
        }
        std::copy(best.corners, best.corners + best.count, simplex.corners);
        simplex.corners[best.count] = next;
        simplex.count = best.count + 1;
    }
    out.overlapping = false;
    out.distance = round_shift(best.distance, coarser);
    std::copy(best.normal, best.normal + 3, out.normal);
    take_point(best, out);
}

} // namespace

void core_distance(const ConvexCore& a,
                   const ConvexCore& b,
                   const std::int64_t delta[3],
                   CoreDistance& out) {
    LOCKWIND_ASSERT(a.count != 0 && b.count != 0);
    Gjk(a, b, delta).run(out);
}

} // namespace lockwind
