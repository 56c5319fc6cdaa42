#pragma once

#include "lockwind/integer.h"
#include "lockwind/overflow.h"

#include <compare>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

/// A fixed-point number: raw / 2^FractionBits in two's complement, of the one width and scale its
/// type says. + - and * wrap (defined), a CHECKED build traps instead; * rounds once, half up; /
/// truncates and saturates. Different formats mix only through product() and convert() or
/// round_to(): wide.h.
template <class Raw, int FractionBits>
class Fixed {
    static_assert(std::is_same_v<Raw, std::int32_t> || std::is_same_v<Raw, std::int64_t>);
    static_assert(FractionBits >= 0 && FractionBits < std::numeric_limits<Raw>::digits);

public:
    using raw_type = Raw;
    static constexpr int kFraction = FractionBits;

    constexpr Fixed() = default;

    /// Integers convert exactly, or overflow.
    template <class Integer>
    requires std::is_integral_v<Integer>
    constexpr Fixed(Integer value) : raw_(raw_of_integer(value)) {}

    /// Literals convert at compile time, to the nearest, half up; one out of range does not
    /// compile, nor does a run-time double.
    consteval Fixed(double value) : raw_(raw_of_literal(value)) {}

    static constexpr Fixed from_raw(Raw raw) {
        Fixed result;
        result.raw_ = raw;
        return result;
    }
    static constexpr Fixed lowest() { return from_raw(std::numeric_limits<Raw>::min()); }
    static constexpr Fixed highest() { return from_raw(std::numeric_limits<Raw>::max()); }
    /// One unit in the last place, 2^-FractionBits.
    static constexpr Fixed ulp() { return from_raw(1); }

    constexpr Raw raw() const { return raw_; }

    friend constexpr Fixed operator+(Fixed a, Fixed b) { return from_raw(raw_add(a.raw_, b.raw_)); }
    friend constexpr Fixed operator-(Fixed a, Fixed b) {
        return from_raw(raw_subtract(a.raw_, b.raw_));
    }
    friend constexpr Fixed operator-(Fixed a) { return from_raw(raw_negate(a.raw_)); }

    /// Rounded half up: floor(a b + ulp / 2).
    friend constexpr Fixed operator*(Fixed a, Fixed b) {
        if constexpr (sizeof(Raw) == 4) {
            const std::int64_t product = std::int64_t{a.raw_} * b.raw_;
            return from_raw(raw_narrow<Raw>(round_shift(product, FractionBits)));
        } else {
            const auto product = wide_product<Int128>(a.raw_, b.raw_);
            return from_raw(raw_narrow<Raw>(round_shift(product, FractionBits)));
        }
    }

    /// The exact quotient truncated towards zero. Saturates where the quotient has no value, in
    /// every build; x / 0 is highest() for x > 0, lowest() for x < 0, 0 for 0.
    friend constexpr Fixed operator/(Fixed a, Fixed b) {
        return from_raw(quotient(a.raw_, b.raw_));
    }

    constexpr Fixed& operator+=(Fixed b) { return *this = *this + b; }
    constexpr Fixed& operator-=(Fixed b) { return *this = *this - b; }
    constexpr Fixed& operator*=(Fixed b) { return *this = *this * b; }
    constexpr Fixed& operator/=(Fixed b) { return *this = *this / b; }

    friend constexpr auto operator<=>(Fixed, Fixed) = default;

    /// abs(lowest()) overflows.
    friend constexpr Fixed abs(Fixed a) { return a.raw_ < 0 ? -a : a; }

    /// floor(sqrt(a)) to the last place, exact; 0 for a <= 0.
    friend constexpr Fixed sqrt(Fixed a) {
        if (a.raw_ <= 0) {
            return 0;
        }
        const UInt128 scaled = UInt128{0, static_cast<std::uint64_t>(a.raw_)} << FractionBits;
        return from_raw(static_cast<Raw>(floor_sqrt128(scaled)));
    }

    /// floor(1 / sqrt(a)) to the last place, exact; highest() for a <= 0 and where it does not fit.
    friend constexpr Fixed rsqrt(Fixed a) {
        static_assert(3 * FractionBits < 128);
        if (a.raw_ <= 0) {
            return highest();
        }
        // floor(sqrt(floor(x))) = floor(sqrt(x)), so that the two floors are one.
        const UInt128 square =
            divide_wide(UInt128{0, 1} << (3 * FractionBits), static_cast<std::uint64_t>(a.raw_));
        const std::uint64_t root = floor_sqrt128(square);
        constexpr auto kLimit = static_cast<std::uint64_t>(std::numeric_limits<Raw>::max());
        return from_raw(static_cast<Raw>(root < kLimit ? root : kLimit));
    }

private:
    template <class Integer>
    static constexpr Raw raw_of_integer(Integer value) {
        if constexpr (kChecked) {
            constexpr std::int64_t kHigh = std::numeric_limits<Raw>::max() >> FractionBits;
            constexpr std::int64_t kLow = std::numeric_limits<Raw>::min() >> FractionBits;
            const bool fits =
                std::is_signed_v<Integer>
                    ? static_cast<std::int64_t>(value) >= kLow &&
                          static_cast<std::int64_t>(value) <= kHigh
                    : static_cast<std::uint64_t>(value) <= static_cast<std::uint64_t>(kHigh);
            if (!fits) {
                overflow_trapped("fixed-point overflow: integer conversion");
            }
        }
        return static_cast<Raw>(static_cast<std::uint64_t>(value) << FractionBits);
    }

    static consteval Raw raw_of_literal(double value) {
        // The scale is a power of two and the difference is below 1: both are exact.
        const double scaled = value * static_cast<double>(std::uint64_t{1} << FractionBits);
        const Raw truncated = static_cast<Raw>(scaled);
        const double fraction = scaled - static_cast<double>(truncated);
        if (fraction < -0.5) {
            return static_cast<Raw>(truncated - 1);
        }
        return static_cast<Raw>(fraction >= 0.5 ? truncated + 1 : truncated);
    }

    static constexpr Raw quotient(Raw a, Raw b) {
        constexpr auto kHigh = static_cast<std::uint64_t>(std::numeric_limits<Raw>::max());
        const bool negative = (a < 0) != (b < 0);
        const std::uint64_t limit = negative ? kHigh + 1 : kHigh;
        const std::uint64_t divisor = raw_magnitude(b);
        std::uint64_t magnitude = a == 0 ? 0 : limit;
        if constexpr (sizeof(Raw) == 4) {
            if (divisor != 0) {
                magnitude = (std::uint64_t{raw_magnitude(a)} << FractionBits) / divisor;
            }
        } else {
            const UInt128 numerator = UInt128{0, raw_magnitude(a)} << FractionBits;
            if (numerator.high < divisor) {
                magnitude = divide(numerator, divisor).quotient;
            }
        }
        const std::uint64_t result = magnitude < limit ? magnitude : limit;
        return static_cast<Raw>(negative ? std::uint64_t{0} - result : result);
    }

    Raw raw_ = 0;
};

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
