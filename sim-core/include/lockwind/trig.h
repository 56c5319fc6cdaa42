#pragma once

#include "lockwind/fixed.h"
#include "lockwind/vector.h"

#include <cstdint>

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

/// An angle in 2^-64 turns. Sums, differences and multiples wrap exactly: a full turn is 0.
class Angle {
public:
    constexpr Angle() = default;
    static constexpr Angle from_raw(std::uint64_t raw) {
        Angle angle;
        angle.raw_ = raw;
        return angle;
    }
    /// Exact; whole turns drop out.
    static constexpr Angle from_turns(Real turns) {
        return from_raw(static_cast<std::uint64_t>(turns.raw()) << 32U);
    }
    /// Within 2^-65 + |radians| 2^-67 turns; odd: from_radians(-x) = -from_radians(x).
    static Angle from_radians(Real radians);

    constexpr std::uint64_t raw() const { return raw_; }
    /// In [-1/2, 1/2], rounded half up.
    constexpr Real turns() const {
        return Real::from_raw(round_shift(static_cast<std::int64_t>(raw_), 32));
    }
    /// In [-pi, pi], to the nearest; half a turn is -pi.
    Real radians() const;

    friend constexpr Angle operator+(Angle a, Angle b) { return from_raw(a.raw_ + b.raw_); }
    friend constexpr Angle operator-(Angle a, Angle b) { return from_raw(a.raw_ - b.raw_); }
    friend constexpr Angle operator-(Angle a) { return from_raw(std::uint64_t{0} - a.raw_); }
    friend constexpr Angle operator*(Angle a, std::int64_t count) {
        return from_raw(a.raw_ * static_cast<std::uint64_t>(count));
    }
    constexpr Angle& operator+=(Angle b) { return *this = *this + b; }
    constexpr Angle& operator-=(Angle b) { return *this = *this - b; }
    friend constexpr bool operator==(Angle, Angle) = default;

private:
    std::uint64_t raw_ = 0;
};

inline constexpr Real kPi = 3.14159265358979323846;

template <class Format>
struct SinCos {
    Format sin;
    Format cos;
};

namespace detail {

/// A point of the unit circle, Q1.62.
struct CirclePoint {
    std::int64_t sin;
    std::int64_t cos;
};

/// Within 6e-14. sin is odd and cos is even in `turns` to the bit.
CirclePoint circle_point(std::uint64_t turns);

/// To the nearest, ties away from zero, so that symmetries hold to the bit.
template <class Format>
constexpr Format round_circle(std::int64_t value) {
    constexpr int kShift = 62 - Format::kFraction;
    const std::uint64_t magnitude =
        (raw_magnitude(value) + (std::uint64_t{1} << (kShift - 1))) >> kShift;
    const auto rounded = static_cast<typename Format::raw_type>(magnitude);
    return Format::from_raw(value < 0 ? static_cast<typename Format::raw_type>(-rounded) : rounded);
}

} // namespace detail

/// Both at once, in Real or any format that holds 1, within 0.51 ulp of a Real. Quarter turns are
/// exact; sin(-a) = -sin(a) and cos(-a) = cos(a) to the bit.
template <class Format = Real>
SinCos<Format> sincos(Angle angle) {
    const detail::CirclePoint point = detail::circle_point(angle.raw());
    return {detail::round_circle<Format>(point.sin), detail::round_circle<Format>(point.cos)};
}

inline Real sin(Angle angle) {
    return sincos(angle).sin;
}

inline Real cos(Angle angle) {
    return sincos(angle).cos;
}

/// Direction of (x, y), counter-clockwise from +x, for a vector of any scale; within 2^-44 turns.
/// 0 for (0, 0); mirror images in the axes and diagonals are exact.
Angle atan2_angle(Real y, Real x);

/// In radians. Where angles are kept or added, prefer Angle: radians do not wrap exactly.
inline Real sin(Real radians) {
    return sin(Angle::from_radians(radians));
}

inline Real cos(Real radians) {
    return cos(Angle::from_radians(radians));
}

/// In (-pi, pi].
Real atan2(Real y, Real x);

/// x outside -1 .. 1 counts as the nearer end.
Real asin(Real x);
Real acos(Real x);

/// Rotation by `angle` about the unit vector `axis`, right-handed.
RealQuat from_axis_angle(const Vec3& axis, Angle angle);

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
