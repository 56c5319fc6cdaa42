#pragma once

#include "lockwind/assert.h"

#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

// LOCKWIND_NO_INT128 chooses the portable path everywhere: two limbs, no instructions of one
// machine.
#if defined(__SIZEOF_INT128__) && !defined(LOCKWIND_NO_INT128)
#define LOCKWIND_HAS_INT128 1
#else
#define LOCKWIND_HAS_INT128 0
#endif
#if defined(__x86_64__) && LOCKWIND_HAS_INT128
#define LOCKWIND_HAS_X86_64 1
#else
#define LOCKWIND_HAS_X86_64 0
#endif

// The arithmetic of a build is part of its types' names: objects of a CHECKED and of a wrapping
// build never link into one program by mistake, and one test program may compare all four.
#if defined(LOCKWIND_CHECKED) && LOCKWIND_CHECKED
#define LOCKWIND_ARITHMETIC_CHECKED true
#if LOCKWIND_HAS_INT128
#define LOCKWIND_ARITHMETIC checked
#else
#define LOCKWIND_ARITHMETIC checked_portable
#endif
#else
#define LOCKWIND_ARITHMETIC_CHECKED false
#if LOCKWIND_HAS_INT128
#define LOCKWIND_ARITHMETIC wrapping
#else
#define LOCKWIND_ARITHMETIC wrapping_portable
#endif
#endif

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

/// True in a build that traps every overflow; elsewhere arithmetic wraps in two's complement.
inline constexpr bool kChecked = LOCKWIND_ARITHMETIC_CHECKED;

/// Says which operation overflowed, and aborts. In a constant expression: does not compile.
[[noreturn]] inline void overflow_trapped(const char* operation) {
    assert_failed(operation, __FILE__, __LINE__);
}

/// Sum, difference, product, negation of raw values: wrapping, or trapping in a CHECKED build.
template <std::signed_integral T>
constexpr T raw_add(T a, T b) {
    if constexpr (kChecked) {
        T result{};
        if (__builtin_add_overflow(a, b, &result)) {
            overflow_trapped("fixed-point overflow: add");
        }
        return result;
    }
    using U = std::make_unsigned_t<T>;
    return static_cast<T>(static_cast<U>(static_cast<U>(a) + static_cast<U>(b)));
}

template <std::signed_integral T>
constexpr T raw_subtract(T a, T b) {
    if constexpr (kChecked) {
        T result{};
        if (__builtin_sub_overflow(a, b, &result)) {
            overflow_trapped("fixed-point overflow: subtract");
        }
        return result;
    }
    using U = std::make_unsigned_t<T>;
    return static_cast<T>(static_cast<U>(static_cast<U>(a) - static_cast<U>(b)));
}

template <std::signed_integral T>
constexpr T raw_multiply(T a, T b) {
    if constexpr (kChecked) {
        T result{};
        if (__builtin_mul_overflow(a, b, &result)) {
            overflow_trapped("fixed-point overflow: multiply");
        }
        return result;
    }
    using U = std::make_unsigned_t<T>;
    return static_cast<T>(static_cast<U>(static_cast<U>(a) * static_cast<U>(b)));
}

template <std::signed_integral T>
constexpr T raw_negate(T a) {
    return raw_subtract(T{0}, a);
}

/// a * 2^shift, shift < width of T.
template <std::signed_integral T>
constexpr T raw_shift_left(T a, int shift) {
    using U = std::make_unsigned_t<T>;
    const T result = static_cast<T>(static_cast<U>(static_cast<U>(a) << shift));
    if constexpr (kChecked) {
        if ((result >> shift) != a) {
            overflow_trapped("fixed-point overflow: shift left");
        }
    }
    return result;
}

/// The value in a narrower type: its low bits, or a trap where it does not fit.
template <std::signed_integral To, std::signed_integral From>
constexpr To raw_narrow(From value) {
    const To result = static_cast<To>(value);
    if constexpr (kChecked) {
        if (result != value) {
            overflow_trapped("fixed-point overflow: narrow");
        }
    }
    return result;
}

/// The nearest value that `To` holds.
template <std::signed_integral To, std::signed_integral From>
constexpr To raw_saturate(From value) {
    constexpr From kLow = std::numeric_limits<To>::min();
    constexpr From kHigh = std::numeric_limits<To>::max();
    return static_cast<To>(value < kLow ? kLow : (value > kHigh ? kHigh : value));
}

/// |value|, exact for the lowest value too.
template <std::signed_integral T>
constexpr std::make_unsigned_t<T> raw_magnitude(T value) {
    using U = std::make_unsigned_t<T>;
    return value < 0 ? static_cast<U>(U{0} - static_cast<U>(value)) : static_cast<U>(value);
}

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
