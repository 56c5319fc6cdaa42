#pragma once

// Raw integers: what kernels that work on stored raw values use beside the types of
// lockwind/fixed.h. floor_sqrt, floor_sqrt128, divide, multiply_divide and round_shift come from
// lockwind/integer.h; raw_add, raw_subtract, raw_multiply, raw_narrow and raw_saturate from
// lockwind/overflow.h.
#include "lockwind/fixed.h"
#include "lockwind/integer.h"
#include "lockwind/wide.h"

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

/// a * b / 2^shift, rounded half up, in int64: the product must fit (a CHECKED build traps).
constexpr std::int64_t multiply_shift(std::int64_t a, std::int64_t b, int shift) {
    return round_shift(raw_multiply(a, b), shift);
}

/// a * b / 2^shift, rounded half up, through the exact 128-bit product.
constexpr std::int64_t multiply_shift_wide(std::int64_t a, std::int64_t b, int shift) {
    return raw_narrow<std::int64_t>(round_shift(wide_product<Int128>(a, b), shift));
}

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
