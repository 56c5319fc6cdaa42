#pragma once

#include "lockwind/integer.h"
#include "lockwind/overflow.h"

#include <bit>
#include <cstdint>

namespace lockwind {

// Kernels of this layer work on raw int32 lengths (Q9.22 m) and unit vectors (Q2.30) with int64
// sums of products and one rounding: half up, as everywhere.

inline constexpr int kLengthFraction = 22;
inline constexpr int kUnitFraction = 30;
inline constexpr std::int32_t kUnitOne = 1 << kUnitFraction;

/// 5 mm, Q9.22: overlap that the solver leaves alone.
inline constexpr std::int32_t kLinearSlop = 20972;
/// 20 mm, Q9.22: surfaces this close already are a contact.
inline constexpr std::int32_t kSpeculativeMargin = 83886;
/// 61 um, Q9.22: a shorter vector of rounded lengths gives no direction.
inline constexpr std::int32_t kDirectionMin = 256;

constexpr std::int32_t magnitude(std::int32_t value) {
    return value < 0 ? raw_negate(value) : value;
}

constexpr std::int64_t magnitude(std::int64_t value) {
    return value < 0 ? raw_negate(value) : value;
}

template <class T>
constexpr T clamped(T value, T low, T high) {
    return value < low ? low : (value > high ? high : value);
}

/// A sum of products with unit vectors, |sum| < 2^63 - 2^29, back in its other factor's format.
constexpr std::int64_t round_unit_wide(std::int64_t sum) {
    return (sum + (std::int64_t{1} << (kUnitFraction - 1))) >> kUnitFraction;
}

/// The same where the result is known to fit 32 bits.
constexpr std::int32_t round_unit(std::int64_t sum) {
    return raw_narrow<std::int32_t>(round_unit_wide(sum));
}

/// length x unit.
constexpr std::int32_t scale(std::int32_t length, std::int32_t unit) {
    return round_unit(static_cast<std::int64_t>(length) * unit);
}

/// Exact sum of products of two 3-vectors; |a| |b| < 2^63.
constexpr std::int64_t dot_wide(const std::int32_t a[3], const std::int32_t b[3]) {
    return static_cast<std::int64_t>(a[0]) * b[0] + static_cast<std::int64_t>(a[1]) * b[1] +
           static_cast<std::int64_t>(a[2]) * b[2];
}

/// a x b of unit vectors.
constexpr void cross_units(const std::int32_t a[3], const std::int32_t b[3], std::int32_t out[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        const int j = (axis + 1) % 3;
        const int k = (axis + 2) % 3;
        out[axis] = round_unit(static_cast<std::int64_t>(a[j]) * b[k] -
                               static_cast<std::int64_t>(a[k]) * b[j]);
    }
}

/// Exact squared length; needs no bound: 3 * 2^62 < 2^64.
constexpr std::uint64_t squared_length(const std::int32_t v[3]) {
    std::uint64_t sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        sum += static_cast<std::uint64_t>(static_cast<std::int64_t>(v[axis]) * v[axis]);
    }
    return sum;
}

/// Length of v (below 512 m) rounded down, and its unit vector (each component within 2 ulp); 0
/// leaves `unit` alone. The vector is first scaled to 30 bits, so that short ones lose no digits.
inline std::int32_t normalise(const std::int32_t v[3], std::int32_t unit[3]) {
    const auto bits =
        static_cast<std::uint32_t>(magnitude(v[0]) | magnitude(v[1]) | magnitude(v[2]));
    if (bits == 0) {
        return 0;
    }
    const int shift = bits < (1U << 30U) ? std::countl_zero(bits) - 2 : 0;
    std::int64_t scaled[3];
    std::uint64_t square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        scaled[axis] = v[axis] * (std::int64_t{1} << shift);
        square += static_cast<std::uint64_t>(scaled[axis] * scaled[axis]);
    }
    const std::uint64_t root = floor_sqrt(square);
    const std::uint64_t nearest = root + (square - root * root > root ? 1U : 0U);
    const auto reciprocal = static_cast<std::int64_t>((std::uint64_t{1} << 62U) / nearest);
    for (int axis = 0; axis < 3; ++axis) {
        unit[axis] = static_cast<std::int32_t>(round_shift(scaled[axis] * reciprocal, 32));
    }
    return static_cast<std::int32_t>(root >> shift);
}

} // namespace lockwind
