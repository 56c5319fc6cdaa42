#include "geometry/hull_mass.h"

#include "geometry/principal_axes.h"
#include "geometry/rotation.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"

#include <algorithm>
#include <bit>

namespace lockwind {

namespace {

/// From this on, Q9.22, second moments of exact coordinates would leave int64.
constexpr std::int64_t kExactReach = std::int64_t{1} << 29;
constexpr int kCoarseShift = 2;

/// An exact sum of products of 128 and 64 bits: high 2^48 + low.
class LongSum {
public:
    void add(const Int128& factor, std::int64_t other) {
        const auto low = static_cast<std::int64_t>(low_limb(factor) & kLowMask);
        high_ = raw_add(
            high_,
            wide_product<Int128>(raw_narrow<std::int64_t>(shift_right(factor, kLowBits)), other));
        low_ = raw_add(low_, wide_product<Int128>(low, other));
    }
    /// The sum / 2^shift, rounded down, 0 <= shift <= 48.
    Int128 shifted(int shift) const {
        return raw_add(raw_shift_left(high_, kLowBits - shift), shift_right(low_, shift));
    }
    /// The smallest shift that leaves 126 bits.
    int excess() const {
        const Int128 size = high_ < Int128(0) ? raw_subtract(Int128(0), high_) : high_;
        int bits = 0;
        while (bits < 127 && Int128(0) < shift_right(size, bits)) {
            ++bits;
        }
        return std::clamp(bits + kLowBits + 1 - 126, 0, kLowBits);
    }

private:
    static constexpr int kLowBits = 48;
    static constexpr std::uint64_t kLowMask = (std::uint64_t{1} << 48U) - 1;
    Int128 high_ = 0;
    Int128 low_ = 0;
};

UInt128 to_unsigned(const Int128& value) {
    return {static_cast<std::uint64_t>(raw_narrow<std::int64_t>(shift_right(value, 64))),
            low_limb(value)};
}

/// numerator / denominator to the nearest, but for 2^-60 of it; denominator > 0.
std::int64_t quotient(const Int128& numerator, const Int128& denominator) {
    const bool negative = numerator < Int128(0);
    UInt128 above = to_unsigned(negative ? raw_subtract(Int128(0), numerator) : numerator);
    UInt128 below = to_unsigned(denominator);
    const int excess = std::max(bit_width(below) - 62, 0);
    above = above >> excess;
    below = below >> excess;
    const auto size =
        static_cast<std::int64_t>(divide_wide(above + UInt128{0, below.low / 2}, below.low).low);
    return negative ? -size : size;
}

/// value x factor, factor small.
Int128 times(const Int128& value, int factor) {
    Int128 sum(0);
    for (int count = 0; count < factor; ++count) {
        sum = raw_add(sum, value);
    }
    return sum;
}

/// Sums over the tetrahedra from a middle point, with their factors: 6 V, 24 of the first moments,
/// 120 of the second ones.
struct Integrals {
    Int128 volume = 0;
    Int128 first[3] = {0, 0, 0};
    LongSum second[3][3];

    void add(const HullPoint& a, const HullPoint& b, const HullPoint& c) {
        constexpr HullPoint kMiddle{0, 0, 0};
        const Int128 size = hull_height(hull_normal(kMiddle, a, b), kMiddle, c);
        volume = raw_add(volume, size);
        std::int64_t sum[3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            sum[axis] = std::int64_t{a[axis]} + b[axis] + c[axis];
            LongSum moment;
            moment.add(size, sum[axis]);
            first[axis] = raw_add(first[axis], moment.shifted(0));
        }
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j <= i; ++j) {
                second[i][j].add(size,
                                 sum[i] * sum[j] + std::int64_t{a[i]} * a[j] +
                                     std::int64_t{b[i]} * b[j] + std::int64_t{c[i]} * c[j]);
            }
        }
    }
    /// Integral of x_i x_j / V.
    std::int64_t mean_product(std::size_t i, std::size_t j) const {
        const int excess = second[i][j].excess();
        return quotient(second[i][j].shifted(excess), times(shift_right(volume, excess), 20));
    }
};

/// The middle of the bounds, and how coarse the coordinates about it must be.
struct Grid {
    HullPoint middle;
    int shift;

    HullPoint at(const HullPoint& point) const {
        HullPoint result{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            result[axis] = round_shift(point[axis] - middle[axis], shift);
        }
        return result;
    }
};

Grid grid_of(const HullSurface& surface) {
    Grid grid{};
    std::int64_t reach = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::int64_t low = surface.vertices[0][axis];
        std::int64_t high = low;
        for (const HullPoint& point : surface.vertices) {
            low = std::min<std::int64_t>(low, point[axis]);
            high = std::max<std::int64_t>(high, point[axis]);
        }
        grid.middle[axis] = static_cast<std::int32_t>((low + high) >> 1);
        reach = std::max(reach, (high - low + 1) >> 1);
    }
    grid.shift = reach < kExactReach ? 0 : kCoarseShift;
    return grid;
}

} // namespace

HullMass mass_of_hull(const HullSurface& surface) {
    const Grid grid = grid_of(surface);
    Integrals integrals;
    for (const std::vector<std::uint32_t>& face : surface.faces) {
        for (std::size_t corner = 1; corner + 1 < face.size(); ++corner) {
            integrals.add(grid.at(surface.vertices[face[0]]),
                          grid.at(surface.vertices[face[corner]]),
                          grid.at(surface.vertices[face[corner + 1]]));
        }
    }
    HullMass mass{};
    std::int64_t offset[3]; // of the centre from the middle, on the grid
    for (int axis = 0; axis < 3; ++axis) {
        offset[axis] = quotient(integrals.first[axis], times(integrals.volume, 4));
        mass.centre[axis] = grid.middle[static_cast<std::size_t>(axis)] +
                            offset[axis] * (std::int64_t{1} << grid.shift);
    }
    Covariance covariance{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            const std::int64_t about_middle = integrals.mean_product(i, j);
            covariance.entry[i][j] =
                (about_middle - offset[i] * offset[j]) * (std::int64_t{1} << (2 * grid.shift));
            covariance.entry[j][i] = covariance.entry[i][j];
        }
    }
    const RealQuat turn = principal_turn(covariance);
    const Real components[4] = {turn.x, turn.y, turn.z, turn.w};
    for (int index = 0; index < 4; ++index) {
        mass.orientation[index] = convert<Unit>(components[index]).raw();
    }
    std::int32_t rotation[9];
    rotation_matrix(mass.orientation, rotation);
    mass.inertia = moments_about(covariance, rotation);
    // Six times the volume, in cells of the grid; with some bits more for the sixth.
    constexpr int kMore = 8;
    const UInt128 volume = divide_wide(to_unsigned(integrals.volume) << kMore, 6);
    mass.volume = leading_bits(volume, 3 * (kLengthFraction - grid.shift) + kMore);
    return mass;
}

} // namespace lockwind
