#include "scene/turn.h"

#include "lockwind/integer.h"

namespace lockwind {
namespace {

std::uint64_t magnitude(Real value) {
    const std::int64_t raw = value.raw();
    return static_cast<std::uint64_t>(raw < 0 ? -raw : raw);
}

UInt128 square(Real value) {
    return multiply_wide(magnitude(value), magnitude(value));
}

/// value / length, length > 0 and as large as any component it belongs to.
Real ratio(Real value, std::uint64_t length) {
    constexpr std::int64_t kOne = std::int64_t{1} << Real::kFraction;
    return Real::from_raw(multiply_divide(value.raw(), kOne, static_cast<std::int64_t>(length)));
}

} // namespace

RealQuat normalised(const RealQuat& quat) {
    const std::uint64_t length =
        floor_sqrt128(square(quat.x) + square(quat.y) + square(quat.z) + square(quat.w));
    if (length == 0) {
        return {};
    }
    return {
        ratio(quat.x, length), ratio(quat.y, length), ratio(quat.z, length), ratio(quat.w, length)};
}

} // namespace lockwind
