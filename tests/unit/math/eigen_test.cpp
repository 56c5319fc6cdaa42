#include "tests/unit/math/support.h"

#include "lockwind/eigen.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

constexpr Real kTolerance = Real::from_raw(32);

void expect_near(Real a, Real b, Real tolerance = kTolerance) {
    EXPECT_LE(abs(a - b), tolerance) << a << " vs " << b;
}

void expect_near(const Vector3r& a, const Vector3r& b, Real tolerance = kTolerance) {
    for (int i = 0; i < 3; ++i) {
        expect_near(a[i], b[i], tolerance);
    }
}

TEST(Eigen, LiteralsKeepTheirFraction) {
    // A constructor from int would have made each of these 0.
    EXPECT_EQ(Vector3r::Scalar(0.5).raw(), std::int64_t{1} << 31);
    EXPECT_EQ(Eigen::NumTraits<Real>::Literal(0.5), Real(0.5));
    static_assert(std::is_same_v<Eigen::NumTraits<Real>::NonInteger, Real>);
}

TEST(Eigen, MatrixOfAQuaternionAndBackInAllFourBranches) {
    // The largest of w, x, y, z chooses the branch; each divides a literal 0.5 by a root.
    for (const RealQuat& q : {RealQuat{0.1, -0.2, 0.3, 0.9},
                              RealQuat{0.9, 0.1, -0.2, 0.3},
                              RealQuat{0.3, 0.9, 0.1, -0.2},
                              RealQuat{-0.2, 0.3, 0.9, 0.1}}) {
        const Quaternionr unit = to_eigen(normalized(q));
        const Quaternionr back(unit.toRotationMatrix());
        const Real sign = unit.dot(back) < 0 ? -1 : 1;
        expect_near(unit.vec(), back.vec() * sign);
        expect_near(unit.w(), back.w() * sign);
    }
}

TEST(Eigen, MatrixToQuaternionHoldsForRandomRotations) {
    Draws draws(61);
    for (int i = 0; i < 2000; ++i) {
        const Quaternionr q = to_eigen(draws.rotation());
        const Quaternionr back(q.toRotationMatrix());
        ASSERT_GT(abs(q.dot(back)), Real(0.99999999));
    }
}

TEST(Eigen, AngleAxisRoundTripsThroughMatrixAndQuaternion) {
    for (const Real angle : {Real(0.5), Real(1.5), Real(3)}) {
        const Vector3r axis = to_eigen(normalized(Vec3{1, -2, 3}));
        const AngleAxisr rotation(angle, axis);
        const AngleAxisr from_matrix(rotation.toRotationMatrix());
        const AngleAxisr from_quaternion{Quaternionr(rotation)};
        expect_near(from_matrix.angle(), angle);
        expect_near(from_quaternion.angle(), angle);
        expect_near(from_quaternion.axis(), axis);
    }
}

TEST(Eigen, NormOfShortVectorsLosesDigitsThatOursKeeps) {
    const Vec3 v{0.0003, 0.0004, 0};
    expect_near(to_eigen(v).norm(), Real(0.0005), Real(0.000001));
    EXPECT_GT(abs(to_eigen(v).norm() - Real(0.0005)), Real::from_raw(100));
    expect_near(length(v), Real(0.0005), Real::from_raw(1));
}

TEST(Eigen, AngleAxisIsOurRotation) {
    const Vec3 axis = normalized(Vec3{2, 1, -2});
    const Vec3 v{3, -4, 5};
    const Vector3r eigen = AngleAxisr(Real(1.25), to_eigen(axis)) * to_eigen(v);
    const Vec3 ours = rotate(from_axis_angle(axis, Angle::from_radians(1.25)), v);
    expect_near(eigen, to_eigen(ours));
}

TEST(Eigen, FromTwoVectorsTurnsOneIntoTheOther) {
    Draws draws(62);
    for (int i = 0; i < 2000; ++i) {
        const Vector3r a = to_eigen(draws.unit());
        const Vector3r b = to_eigen(draws.unit());
        const Quaternionr q = Quaternionr::FromTwoVectors(a, b);
        expect_near(q * a, b, Real(0.0001));
    }
}

