#include "geometry/mass.h"

#include "geometry/fixed_geometry.h"

#include "lockwind/int128.h"
#include "lockwind/integer.h"

#include <limits>

namespace lockwind {

namespace {

/// numerator / divisor to the nearest; the quotient fits 63 bits.
std::int64_t divide_nearest(const UInt128& numerator, std::uint64_t divisor) {
    return static_cast<std::int64_t>(divide_wide(numerator + UInt128{0, divisor / 2}, divisor).low);
}

std::uint64_t squared(std::uint64_t length) {
    return length * length;
}

UnitInertia capsule_inertia(std::uint64_t r, std::uint64_t h) {
    const std::uint64_t whole = 3 * h + 2 * r;
    const std::int64_t along =
        divide_nearest(multiply_wide(squared(r), 15 * h + 8 * r), 10 * whole);
    const UInt128 cubes =
        multiply_wide(squared(h), 20 * h + 40 * r) + multiply_wide(squared(r), 45 * h + 16 * r);
    const auto across = SquareMetres::from_raw(divide_nearest(cubes, 20 * whole));
    return {{across, SquareMetres::from_raw(along), across}};
}

} // namespace

UnitInertia unit_inertia(ShapeType type, const std::int32_t size[3]) {
    const auto x = static_cast<std::uint64_t>(size[0]);
    const auto y = static_cast<std::uint64_t>(size[1]);
    const auto z = static_cast<std::uint64_t>(size[2]);
    if (type == ShapeType::capsule) {
        return capsule_inertia(x, y);
    }
    const auto moment = [](std::uint64_t squares, std::uint64_t divisor) {
        return SquareMetres::from_raw(divide_nearest(UInt128{0, squares}, divisor));
    };
    if (type == ShapeType::sphere) {
        const SquareMetres any = moment(2 * squared(x), 5);
        return {{any, any, any}};
    }
    return {{moment(squared(y) + squared(z), 3),
             moment(squared(z) + squared(x), 3),
             moment(squared(x) + squared(y), 3)}};
}

Volume volume_of(ShapeType type, const std::int32_t size[3]) {
    constexpr int kCubeFraction = 3 * kLengthFraction;
    constexpr std::uint64_t kFourThirdsPi = 9658692610769497123U; // Q61
    const auto x = static_cast<std::uint64_t>(size[0]);
    const auto y = static_cast<std::uint64_t>(size[1]);
    const auto z = static_cast<std::uint64_t>(size[2]);
    if (type == ShapeType::box) {
        return leading_bits(multiply_wide(x * y, z), kCubeFraction - 3);
    }
    // pi r^2 (2 h + 4/3 r) = 2/3 pi r^2 (3 h + 2 r).
    const Volume round = type == ShapeType::sphere
                             ? leading_bits(multiply_wide(x * x, x), kCubeFraction)
                             : leading_bits(multiply_wide(x * x, 3 * y + 2 * x), kCubeFraction + 1);
    return leading_bits(multiply_wide(round.mantissa, kFourThirdsPi), round.fraction + 61);
}

Volume leading_bits(const UInt128& value, int fraction) {
    const int excess = bit_width(value) - 64;
    return excess > 0 ? Volume{(value >> excess).low, fraction - excess}
                      : Volume{value.low, fraction};
}

Real mass_of(const Volume& volume, Real density) {
    constexpr auto kHighest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    if (density <= 0) {
        return 0;
    }
    const UInt128 mass = multiply_wide(volume.mantissa, static_cast<std::uint64_t>(density.raw()));
    // Q(volume.fraction + 32) -> Q32, to the nearest.
    const UInt128 shifted =
        volume.fraction > 0 ? ((mass >> (volume.fraction - 1)) + UInt128{0, 1}) >> 1 : mass;
    const bool fits = volume.fraction >= 0 && shifted.high == 0 && shifted.low <= kHighest;
    return fits ? Real::from_raw(static_cast<std::int64_t>(shifted.low)) : Real::highest();
}

Real mass_of(ShapeType type, const std::int32_t size[3], Real density) {
    return mass_of(volume_of(type, size), density);
}

} // namespace lockwind
