#pragma once

#include "lockwind/fixed.h"
#include "lockwind/wide.h"

#include <cstdint>

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

using Real = Fixed<std::int64_t, 32>;        // Q31.32: positions, speeds, masses, the API's scalar
using Unit = Fixed<std::int32_t, 30>;        // Q2.30: unit vectors, rotations, quaternions
using Length = Fixed<std::int32_t, 22>;      // Q9.22 m: local lengths, anchors, separations
using Velocity = Fixed<std::int32_t, 20>;    // Q11.20 m/s: solver velocities, impulses / mass
using Coefficient = Fixed<std::int32_t, 28>; // Q3.28: solver rows, friction, restitution
using InverseMass = Fixed<std::int64_t, 40>; // Q24.40 1/kg

struct Vec3 {
    Real x, y, z;
    bool operator==(const Vec3&) const = default;
};

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3 operator-(const Vec3& a) {
    return {-a.x, -a.y, -a.z};
}
constexpr Vec3 operator*(const Vec3& a, Real scale) {
    return {a.x * scale, a.y * scale, a.z * scale};
}
constexpr Vec3 operator*(Real scale, const Vec3& a) {
    return a * scale;
}
/// Truncated and saturating, as Real's.
constexpr Vec3 operator/(const Vec3& a, Real divisor) {
    return {a.x / divisor, a.y / divisor, a.z / divisor};
}
constexpr Vec3& operator+=(Vec3& a, const Vec3& b) {
    return a = a + b;
}
constexpr Vec3& operator-=(Vec3& a, const Vec3& b) {
    return a = a - b;
}
constexpr Vec3& operator*=(Vec3& a, Real scale) {
    return a = a * scale;
}

/// The exact dot product: compare squared lengths with it, which do not fit a Real above 46,340.
/// Overflows only where components near 2^31 add up to 2^63.
constexpr Wide<64> dot_wide(const Vec3& a, const Vec3& b) {
    return product(a.x, b.x) + product(a.y, b.y) + product(a.z, b.z);
}

/// Rounded once.
constexpr Real dot(const Vec3& a, const Vec3& b) {
    return round_to<Real>(dot_wide(a, b));
}

/// Each component rounded once.
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
    return {round_to<Real>(product(a.y, b.z) - product(a.z, b.y)),
            round_to<Real>(product(a.z, b.x) - product(a.x, b.z)),
            round_to<Real>(product(a.x, b.y) - product(a.y, b.x))};
}

namespace detail {

/// value^2, exact.
constexpr UInt128 square(Real value) {
    return multiply_wide(raw_magnitude(value.raw()), raw_magnitude(value.raw()));
}

/// 1 / |v| of a vector whose components' magnitudes, OR-ed, are `magnitudes` (not 0) and who has
/// been scaled by 2^shift so that its largest component is in [2^61, 2^62): floor(2^124 / |v
/// scaled|).
struct UnitScale {
    int shift; // to the left; negative: to the right
    std::uint64_t reciprocal;
};

constexpr int unit_shift(std::uint64_t magnitudes) {
    return std::countl_zero(magnitudes) - 2;
}

constexpr std::uint64_t scaled(Real value, int shift) {
    const std::uint64_t magnitude = raw_magnitude(value.raw());
    return shift >= 0 ? magnitude << shift : magnitude >> -shift;
}

/// floor(2^124 / sqrt(squares)), squares in [2^122, 2^126).
constexpr std::uint64_t reciprocal_root(const UInt128& squares) {
    return divide(UInt128{std::uint64_t{1} << 60U, 0}, floor_sqrt128(squares)).quotient;
}

/// A component of the unit vector, to the nearest, ties away from zero: odd-symmetric.
constexpr Real unit_component(Real value, std::uint64_t magnitude, std::uint64_t reciprocal) {
    // 2^62-scaled times 2^124 / length is 2^124 times the result: keep 32 fraction bits.
    const UInt128 wide = multiply_wide(magnitude, reciprocal) >> 91;
    const auto rounded = static_cast<std::int64_t>((wide.low + 1) >> 1U);
    return Real::from_raw(value.raw() < 0 ? -rounded : rounded);
}

} // namespace detail

