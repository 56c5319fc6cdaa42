#pragma once

// Eigen over fixed-point scalars. Costs a translation unit about 2 s and 230 MB: include it only
// where Eigen is used. Hot paths use dot, cross and rotate of vector.h, which round once and are
// faster.
//
// Rules: never `auto` an expression. inverse() and determinant() of large entries overflow. Eigen's
// norm, normalize and isApprox go through squares in the scalar: they lose half the digits of short
// vectors (normalized() of vector.h does not), and isApprox sees no difference below 2^-17.

#include "lockwind/trig.h"
#include "lockwind/vector.h"

#include <limits>

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

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

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind

// NOLINTBEGIN(readability-identifier-naming): the names are those of std and Eigen.

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

    static constexpr Scalar epsilon() { return Scalar::ulp(); }
    /// 2^-12 in a Real: its square, which isApprox compares with, still has many ulp.
    static constexpr Scalar dummy_precision() {
        return Scalar::from_raw(typename Scalar::raw_type{1}
                                << (FractionBits - FractionBits * 3 / 8));
    }
    static constexpr Scalar highest() { return Scalar::highest(); }
    static constexpr Scalar lowest() { return Scalar::lowest(); }
    static constexpr int digits10() { return std::numeric_limits<Scalar>::digits10; }
};

/// Not defined: Jacobi's iteration need not end over a fixed-point scalar.
template <class Raw,
          int FractionBits,
          int Rows,
          int Cols,
          int Options,
          int RowsMax,
          int ColsMax,
          int Q>
class JacobiSVD<Matrix<lockwind::Fixed<Raw, FractionBits>, Rows, Cols, Options, RowsMax, ColsMax>,
                Q>;

/// What FromTwoVectors asks for where its unit vectors, the rows of m, are nearly opposite: column
/// 2 of V, a unit vector perpendicular to both, within 2^-15.
template <int Q>
class JacobiSVD<Matrix<lockwind::Real, 2, 3>, Q> {
public:
    JacobiSVD(const Matrix<lockwind::Real, 2, 3>& m, unsigned int /*options*/) {
        using lockwind::Vec3;
        const Vec3 a{m(0, 0), m(0, 1), m(0, 2)};
        const Vec3 b{m(1, 0), m(1, 1), m(1, 2)};
        Vec3 normal = cross(a, b);
        // Shorter than this, the rounding of the product bends it more than b differs from -a.
        if (length(normal) < lockwind::Real(1.0 / (1 << 16))) {
            const bool along_x = abs(a.x) > lockwind::Real(0.5);
            normal = cross(a, along_x ? Vec3{0, 1, 0} : Vec3{1, 0, 0});
        }
        const Vec3 unit = lockwind::normalized(normal);
        const Vec3 second = cross(unit, a);
        v_ << a.x, second.x, unit.x, a.y, second.y, unit.y, a.z, second.z, unit.z;
    }
    const Matrix<lockwind::Real, 3, 3>& matrixV() const { return v_; }

private:
    Matrix<lockwind::Real, 3, 3> v_;
};

} // namespace Eigen

// NOLINTEND(readability-identifier-naming)

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

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

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
