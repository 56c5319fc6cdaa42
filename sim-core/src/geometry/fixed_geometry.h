#pragma once

#include <cstdint>

namespace lockwind {

// Kernels of this layer work on raw int32 lengths (Q9.22 m) and unit vectors (Q2.30) with int64
// sums of products and one rounding: to the nearest, halves up, as every kernel of the solver does.

inline constexpr int kLengthFraction = 22;
inline constexpr int kUnitFraction = 30;
inline constexpr std::int32_t kUnitOne = 1 << kUnitFraction;

/// 5 mm, Q9.22: overlap that the solver leaves alone.
inline constexpr std::int32_t kLinearSlop = 20972;
/// 20 mm, Q9.22: surfaces this close already are a contact.
inline constexpr std::int32_t kSpeculativeMargin = 83886;

constexpr std::int32_t magnitude(std::int32_t value) {
    return value < 0 ? -value : value;
}

constexpr std::int64_t magnitude(std::int64_t value) {
    return value < 0 ? -value : value;
}

/// A sum of products with unit vectors, |sum| < 2^63 - 2^29, back in its other factor's format.
constexpr std::int64_t round_unit_wide(std::int64_t sum) {
    return (sum + (std::int64_t{1} << (kUnitFraction - 1))) >> kUnitFraction;
}

/// The same where the result is known to fit 32 bits.
constexpr std::int32_t round_unit(std::int64_t sum) {
    return static_cast<std::int32_t>(round_unit_wide(sum));
}

/// Exact sum of products of two 3-vectors; |a| |b| < 2^63.
constexpr std::int64_t dot_wide(const std::int32_t a[3], const std::int32_t b[3]) {
    return static_cast<std::int64_t>(a[0]) * b[0] + static_cast<std::int64_t>(a[1]) * b[1] +
           static_cast<std::int64_t>(a[2]) * b[2];
}

} // namespace lockwind