/// floor(|v|) to the last place, from the exact squared length; saturates above Real::highest().
constexpr Real length(const Vec3& v) {
    const std::uint64_t root =
        floor_sqrt128(detail::square(v.x) + detail::square(v.y) + detail::square(v.z));
    const auto limit = static_cast<std::uint64_t>(Real::highest().raw());
    return Real::from_raw(static_cast<std::int64_t>(root < limit ? root : limit));
}

/// v / |v| for a v of any scale, each component within 0.51 ulp; 0 for 0.
constexpr Vec3 normalized(const Vec3& v) {
    const std::uint64_t magnitudes =
        raw_magnitude(v.x.raw()) | raw_magnitude(v.y.raw()) | raw_magnitude(v.z.raw());
    if (magnitudes == 0) {
        return {};
    }
    const int shift = detail::unit_shift(magnitudes);
    const std::uint64_t x = detail::scaled(v.x, shift);
    const std::uint64_t y = detail::scaled(v.y, shift);
    const std::uint64_t z = detail::scaled(v.z, shift);
    const std::uint64_t reciprocal =
        detail::reciprocal_root(multiply_wide(x, x) + multiply_wide(y, y) + multiply_wide(z, z));
    return {detail::unit_component(v.x, x, reciprocal),
            detail::unit_component(v.y, y, reciprocal),
            detail::unit_component(v.z, z, reciprocal)};
}

/// A rotation; (x, y, z) sin-half axis, w cos-half. Unit unless it says otherwise.
struct RealQuat {
    Real x, y, z, w = 1;
    bool operator==(const RealQuat&) const = default;
};

/// The rotation b, then a. Each component rounded once; lengths multiply, so normalise after a few.
constexpr RealQuat operator*(const RealQuat& a, const RealQuat& b) {
    return {round_to<Real>(product(a.w, b.x) + product(a.x, b.w) + product(a.y, b.z) -
                           product(a.z, b.y)),
            round_to<Real>(product(a.w, b.y) + product(a.y, b.w) + product(a.z, b.x) -
                           product(a.x, b.z)),
            round_to<Real>(product(a.w, b.z) + product(a.z, b.w) + product(a.x, b.y) -
                           product(a.y, b.x)),
            round_to<Real>(product(a.w, b.w) - product(a.x, b.x) - product(a.y, b.y) -
                           product(a.z, b.z))};
}

/// The inverse of a unit quaternion.
constexpr RealQuat conjugate(const RealQuat& q) {
    return {-q.x, -q.y, -q.z, q.w};
}

/// q / |q| for a q of any scale, each component within 0.51 ulp; the identity for 0.
constexpr RealQuat normalized(const RealQuat& q) {
    const std::uint64_t magnitudes = raw_magnitude(q.x.raw()) | raw_magnitude(q.y.raw()) |
                                     raw_magnitude(q.z.raw()) | raw_magnitude(q.w.raw());
    if (magnitudes == 0) {
        return {};
    }
    const int shift = detail::unit_shift(magnitudes);
    const std::uint64_t x = detail::scaled(q.x, shift);
    const std::uint64_t y = detail::scaled(q.y, shift);
    const std::uint64_t z = detail::scaled(q.z, shift);
    const std::uint64_t w = detail::scaled(q.w, shift);
    const std::uint64_t reciprocal = detail::reciprocal_root(
        multiply_wide(x, x) + multiply_wide(y, y) + multiply_wide(z, z) + multiply_wide(w, w));
    return {detail::unit_component(q.x, x, reciprocal),
            detail::unit_component(q.y, y, reciprocal),
            detail::unit_component(q.z, z, reciprocal),
            detail::unit_component(q.w, w, reciprocal)};
}

/// v rotated by the unit quaternion q: v + w t + u x t with t = 2 u x v, u the vector part.
/// t is rounded once, the rest once. Overflows where |v| > 2^29.
constexpr Vec3 rotate(const RealQuat& q, const Vec3& v) {
    const Vec3 u{q.x, q.y, q.z};
    const Vec3 half = cross(u, v);
    const Vec3 t = half + half;
    return {round_to<Real>(widen<Wide<64>>(v.x) + product(q.w, t.x) + product(u.y, t.z) -
                           product(u.z, t.y)),
            round_to<Real>(widen<Wide<64>>(v.y) + product(q.w, t.y) + product(u.z, t.x) -
                           product(u.x, t.z)),
            round_to<Real>(widen<Wide<64>>(v.z) + product(q.w, t.z) + product(u.x, t.y) -
                           product(u.y, t.x))};
}

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
