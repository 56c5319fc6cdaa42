#pragma once

#include "lockwind/overflow.h"

#include <bit>
#include <compare>
#include <cstdint>

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

/// An unsigned 128-bit integer, as two limbs on every machine.
struct UInt128 {
    std::uint64_t high = 0;
    std::uint64_t low = 0;

    friend constexpr auto operator<=>(const UInt128&, const UInt128&) = default;
};

/// a * b from four 32-bit products; for machines without a 64 x 64 -> 128 multiplication.
constexpr UInt128 multiply_portable(std::uint64_t a, std::uint64_t b) {
    constexpr std::uint64_t kMask = 0xffffffffU;
    const std::uint64_t low = (a & kMask) * (b & kMask);
    const std::uint64_t cross_a = (a >> 32U) * (b & kMask);
    const std::uint64_t cross_b = (a & kMask) * (b >> 32U);
    const std::uint64_t middle = (low >> 32U) + (cross_a & kMask) + (cross_b & kMask);
    return {(a >> 32U) * (b >> 32U) + (cross_a >> 32U) + (cross_b >> 32U) + (middle >> 32U),
            (middle << 32U) | (low & kMask)};
}

constexpr UInt128 multiply_wide(std::uint64_t a, std::uint64_t b) {
#if LOCKWIND_HAS_INT128
    __extension__ using Native = unsigned __int128;
    const Native product = static_cast<Native>(a) * b;
    return {static_cast<std::uint64_t>(product >> 64U), static_cast<std::uint64_t>(product)};
#else
    return multiply_portable(a, b);
#endif
}

/// Modulo 2^128.
constexpr UInt128 operator+(const UInt128& a, const UInt128& b) {
    const std::uint64_t low = a.low + b.low;
    return {a.high + b.high + (low < a.low ? 1U : 0U), low};
}

constexpr UInt128 operator-(const UInt128& a, const UInt128& b) {
    return {a.high - b.high - (a.low < b.low ? 1U : 0U), a.low - b.low};
}

/// 0 <= shift < 128, in both directions.
constexpr UInt128 operator<<(const UInt128& a, int shift) {
    if (shift == 0) {
        return a;
    }
    if (shift >= 64) {
        return {a.low << (shift - 64), 0};
    }
    return {(a.high << shift) | (a.low >> (64 - shift)), a.low << shift};
}

constexpr UInt128 operator>>(const UInt128& a, int shift) {
    if (shift == 0) {
        return a;
    }
    if (shift >= 64) {
        return {0, a.high >> (shift - 64)};
    }
    return {a.high >> shift, (a.low >> shift) | (a.high << (64 - shift))};
}

/// 0 for 0.
constexpr int bit_width(const UInt128& a) {
    return static_cast<int>(a.high != 0 ? 64 + std::bit_width(a.high) : std::bit_width(a.low));
}

/// A signed 128-bit integer in two limbs: what Int128 is where the compiler has none.
class TwoLimb {
public:
    constexpr TwoLimb() = default;
    constexpr TwoLimb(std::int64_t value)
        : high_(value < 0 ? -1 : 0), low_(static_cast<std::uint64_t>(value)) {}
    constexpr TwoLimb(std::int64_t high, std::uint64_t low) : high_(high), low_(low) {}

    static constexpr TwoLimb product(std::int64_t a, std::int64_t b) {
        // A negative factor's two's complement is 2^64 too large: take the other factor off the
        // top.
        const UInt128 bits =
            multiply_portable(static_cast<std::uint64_t>(a), static_cast<std::uint64_t>(b));
        const std::uint64_t excess = (a < 0 ? static_cast<std::uint64_t>(b) : 0U) +
                                     (b < 0 ? static_cast<std::uint64_t>(a) : 0U);
        return {static_cast<std::int64_t>(bits.high - excess), bits.low};
    }

    constexpr std::int64_t high() const { return high_; }
    constexpr std::uint64_t low() const { return low_; }
    constexpr UInt128 bits() const { return {static_cast<std::uint64_t>(high_), low_}; }
    static constexpr TwoLimb from_bits(const UInt128& bits) {
        return {static_cast<std::int64_t>(bits.high), bits.low};
    }

    friend constexpr auto operator<=>(const TwoLimb&, const TwoLimb&) = default;

private:
    std::int64_t high_ = 0;
    std::uint64_t low_ = 0;
};