TEST(Eigen, FromTwoVectorsTurnsNearlyOppositeVectors) {
    Draws draws(67);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 a = draws.unit();
        const Vec3 b = normalized(-a + draws.vec3(28)); // up to 1/16 off
        const Quaternionr q = Quaternionr::FromTwoVectors(to_eigen(a), to_eigen(b));
        expect_near(q * to_eigen(a), to_eigen(b), Real(0.0005));
    }
}

TEST(Eigen, FromTwoVectorsEndsForOppositeVectors) {
    Draws draws(63);
    for (int i = 0; i < 500; ++i) {
        const Vector3r a = to_eigen(draws.unit());
        const Quaternionr q = Quaternionr::FromTwoVectors(a, -a);
        expect_near(q.norm(), 1);
        // w = sqrt((1 + a.b) / 2) with an ulp in a.b: 2^-15 in the angle.
        expect_near(q * a, -a, Real(0.00004));
    }
}

TEST(Eigen, SlerpHalvesTheAngle) {
    const Quaternionr a(AngleAxisr(Real(0.2), Vector3r::UnitY()));
    const Quaternionr b(AngleAxisr(Real(1.2), Vector3r::UnitY()));
    const AngleAxisr middle(a.slerp(Real(0.5), b));
    expect_near(middle.angle(), Real(0.7), Real(0.0000001));
}

TEST(Eigen, ProductsAreThoseOfTheScalarWrittenByHand) {
    Draws draws(64);
    for (int n = 0; n < 500; ++n) {
        Matrix3r m;
        for (int i = 0; i < 9; ++i) {
            m(i / 3, i % 3) = draws.real(42);
        }
        const Vector3r v = to_eigen(draws.vec3(42));
        const Vector3r product = m * v;
        for (int row = 0; row < 3; ++row) {
            ASSERT_EQ(product[row], m(row, 0) * v[0] + m(row, 1) * v[1] + m(row, 2) * v[2]);
        }
    }
}

TEST(Eigen, IsApproxToleratesRoundingAndSeesDifferences) {
    Draws draws(65);
    const Matrix3r m = to_eigen(draws.rotation()).toRotationMatrix();
    const Matrix3r identity = m * m.transpose();
    EXPECT_NE(identity, Matrix3r(Matrix3r::Identity()));
    EXPECT_TRUE(identity.isApprox(Matrix3r::Identity()));
    EXPECT_FALSE(m.isApprox(m * Real(1.001)));
    // Squares of differences below 2^-17 are 0, whatever the precision.
    EXPECT_TRUE(identity.isApprox(Matrix3r::Identity(), 0));
}

TEST(Eigen, InverseOfARotationIsItsTranspose) {
    Draws draws(66);
    const Matrix3r m = to_eigen(draws.rotation()).toRotationMatrix();
    EXPECT_TRUE(m.inverse().isApprox(m.transpose()));
    expect_near(m.determinant(), 1);
}

TEST(Eigen, InverseOfALargeDiagonalNeedsAnotherWay) {
    // diag(10^5)'s determinant is 10^15; element by element the same inverse fits.
    const Vector3r diagonal(100000, 100000, 100000);
    expect_near(diagonal.cwiseInverse(), Vector3r(Real(0.00001), Real(0.00001), Real(0.00001)));
#if !defined(LOCKWIND_CHECKED)
    const Matrix3r inverse = diagonal.asDiagonal().toDenseMatrix().inverse();
    EXPECT_FALSE((inverse * diagonal).isApprox(Vector3r::Ones()));
#else
    EXPECT_DEATH((void)diagonal.asDiagonal().toDenseMatrix().inverse().eval(),
                 "fixed-point overflow: narrow");
#endif
}

TEST(Eigen, ConvertsToAndFromOurTypes) {
    const Vec3 v{1, -2.5, 3};
    const RealQuat q{0.1, 0.2, 0.3, 0.4};
    EXPECT_EQ(from_eigen(to_eigen(v)), v);
    EXPECT_EQ(from_eigen(to_eigen(q)), q);
    EXPECT_EQ(to_eigen(q).w(), q.w);
}

} // namespace
} // namespace lockwind
