#pragma once

#include "lockwind/int128.h"

#include <bit>
#include <cstdint>
#include <type_traits>

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

/// floor(value / 2^shift + 1/2): round half up, the one rounding rule of the project. Exact for
/// every value: the half is bit shift - 1, added after the shift, so nothing can overflow.
template <class T>
constexpr T round_shift(T value, int shift) {
    if (shift == 0) {
        return value;
    }
    if constexpr (sizeof(T) == 16) {
        const auto half = static_cast<std::int64_t>(low_limb(shift_right(value, shift - 1)) & 1U);
        return raw_add(shift_right(value, shift), T(half));
    } else {
        return static_cast<T>((value >> shift) + ((value >> (shift - 1)) & 1));
    }
}

/// A quotient and its remainder.
struct Division {
    std::uint64_t quotient;
    std::uint64_t remainder;
};

namespace detail {

/// One digit of algorithm D: floor((remainder * 2^32 + digit) / divisor), remainder < divisor, top
/// bit of the divisor set.
constexpr Division
divide_digit(std::uint64_t remainder, std::uint64_t digit, std::uint64_t divisor) {
    const std::uint64_t divisor_high = divisor >> 32U;
    const std::uint64_t divisor_low = divisor & 0xffffffffU;
    // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): the top bit of the divisor is set
    std::uint64_t estimate = remainder / divisor_high;
    std::uint64_t rest = remainder % divisor_high;
    while ((estimate >> 32U) != 0 || estimate * divisor_low > ((rest << 32U) | digit)) {
        --estimate;
        rest += divisor_high;
        if ((rest >> 32U) != 0) {
            break;
        }
    }
    return {estimate, (remainder << 32U) + digit - estimate * divisor};
}

} // namespace detail

/// floor(numerator / divisor), numerator.high < divisor, by two digits of 32 bits:
/// Knuth, The Art of Computer Programming, volume 2, 4.3.1, algorithm D.
constexpr Division divide_portable(const UInt128& numerator, std::uint64_t divisor) {
    LOCKWIND_ASSERT(numerator.high < divisor);
    const int shift = std::countl_zero(divisor);
    const std::uint64_t scaled = divisor << shift;
    const UInt128 n = numerator << shift;
    const Division high = detail::divide_digit(n.high, n.low >> 32U, scaled);
    const Division low = detail::divide_digit(high.remainder, n.low & 0xffffffffU, scaled);
    return {(high.quotient << 32U) + low.quotient, low.remainder >> shift};
}

/// floor(numerator / divisor); needs numerator.high < divisor, so that the quotient has 64 bits.
constexpr Division divide(const UInt128& numerator, std::uint64_t divisor) {
#if LOCKWIND_HAS_X86_64
    if (!std::is_constant_evaluated()) {
        std::uint64_t quotient = 0;
        std::uint64_t remainder = 0;
        __asm__("divq %4"
                : "=a"(quotient), "=d"(remainder)
                : "a"(numerator.low), "d"(numerator.high), "r"(divisor)
                : "cc");
        return {quotient, remainder};
    }
#endif
    return divide_portable(numerator, divisor);
}

/// floor(numerator / divisor) with all its 128 bits; divisor > 0.
constexpr UInt128 divide_wide(const UInt128& numerator, std::uint64_t divisor) {
    LOCKWIND_ASSERT(divisor != 0);
    const std::uint64_t high = numerator.high / divisor;
    return {high, divide({numerator.high % divisor, numerator.low}, divisor).quotient};
}

namespace detail {

/// sqrt(value) within 2: four Newton steps from a 2-bit seed, each dividing by the root so far (the
/// method of CPython's math.isqrt).
constexpr std::uint64_t root_seed(std::uint64_t value) {
    const int shift = std::countl_zero(value) & ~1;
    const std::uint64_t n = value << shift;
    std::uint64_t root = 1 + (n >> 62U);
    root = (root << 1U) + (n >> 59U) / root;
    root = (root << 3U) + (n >> 53U) / root;
    root = (root << 7U) + (n >> 41U) / root;
    root = (root << 15U) + (n >> 17U) / root;
    return root >> (shift / 2);
}

/// The exact root from a near one: whatever the seed, the result is the same.
constexpr std::uint64_t exact_root(std::uint64_t value, std::uint64_t seed) {
    std::uint64_t root = seed < 0xffffffffU ? seed : 0xffffffffU;
    while (root * root > value) {
        --root;
    }
    while (value - root * root > 2 * root) {
        ++root;
    }
    return root;
}

} // namespace detail

constexpr std::uint64_t floor_sqrt_portable(std::uint64_t value) {
    return value == 0 ? 0 : detail::exact_root(value, detail::root_seed(value));
}

/// floor(sqrt(value)), exact.
constexpr std::uint64_t floor_sqrt(std::uint64_t value) {
#if LOCKWIND_HAS_X86_64
    if (!std::is_constant_evaluated()) {
        // The instruction itself: a call of sqrt would bring in libm. Three times the portable
        // speed.
        auto seed = static_cast<double>(value); // float seed: corrected exactly below
        __asm__("sqrtsd %0, %0" : "+x"(seed));
        return detail::exact_root(value, static_cast<std::uint64_t>(seed));
    }
#endif
    return floor_sqrt_portable(value);
}

/// floor(sqrt(value)), exact. Karatsuba square root (Zimmermann 1999): the root of the high half
/// gives the high digit, one division the low one, which may be one too large.
constexpr std::uint64_t floor_sqrt128(const UInt128& value) {
    if (value.high == 0) {
        return floor_sqrt(value.low);
    }
    const int shift = std::countl_zero(value.high) & ~1;
    const UInt128 n = value << shift;
    const std::uint64_t high = floor_sqrt(n.high);
    const std::uint64_t rest = n.high - high * high;
    // (rest * 2^32 + next digit) / (2 high), halved on both sides to fit: rest <= 2 high < 2^33.
    const std::uint64_t digit = n.low >> 32U;
    const std::uint64_t half = (rest << 31U) + (digit >> 1U);
    // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): high >= 2^31
    const std::uint64_t quotient = half / high;
    const std::uint64_t left = ((half % high) << 1U) + (digit & 1U);
    const UInt128 remainder{left >> 32U, (left << 32U) | (n.low & 0xffffffffU)};
    // Branch-free, for the sign is a coin toss. The sum may pass 2^64 and come back.
    const std::uint64_t excess = (remainder - multiply_wide(quotient, quotient)).high >> 63U;
    return ((high << 32U) + quotient - excess) >> (shift / 2);
}

/// a * numerator / denominator, truncated towards zero, from the exact 128-bit product. Saturates
/// where the result has no int64, and as its sign says where denominator is 0 (0 for 0).
constexpr std::int64_t
multiply_divide(std::int64_t a, std::int64_t numerator, std::int64_t denominator) {
    const UInt128 product = multiply_wide(raw_magnitude(a), raw_magnitude(numerator));
    const std::uint64_t divisor = raw_magnitude(denominator);
    const bool negative = (a < 0) != ((numerator < 0) != (denominator < 0));
    constexpr std::uint64_t kLimit = std::uint64_t{1} << 63U;
    if (product == UInt128{}) {
        return 0;
    }
    std::uint64_t quotient = kLimit;
    if (product.high < divisor) {
        quotient = divide(product, divisor).quotient;
    }
    if (negative) {
        return static_cast<std::int64_t>(std::uint64_t{0} -
                                         (quotient < kLimit ? quotient : kLimit));
    }
    return static_cast<std::int64_t>(quotient < kLimit ? quotient : kLimit - 1);
}

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
