#pragma once

#include "lockwind/fixed.h"

#include <compare>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

/// An exact sum of products, raw / 2^FractionBits, that is rounded once, at its end. Storage is
/// int64 for products of two 32-bit formats, else Int128. A single product always fits; sums
/// overflow like Fixed does.
template <int FractionBits, class Storage = Int128>
class Wide {
public:
    using raw_type = Storage;
    static constexpr int kFraction = FractionBits;

    constexpr Wide() = default;
    static constexpr Wide from_raw(Storage raw) {
        Wide result;
        result.raw_ = raw;
        return result;
    }
    constexpr Storage raw() const { return raw_; }

    friend constexpr Wide operator+(Wide a, Wide b) { return from_raw(raw_add(a.raw_, b.raw_)); }
    friend constexpr Wide operator-(Wide a, Wide b) {
        return from_raw(raw_subtract(a.raw_, b.raw_));
    }
    friend constexpr Wide operator-(Wide a) { return Wide{} - a; }
    constexpr Wide& operator+=(Wide b) { return *this = *this + b; }
    constexpr Wide& operator-=(Wide b) { return *this = *this - b; }

    friend constexpr auto operator<=>(Wide, Wide) = default;

private:
    Storage raw_ = 0;
};

/// a * b, exact.
template <class RawA, int FractionA, class RawB, int FractionB>
constexpr auto product(Fixed<RawA, FractionA> a, Fixed<RawB, FractionB> b) {
    if constexpr (sizeof(RawA) == 4 && sizeof(RawB) == 4) {
        return Wide<FractionA + FractionB, std::int64_t>::from_raw(std::int64_t{a.raw()} * b.raw());
    } else {
        return Wide<FractionA + FractionB, Int128>::from_raw(
            wide_product<Int128>(a.raw(), b.raw()));
    }
}

/// `value` at the scale of a wide sum, to be added to its products; exact.
template <class To, class Raw, int FractionBits>
constexpr To widen(Fixed<Raw, FractionBits> value) {
    static_assert(To::kFraction >= FractionBits);
    using Storage = typename To::raw_type;
    return To::from_raw(raw_shift_left(Storage(value.raw()), To::kFraction - FractionBits));
}

/// The one rounding of a sum of products, half up: floor(wide + ulp / 2).
template <class To, int FractionBits, class Storage>
constexpr To round_to(Wide<FractionBits, Storage> wide) {
    static_assert(FractionBits >= To::kFraction);
    return To::from_raw(
        raw_narrow<typename To::raw_type>(round_shift(wide.raw(), FractionBits - To::kFraction)));
}

/// As round_to, but the nearest value of `To` where it does not fit: for writes to the state.
template <class To, int FractionBits, class Storage>
constexpr To saturate_to(Wide<FractionBits, Storage> wide) {
    static_assert(FractionBits >= To::kFraction);
    return To::from_raw(
        raw_saturate<typename To::raw_type>(round_shift(wide.raw(), FractionBits - To::kFraction)));
}

/// a / b in the format To, truncated towards zero from the exact quotient; saturates like Fixed's.
/// Reciprocals of masses, and every ratio of two formats: divide last.
template <class To, class RawA, int FractionA, class RawB, int FractionB>
constexpr To divide_to(Fixed<RawA, FractionA> a, Fixed<RawB, FractionB> b) {
    using Raw = typename To::raw_type;
    constexpr int kShift = To::kFraction + FractionB - FractionA;
    static_assert(kShift >= 0 && kShift <= 64);
    constexpr auto kHigh = static_cast<std::uint64_t>(std::numeric_limits<Raw>::max());
    const bool negative = (a.raw() < 0) != (b.raw() < 0);
    const std::uint64_t limit = negative ? kHigh + 1 : kHigh;
    const UInt128 numerator = UInt128{0, raw_magnitude(a.raw())} << kShift;
    const std::uint64_t divisor = raw_magnitude(b.raw());
    std::uint64_t magnitude = a.raw() == 0 ? 0 : limit;
    if (numerator.high < divisor) {
        magnitude = divide(numerator, divisor).quotient;
    }
    const std::uint64_t result = magnitude < limit ? magnitude : limit;
    return To::from_raw(static_cast<Raw>(negative ? std::uint64_t{0} - result : result));
}

/// `value` in another format: exact where that has as many fraction bits, else rounded half up.
template <class To, class Raw, int FractionBits>
constexpr To convert(Fixed<Raw, FractionBits> value) {
    constexpr int kShift = FractionBits - To::kFraction;
    if constexpr (kShift >= 0) {
        return To::from_raw(raw_narrow<typename To::raw_type>(round_shift(value.raw(), kShift)));
    } else {
        const std::int64_t shifted = raw_shift_left(std::int64_t{value.raw()}, -kShift);
        return To::from_raw(raw_narrow<typename To::raw_type>(shifted));
    }
}

/// As convert, but the nearest value of `To` where it does not fit.
template <class To, class Raw, int FractionBits>
constexpr To convert_saturated(Fixed<Raw, FractionBits> value) {
    constexpr int kShift = FractionBits - To::kFraction;
    if constexpr (kShift >= 0) {
        return To::from_raw(raw_saturate<typename To::raw_type>(round_shift(value.raw(), kShift)));
    } else {
        return To::from_raw(
            raw_saturate<typename To::raw_type>(raw_shift_left(Int128(value.raw()), -kShift)));
    }
}

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