constexpr TwoLimb raw_add(TwoLimb a, TwoLimb b) {
    const TwoLimb sum = TwoLimb::from_bits(a.bits() + b.bits());
    if constexpr (kChecked) {
        if ((a.high() < 0) == (b.high() < 0) && (sum.high() < 0) != (a.high() < 0)) {
            overflow_trapped("fixed-point overflow: add");
        }
    }
    return sum;
}

constexpr TwoLimb raw_subtract(TwoLimb a, TwoLimb b) {
    const TwoLimb difference = TwoLimb::from_bits(a.bits() - b.bits());
    if constexpr (kChecked) {
        if ((a.high() < 0) != (b.high() < 0) && (difference.high() < 0) != (a.high() < 0)) {
            overflow_trapped("fixed-point overflow: subtract");
        }
    }
    return difference;
}

/// Arithmetic: floor(a / 2^shift), 0 <= shift < 128.
constexpr TwoLimb shift_right(TwoLimb a, int shift) {
    if (shift == 0) {
        return a;
    }
    if (shift >= 64) {
        return TwoLimb(a.high() >> (shift - 64));
    }
    return {a.high() >> shift,
            (a.low() >> shift) | (static_cast<std::uint64_t>(a.high()) << (64 - shift))};
}

constexpr TwoLimb raw_shift_left(TwoLimb a, int shift) {
    const TwoLimb result = TwoLimb::from_bits(a.bits() << shift);
    if constexpr (kChecked) {
        if (shift_right(result, shift) != a) {
            overflow_trapped("fixed-point overflow: shift left");
        }
    }
    return result;
}

constexpr std::uint64_t low_limb(TwoLimb a) {
    return a.low();
}

#if LOCKWIND_HAS_INT128
__extension__ using NativeInt128 = __int128;
__extension__ using NativeUInt128 = unsigned __int128;

constexpr NativeInt128 raw_add(NativeInt128 a, NativeInt128 b) {
    NativeInt128 result{};
    if (__builtin_add_overflow(a, b, &result)) {
        if constexpr (kChecked) {
            overflow_trapped("fixed-point overflow: add");
        }
    }
    return result;
}

constexpr NativeInt128 raw_subtract(NativeInt128 a, NativeInt128 b) {
    NativeInt128 result{};
    if (__builtin_sub_overflow(a, b, &result)) {
        if constexpr (kChecked) {
            overflow_trapped("fixed-point overflow: subtract");
        }
    }
    return result;
}

constexpr NativeInt128 shift_right(NativeInt128 a, int shift) {
    return a >> shift;
}

constexpr NativeInt128 raw_shift_left(NativeInt128 a, int shift) {
    const NativeInt128 result =
        static_cast<NativeInt128>(static_cast<NativeUInt128>(a) << static_cast<unsigned>(shift));
    if constexpr (kChecked) {
        if ((result >> shift) != a) {
            overflow_trapped("fixed-point overflow: shift left");
        }
    }
    return result;
}

constexpr std::uint64_t low_limb(NativeInt128 a) {
    return static_cast<std::uint64_t>(a);
}

using Int128 = NativeInt128;
#else
using Int128 = TwoLimb;
#endif

/// The exact product of two 64-bit integers, in either 128-bit type.
template <class Wide>
constexpr Wide wide_product(std::int64_t a, std::int64_t b) {
    if constexpr (std::is_same_v<Wide, TwoLimb>) {
        return TwoLimb::product(a, b);
    } else {
        return static_cast<Wide>(a) * static_cast<Wide>(b);
    }
}

/// The value in 64 bits or fewer: its low bits, or a trap where it does not fit.
template <std::signed_integral To, class Wide>
requires(sizeof(Wide) == 16) constexpr To raw_narrow(Wide value) {
    const To result = static_cast<To>(low_limb(value));
    if constexpr (kChecked) {
        if (Wide(result) != value) {
            overflow_trapped("fixed-point overflow: narrow");
        }
    }
    return result;
}

/// The nearest value that `To` holds.
template <std::signed_integral To, class Wide>
requires(sizeof(Wide) == 16) constexpr To raw_saturate(Wide value) {
    if (Wide(std::numeric_limits<To>::max()) < value) {
        return std::numeric_limits<To>::max();
    }
    if (value < Wide(std::numeric_limits<To>::min())) {
        return std::numeric_limits<To>::min();
    }
    return static_cast<To>(low_limb(value));
}

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
