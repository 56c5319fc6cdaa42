#include "geometry/rotation.h"

#include "lockwind/integer.h"

namespace lockwind {

void rotation_matrix(const std::int32_t orientation[4], std::int32_t rotation[9]) {
    const std::int64_t x = orientation[0];
    const std::int64_t y = orientation[1];
    const std::int64_t z = orientation[2];
    const std::int64_t w = orientation[3];
    // one + twice a sum of two products (Q60), in Q30: the second term alone may be -2, out of
    // range.
    const auto entry = [](std::int64_t one, std::int64_t sum) {
        return raw_narrow<std::int32_t>(one + round_shift(sum, kUnitFraction - 1));
    };
    rotation[0] = entry(kUnitOne, -(y * y + z * z));
    rotation[1] = entry(0, x * y - w * z);
    rotation[2] = entry(0, x * z + w * y);
    rotation[3] = entry(0, x * y + w * z);
    rotation[4] = entry(kUnitOne, -(x * x + z * z));
    rotation[5] = entry(0, y * z - w * x);
    rotation[6] = entry(0, x * z - w * y);
    rotation[7] = entry(0, y * z + w * x);
    rotation[8] = entry(kUnitOne, -(x * x + y * y));
}

std::int64_t dot_unit(const std::int32_t unit[3], const std::int64_t v[3]) {
    // v = high * 2^24 + low, 0 <= low < 2^24. Dropping the low half's own 24 bits after the
    // rounding constant is added is exact: the high half is a multiple of them.
    constexpr int kLowBits = 24;
    constexpr std::int64_t kLowMask = (std::int64_t{1} << kLowBits) - 1;
    std::int64_t high = 0;
    std::int64_t low = std::int64_t{1} << (kUnitFraction - 1);
    for (int axis = 0; axis < 3; ++axis) {
        high += unit[axis] * (v[axis] >> kLowBits);
        low += unit[axis] * (v[axis] & kLowMask);
    }
    return (high + (low >> kLowBits)) >> (kUnitFraction - kLowBits);
}

void rotate(const std::int32_t* rotation, const std::int64_t v[3], std::int64_t out[3]) {
    for (int row = 0; row < 3; ++row) {
        out[row] = dot_unit(rotation + 3 * row, v);
    }
}

void inverse_rotate(const std::int32_t* rotation, const std::int64_t v[3], std::int64_t out[3]) {
    for (int column = 0; column < 3; ++column) {
        const std::int32_t axis[3] = {rotation[column], rotation[3 + column], rotation[6 + column]};
        out[column] = dot_unit(axis, v);
    }
}

} // namespace lockwind
