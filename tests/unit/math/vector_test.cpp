#include "tests/unit/math/support.h"

#include "lockwind/trig.h"
#include "lockwind/vector.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

constexpr Vec3 kX{1, 0, 0};
constexpr Vec3 kY{0, 1, 0};
constexpr Vec3 kZ{0, 0, 1};

void expect_near(const Vec3& a, const Vec3& b, std::int64_t ulps) {
    EXPECT_LE(abs(a.x - b.x).raw(), ulps);
    EXPECT_LE(abs(a.y - b.y).raw(), ulps);
    EXPECT_LE(abs(a.z - b.z).raw(), ulps);
}

TEST(Vec3, HasTheUsualOperators) {
    const Vec3 a{1, 2, 3};
    const Vec3 b{-4, 0.5, 6};
    EXPECT_EQ(a + b, (Vec3{-3, 2.5, 9}));
    EXPECT_EQ(a - b, (Vec3{5, 1.5, -3}));
    EXPECT_EQ(-a, (Vec3{-1, -2, -3}));
    EXPECT_EQ(2 * a, a * 2);
    EXPECT_EQ(a / 2, (Vec3{0.5, 1, 1.5}));
    Vec3 c = a;
    c += b;
    c -= a;
    c *= 2;
    EXPECT_EQ(c, (Vec3{-8, 1, 12}));
}

TEST(Vec3, DotAndCrossAreRightHanded) {
    EXPECT_EQ(cross(kX, kY), kZ);
    EXPECT_EQ(cross(kY, kZ), kX);
    EXPECT_EQ(cross(kZ, kX), kY);
    EXPECT_EQ(dot(Vec3{1, 2, 3}, Vec3{4, -5, 6}), 12);
}

TEST(Vec3, SquaredLengthsCompareBeyondTheRangeOfReal) {
    // Above 46,340 the square leaves Q31.32.
    const Vec3 near{1000000, 0, 0};
    const Vec3 far{1000000, Real::ulp(), 0};
    EXPECT_LT(dot_wide(near, near), dot_wide(far, far));
    EXPECT_GT(dot_wide(near, near), product(Real(999999), Real(999999)));
}

TEST(Vec3, LengthHoldsWhereSquaresDoNot) {
    EXPECT_EQ(length(Vec3{3000000, 4000000, 0}), 5000000);
    EXPECT_EQ(length(Vec3{-1200000000, 900000000, 0}), 1500000000);
    EXPECT_EQ(length(Vec3{0, Real::ulp(), 0}), Real::ulp());
    EXPECT_EQ(length(Vec3{}), 0);
    EXPECT_EQ(length(Vec3{Real::lowest(), Real::lowest(), Real::lowest()}), Real::highest());
}

TEST(Normalized, IsUnitForVectorsOfAnyScale) {
    // A length rounded before the division gives 0.916 here.
    const Vec3 tiny = normalized(Vec3{0.0000099, 0.0000099, 0});
    EXPECT_LE(abs(length(tiny) - 1).raw(), 1);
    EXPECT_EQ(tiny.x, tiny.y);
    EXPECT_EQ(normalized(Vec3{0, 0, -Real::ulp()}), -kZ);
    EXPECT_EQ(normalized(Vec3{Real::lowest(), 0, 0}), -kX);
    EXPECT_EQ(normalized(Vec3{3, 0, -4}), (Vec3{0.6, 0, -0.8}));
    EXPECT_EQ(normalized(Vec3{}), Vec3{});
    Draws draws(41);
    for (int i = 0; i < 20000; ++i) {
        const Vec3 v = draws.vec3(63);
        if (v == Vec3{}) {
            continue;
        }
        ASSERT_LE(abs(length(normalized(v)) - 1).raw(), 1);
    }
}

TEST(Normalized, IsOddAndDoesNotSeeTheScale) {
    Draws draws(42);
    for (int i = 0; i < 20000; ++i) {
        const Vec3 v = draws.vec3(40);
        ASSERT_EQ(normalized(-v), -normalized(v));
        ASSERT_EQ(normalized(v * 1024), normalized(v));
    }
}

TEST(Quaternion, MultipliesAsHamiltonWrote) {
    const RealQuat i{1, 0, 0, 0};
    const RealQuat j{0, 1, 0, 0};
    const RealQuat k{0, 0, 1, 0};
    EXPECT_EQ(i * j, k);
    EXPECT_EQ(j * k, i);
    EXPECT_EQ(k * i, j);
    EXPECT_EQ(i * i, (RealQuat{0, 0, 0, -1}));
    EXPECT_EQ(i * j * k, (RealQuat{0, 0, 0, -1}));
}

TEST(Quaternion, NormalisesAnyScale) {
    EXPECT_EQ(normalized(RealQuat{Real::ulp(), Real::ulp(), -Real::ulp(), Real::ulp()}),
              (RealQuat{0.5, 0.5, -0.5, 0.5}));
    EXPECT_EQ(normalized(RealQuat{Real::lowest(), Real::lowest(), Real::lowest(), Real::lowest()}),
              (RealQuat{-0.5, -0.5, -0.5, -0.5}));
    EXPECT_EQ(normalized(RealQuat{0, 3, 0, 4}), (RealQuat{0, 0.6, 0, 0.8}));
    EXPECT_EQ(normalized(RealQuat{0, 0, 0, 0}), RealQuat{});
}

TEST(Quaternion, QuarterTurnsRotateAxesIntoAxes) {
    const Angle quarter = Angle::from_turns(0.25);
    expect_near(rotate(from_axis_angle(kZ, quarter), kX), kY, 4);
    expect_near(rotate(from_axis_angle(kX, quarter), kY), kZ, 4);
    expect_near(rotate(from_axis_angle(kY, quarter), kZ), kX, 4);
    expect_near(rotate(from_axis_angle(kZ, -quarter), kY), kX, 4);
    EXPECT_EQ(rotate(RealQuat{}, Vec3{1.25, -2, 3}), (Vec3{1.25, -2, 3}));
}

TEST(Quaternion, FullTurnIsTheIdentity) {
    EXPECT_EQ(from_axis_angle(kX, Angle::from_turns(1)), RealQuat{});
    EXPECT_EQ(from_axis_angle(kX, Angle::from_turns(-7)), RealQuat{});
}

TEST(Quaternion, RotationsComposeAndInvert) {
    Draws draws(43);
    for (int n = 0; n < 5000; ++n) {
        const RealQuat a = draws.rotation();
        const RealQuat b = draws.rotation();
        const Vec3 v{draws.real(32), draws.real(32), draws.real(32)};
        expect_near(rotate(a * b, v), rotate(a, rotate(b, v)), 24);
        expect_near(rotate(conjugate(a), rotate(a, v)), v, 24);
    }
}

TEST(Quaternion, RotationKeepsTheLengthOfLongVectors) {
    const RealQuat q = from_axis_angle(normalized(Vec3{1, 2, 3}), Angle::from_turns(0.1));
    const Vec3 v{300000000, -200000000, 100000000};
    // Each component of q has 2^-33 of error: 10^-10 of 3.7 x 10^8 m.
    EXPECT_LT(abs(length(rotate(q, v)) - length(v)), Real(0.5));
}

} // namespace
} // namespace lockwind
