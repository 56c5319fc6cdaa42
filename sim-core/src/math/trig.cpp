#include "lockwind/trig.h"

#include "math/trig_coefficients.h"

#include <algorithm>
#include <array>
#include <bit>

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

namespace {

constexpr std::uint64_t kQuarterTurn = std::uint64_t{1} << 62U;
constexpr std::uint64_t kEighthTurn = std::uint64_t{1} << 61U;
constexpr std::uint64_t kHalfTurn = std::uint64_t{1} << 63U;

/// floor(a b / 2^62) of |a b| < 2^125; two factors of Q.62 give their product in Q.62.
std::int64_t multiply_q62(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(low_limb(shift_right(wide_product<Int128>(a, b), 62)));
}

/// Horner's rule; x in Q.62, the result in the coefficients' scale. Every step floors.
template <std::size_t Count>
std::int64_t evaluate(const std::array<std::int64_t, Count>& coefficients, std::int64_t x) {
    std::int64_t result = coefficients[Count - 1];
    for (std::size_t i = Count - 1; i-- > 0;) {
        result = coefficients[i] + multiply_q62(result, x);
    }
    return result;
}

/// floor(magnitude factor / 2^shift + 1/2), modulo 2^64.
std::uint64_t scale(std::uint64_t magnitude, std::uint64_t factor, int shift) {
    const UInt128 product = multiply_wide(magnitude, factor);
    return ((product + (UInt128{0, 1} << (shift - 1))) >> shift).low;
}

} // namespace

namespace detail {

CirclePoint circle_point(std::uint64_t turns) {
    // On the angle's magnitude, so that -a is a's mirror image whatever the rounding.
    const bool negative = turns > kHalfTurn;
    const std::uint64_t magnitude = negative ? std::uint64_t{0} - turns : turns;
    const std::uint64_t quadrant = (magnitude + kEighthTurn) >> 62U;
    // Turns in Q.64 are quarter turns in Q.62: z in [-1/2, 1/2].
    const auto z = static_cast<std::int64_t>(magnitude - (quadrant << 62U));
    const std::int64_t square = multiply_q62(z, z);
    const std::int64_t sine = multiply_q62(evaluate(kSineCoefficients, square), z);
    const std::int64_t cosine = evaluate(kCosineCoefficients, square);
    CirclePoint point{sine, cosine};
    if (quadrant == 1) {
        point = {cosine, -sine};
    } else if (quadrant == 2) {
        point = {-sine, -cosine};
    }
    return {negative ? -point.sin : point.sin, point.cos};
}

} // namespace detail

Angle Angle::from_radians(Real radians) {
    const std::uint64_t turns = scale(raw_magnitude(radians.raw()), kTurnsPerRadian, 34);
    return from_raw(radians < 0 ? std::uint64_t{0} - turns : turns);
}

Real Angle::radians() const {
    const auto turns = static_cast<std::int64_t>(raw_);
    const auto result = static_cast<std::int64_t>(scale(raw_magnitude(turns), kRadiansPerTurn, 93));
    return Real::from_raw(turns < 0 ? -result : result);
}

Angle atan2_angle(Real y, Real x) {
    const std::uint64_t width = raw_magnitude(x.raw());
    const std::uint64_t height = raw_magnitude(y.raw());
    if ((width | height) == 0) {
        return {};
    }
    const bool steep = height > width;
    std::uint64_t longer = steep ? height : width;
    std::uint64_t shorter = steep ? width : height;
    // The longer in [2^62, 2^63): their sum fits. Lowest() alone shifts right and loses a bit
    // of 63.
    const int shift = std::countl_zero(longer) - 1;
    longer = shift >= 0 ? longer << shift : longer >> 1U;
    shorter = shift >= 0 ? shorter << shift : shorter >> 1U;
    // Above tan(pi/8): atan(t) = pi/4 - atan((1 - t) / (1 + t)).
    const bool folded = shorter > multiply_wide(longer, kTangentEighth).high;
    const std::uint64_t numerator = folded ? longer - shorter : shorter;
    const std::uint64_t denominator = folded ? longer + shorter : longer;
    const auto ratio = static_cast<std::int64_t>(
        divide(UInt128{numerator >> 2U, numerator << 62U}, denominator).quotient);
    const std::int64_t square = multiply_q62(ratio, ratio);
    auto turns =
        static_cast<std::uint64_t>(multiply_q62(evaluate(kArctangentCoefficients, square), ratio));
    turns = folded ? kEighthTurn - turns : turns;
    turns = steep ? kQuarterTurn - turns : turns;
    turns = x < 0 ? kHalfTurn - turns : turns;
    return Angle::from_raw(y < 0 ? std::uint64_t{0} - turns : turns);
}

Real atan2(Real y, Real x) {
    const Real angle = atan2_angle(y, x).radians();
    return y >= 0 ? abs(angle) : angle;
}

namespace {

/// sqrt(1 - x^2) of |x| <= 1, floored, from the exact product.
Real complement(Real x) {
    const Int128 square = wide_product<Int128>((1 - x).raw(), (1 + x).raw());
    const UInt128 bits{low_limb(shift_right(square, 64)), low_limb(square)};
    return Real::from_raw(static_cast<std::int64_t>(floor_sqrt128(bits)));
}

} // namespace

Real asin(Real x) {
    const Real clamped = std::clamp<Real>(x, -1, 1);
    return atan2(clamped, complement(clamped));
}

Real acos(Real x) {
    const Real clamped = std::clamp<Real>(x, -1, 1);
    return atan2(complement(clamped), clamped);
}

RealQuat from_axis_angle(const Vec3& axis, Angle angle) {
    const auto half = static_cast<std::int64_t>(angle.raw()) >> 1U;
    const SinCos<Real> circle = sincos(Angle::from_raw(static_cast<std::uint64_t>(half)));
    const Vec3 vector = axis * circle.sin;
    return {vector.x, vector.y, vector.z, circle.cos};
}

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
