#pragma once

// Eigen over fixed-point scalars. Costs a translation unit about 2 s and 230 MB: include it only
// where Eigen is used. Hot paths use dot, cross and rotate of vector.h, which round once and are
// faster.
//
// Rules: never `auto` an expression; inverse() and determinant() of large entries overflow;
// isApprox compares squares, so a precision below 2^-16 has a square of 0 and means equality.

#include "lockwind/trig.h"
#include "lockwind/vector.h"

#include <limits>

namespace lockwind::inline LOCKWIND_ARITHMETIC {

/// Found by Eigen's decompositions through their argument: every value is a number.
template <class Raw, int FractionBits>
constexpr bool isfinite(Fixed<Raw, FractionBits> /*value*/) {
    return true;
}
template <class Raw, int FractionBits>
constexpr bool isnan(Fixed<Raw, FractionBits> /*value*/) {
    return false;
}
template <class Raw, int FractionBits>
constexpr bool isinf(Fixed<Raw, FractionBits> /*value*/) {
    return false;
}

} // namespace lockwind::inline LOCKWIND_ARITHMETIC

namespace std {

/// What Eigen's decompositions ask for.
template <class Raw, int FractionBits>
struct numeric_limits<lockwind::Fixed<Raw, FractionBits>> {
    using Scalar = lockwind::Fixed<Raw, FractionBits>;
    static constexpr bool is_specialized = true;
    static constexpr bool is_signed = true;
    static constexpr bool is_integer = false;
    static constexpr bool is_exact = true;
    static constexpr bool is_bounded = true;
    static constexpr bool has_infinity = false;
    static constexpr bool has_quiet_NaN = false;
    static constexpr bool has_signaling_NaN = false;
    static constexpr int radix = 2;
    static constexpr int digits = numeric_limits<Raw>::digits;
    static constexpr int digits10 = numeric_limits<Raw>::digits10;
    static constexpr Scalar min() { return Scalar::ulp(); }
    static constexpr Scalar lowest() { return Scalar::lowest(); }
    static constexpr Scalar max() { return Scalar::highest(); }
    static constexpr Scalar epsilon() { return Scalar::ulp(); }
};

} // namespace std

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace Eigen {

template <class Raw, int FractionBits>
struct NumTraits<lockwind::Fixed<Raw, FractionBits>> {
    using Scalar = lockwind::Fixed<Raw, FractionBits>;
    using Real = Scalar;
    using NonInteger = Scalar;
    using Nested = Scalar;
    // Eigen's own literals are made of this type, never of a double at run time.
    using Literal = Scalar;

    enum {
        IsComplex = 0,
        IsInteger = 0,
        IsSigned = 1,
        RequireInitialization = 0,
        ReadCost = 1,
        AddCost = 1,
        MulCost = 4
    };

    // Iterations stop at a few epsilons; rounding noise of one rotation is several ulp.
    static constexpr Scalar epsilon() { return Scalar::from_raw(16); }
    /// 2^(-3/8 of the fraction): its square, which isApprox multiplies by, still has many ulp.
    static constexpr Scalar dummy_precision() {
        return Scalar::from_raw(typename Scalar::raw_type{1}
                                << (FractionBits - FractionBits * 3 / 8));
    }
    static constexpr Scalar highest() { return Scalar::highest(); }
    static constexpr Scalar lowest() { return Scalar::lowest(); }
    static constexpr int digits10() { return std::numeric_limits<Scalar>::digits10; }
};

} // namespace Eigen

namespace lockwind::inline LOCKWIND_ARITHMETIC {

using Vector3r = Eigen::Matrix<Real, 3, 1>;
using Matrix3r = Eigen::Matrix<Real, 3, 3>;
using Quaternionr = Eigen::Quaternion<Real>;
using AngleAxisr = Eigen::AngleAxis<Real>;

inline Vector3r to_eigen(const Vec3& v) {
    return {v.x, v.y, v.z};
}
inline Quaternionr to_eigen(const RealQuat& q) {
    return {q.w, q.x, q.y, q.z};
}
inline Vec3 from_eigen(const Vector3r& v) {
    return {v.x(), v.y(), v.z()};
}
inline RealQuat from_eigen(const Quaternionr& q) {
    return {q.x(), q.y(), q.z(), q.w()};
}

} // namespace lockwind::inline LOCKWIND_ARITHMETIC
