#include "geometry/principal_axes.h"

#include "geometry/fixed_geometry.h"

#include "lockwind/int128.h"
#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/trig.h"

namespace lockwind {

namespace {

/// Turns about the axis across i and j so that entry (i, j) vanishes. Returns the angle from the
/// old axes to the new ones.
Angle annihilate(Covariance& c, int i, int j) {
    // tan 2 angle = 2 c_ij / (c_ii - c_jj); the half of the angle nearest to 0.
    std::int64_t y = 2 * c.entry[i][j];
    std::int64_t x = c.entry[i][i] - c.entry[j][j];
    if (x < 0) {
        x = -x;
        y = -y;
    }
    const Angle twice = atan2_angle(Real::from_raw(y), Real::from_raw(x));
    const Angle angle =
        Angle::from_raw(static_cast<std::uint64_t>(static_cast<std::int64_t>(twice.raw()) >> 1));
    const detail::CirclePoint turn = detail::circle_point(angle.raw());
    constexpr int kFraction = 62;
    const auto mix = [&](std::int64_t a, std::int64_t along, std::int64_t b, std::int64_t across) {
        return raw_narrow<std::int64_t>(round_shift(
            raw_add(wide_product<Int128>(a, along), wide_product<Int128>(b, across)), kFraction));
    };
    for (int row = 0; row < 3; ++row) { // C G
        const std::int64_t a = c.entry[row][i];
        const std::int64_t b = c.entry[row][j];
        c.entry[row][i] = mix(a, turn.cos, b, turn.sin);
        c.entry[row][j] = mix(b, turn.cos, a, -turn.sin);
    }
    for (int column = 0; column < 3; ++column) { // G^T C G
        const std::int64_t a = c.entry[i][column];
        const std::int64_t b = c.entry[j][column];
        c.entry[i][column] = mix(a, turn.cos, b, turn.sin);
        c.entry[j][column] = mix(b, turn.cos, a, -turn.sin);
    }
    return angle;
}

} // namespace

/// Jacobi's cyclic method converges quadratically; a few sweeps do.
RealQuat principal_turn(const Covariance& covariance) {
    Covariance c = covariance;
    constexpr int kSweeps = 16;
    constexpr int kPairs[3][2] = {{0, 1}, {1, 2}, {2, 0}};
    const std::int64_t negligible = (c.entry[0][0] + c.entry[1][1] + c.entry[2][2]) >> 20;
    RealQuat turn;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        bool done = true;
        for (const auto& [i, j] : kPairs) {
            // Once one turn is made, all are carried on to the last digits.
            const std::int64_t least = turn == RealQuat{} ? negligible : negligible >> 12;
            if (magnitude(c.entry[i][j]) <= least) {
                continue;
            }
            done = false;
            const Angle angle = annihilate(c, i, j);
            const int across = 3 - i - j;
            const Vec3 axis{across == 0 ? 1 : 0, across == 1 ? 1 : 0, across == 2 ? 1 : 0};
            turn = normalized(turn * from_axis_angle(axis, angle));
        }
        if (done) {
            break;
        }
    }
    return turn.w < 0 ? RealQuat{-turn.x, -turn.y, -turn.z, -turn.w} : turn;
}

UnitInertia moments_about(const Covariance& c, const std::int32_t rotation[9]) {
    std::int64_t variance[3];
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t direction[3] = {rotation[axis], rotation[3 + axis], rotation[6 + axis]};
        std::int64_t along[3];
        for (int row = 0; row < 3; ++row) {
            along[row] = raw_narrow<std::int64_t>(
                round_shift(raw_add(raw_add(wide_product<Int128>(c.entry[row][0], direction[0]),
                                            wide_product<Int128>(c.entry[row][1], direction[1])),
                                    wide_product<Int128>(c.entry[row][2], direction[2])),
                            kUnitFraction));
        }
        variance[axis] = raw_narrow<std::int64_t>(
            round_shift(raw_add(raw_add(wide_product<Int128>(along[0], direction[0]),
                                        wide_product<Int128>(along[1], direction[1])),
                                wide_product<Int128>(along[2], direction[2])),
                        kUnitFraction));
    }
    return {{SquareMetres::from_raw(variance[1] + variance[2]),
             SquareMetres::from_raw(variance[2] + variance[0]),
             SquareMetres::from_raw(variance[0] + variance[1])}};
}

} // namespace lockwind
