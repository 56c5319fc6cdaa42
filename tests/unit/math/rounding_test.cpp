// One rule per operation. Each vector here separates that rule from the others: round half up,
// truncation, floor, half to even, half away from zero.

#include "math/integer.h"
#include "tests/unit/math/support.h"

#include "lockwind/vector.h"

#include <array>
#include <gtest/gtest.h>

namespace lockwind {
namespace {

struct Rounding {
    std::int64_t value; // in quarters
    std::int64_t rounded;
};

//                             quarters:  half up   trunc  floor  even  away
constexpr std::array<Rounding, 10> kHalfUp{{{1, 0},      // 0       0      0     0     0
                                            {2, 1},      // 1       0      0     0     1
                                            {3, 1},      // 1       0      0     1     1
                                            {6, 2},      // 2       1      1     2     2
                                            {10, 3},     // 3       2      2     2     3
                                            {-1, 0},     // 0       0     -1     0     0
                                            {-2, 0},     // 0       0     -1     0    -1
                                            {-3, -1},    // -1      0     -1    -1    -1
                                            {-6, -1},    // -1     -1     -2    -2    -2
                                            {-10, -2}}}; // -2    -2     -3    -2    -3

TEST(Rounding, ShiftsHalfUp) {
    for (const Rounding& vector : kHalfUp) {
        EXPECT_EQ(round_shift(vector.value, 2), vector.rounded) << vector.value;
        EXPECT_EQ(round_shift(TwoLimb(vector.value), 2), TwoLimb(vector.rounded)) << vector.value;
        EXPECT_EQ(round_shift(static_cast<std::int32_t>(vector.value), 2), vector.rounded);
    }
}

TEST(Rounding, ProductsOfFixedRoundHalfUp) {
    const Real quarter = 0.25;
    const Velocity velocity_quarter = 0.25;
    for (const Rounding& vector : kHalfUp) {
        EXPECT_EQ((Real::from_raw(vector.value) * quarter).raw(), vector.rounded);
        EXPECT_EQ(
            (Velocity::from_raw(static_cast<std::int32_t>(vector.value)) * velocity_quarter).raw(),
            vector.rounded);
    }
}

TEST(Rounding, WideSumsRoundHalfUpOnce) {
    using Sum = Wide<34>;
    for (const Rounding& vector : kHalfUp) {
        EXPECT_EQ(round_to<Real>(Sum::from_raw(vector.value)).raw(), vector.rounded);
        EXPECT_EQ(saturate_to<Real>(Sum::from_raw(vector.value)).raw(), vector.rounded);
    }
}

TEST(Rounding, ConversionsRoundHalfUp) {
    using Finer = Fixed<std::int64_t, 34>;
    for (const Rounding& vector : kHalfUp) {
        EXPECT_EQ(convert<Real>(Finer::from_raw(vector.value)).raw(), vector.rounded);
        EXPECT_EQ(convert_saturated<Real>(Finer::from_raw(vector.value)).raw(), vector.rounded);
    }
}

TEST(Rounding, HalfUpIsNotOdd) {
    // Negating an operand changes the result of a tie: code that mirrors must mirror its operands
    // too.
    const Real tie = Real::from_raw(1);
    EXPECT_EQ((tie * Real(0.5)).raw(), 1);
    EXPECT_EQ((-tie * Real(0.5)).raw(), 0);
    EXPECT_NE(-(tie * Real(0.5)), -tie * Real(0.5));
}

TEST(Rounding, ShiftsTheExtremesWithoutOverflow) {
    constexpr std::int64_t kHigh = std::numeric_limits<std::int64_t>::max();
    constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min();
    EXPECT_EQ(round_shift(kHigh, 1), std::int64_t{1} << 62);
    EXPECT_EQ(round_shift(kHigh, 63), 1);
    EXPECT_EQ(round_shift(kLow, 63), -1);
    EXPECT_EQ(round_shift(kLow, 1), kLow / 2);
    EXPECT_EQ(round_shift(kHigh, 0), kHigh);
}

TEST(Rounding, LiteralsRoundToTheNearestHalfUp) {
    // Quarters of a unit of Q2.30, exact in a double.
    EXPECT_EQ(Unit(0.25 / (1 << 30)).raw(), 0);
    EXPECT_EQ(Unit(0.5 / (1 << 30)).raw(), 1);
    EXPECT_EQ(Unit(0.75 / (1 << 30)).raw(), 1);
    EXPECT_EQ(Unit(2.5 / (1 << 30)).raw(), 3);
    EXPECT_EQ(Unit(-0.5 / (1 << 30)).raw(), 0);
    EXPECT_EQ(Unit(-0.75 / (1 << 30)).raw(), -1);
    EXPECT_EQ(Unit(-1.5 / (1 << 30)).raw(), -1);
    // The double just below a half: adding 0.5 and truncating would give 1.
    EXPECT_EQ(Unit(0.49999999999999994 / (1 << 30)).raw(), 0);
}

TEST(Rounding, QuotientsTruncate) {
    struct Division {
        std::int64_t numerator, denominator, quotient;
    };
    // In ulp / integers: where floor, half up, half even or away differ from truncation.
    for (const Division& vector : {Division{7, 2, 3},
                                   Division{-7, 2, -3},
                                   Division{7, -2, -3},
                                   Division{-7, -2, 3},
                                   Division{5, 3, 1},
                                   Division{-5, 3, -1},
                                   Division{-1, 2, 0},
                                   Division{1, -3, 0}}) {
        const Real numerator = Real::from_raw(vector.numerator);
        EXPECT_EQ((numerator / Real(vector.denominator)).raw(), vector.quotient);
        EXPECT_EQ(divide_to<Real>(numerator, Real(vector.denominator)).raw(), vector.quotient);
        const auto narrow = Velocity::from_raw(static_cast<std::int32_t>(vector.numerator));
        EXPECT_EQ((narrow / Velocity(vector.denominator)).raw(), vector.quotient);
    }
}

TEST(Rounding, RootsFloor) {
    EXPECT_EQ(sqrt(Real::from_raw(2)).raw(), 92681);                         // 92681.900...
    EXPECT_EQ(sqrt(Real(2)).raw(), 6074000999);                              // 6074000999.95...
    EXPECT_EQ(rsqrt(Real(3)).raw(), 2479700524);                             // 2479700524.9...
    EXPECT_EQ(length(Vec3{Real::ulp(), Real::ulp(), 0}).raw(), 1);           // 1.41...
    EXPECT_EQ(length(Vec3{Real::ulp(), Real::ulp(), Real::ulp()}).raw(), 1); // 1.73...
}

TEST(Rounding, DotProductsRoundOnce) {
    // Three quarters of an ulp each: 2.25 in all rounds to 2, one by one they make 3.
    const Vec3 a{Real::from_raw(3), Real::from_raw(3), Real::from_raw(3)};
    const Vec3 b{0.25, 0.25, 0.25};
    EXPECT_EQ(dot(a, b).raw(), 2);
    EXPECT_EQ((a.x * b.x + a.y * b.y + a.z * b.z).raw(), 3);
    // A quarter of an ulp each: none survives alone.
    const Vec3 c{Real::ulp(), Real::ulp(), Real::ulp()};
    EXPECT_EQ(dot(c, b).raw(), 1);
    EXPECT_EQ((c.x * b.x + c.y * b.y + c.z * b.z).raw(), 0);
}

TEST(Rounding, CrossProductsRoundOnce) {
    const Vec3 a{0, Real::from_raw(1), Real::from_raw(-1)};
    const Vec3 b{0, 0.25, 0.25};
    EXPECT_EQ(cross(a, b).x.raw(), 1); // 1/4 + 1/4 of an ulp
    EXPECT_EQ((a.y * b.z - a.z * b.y).raw(), 0);
}

TEST(Rounding, DampingStallsWhereTheProductRoundsToNothing) {
    // v -= v c h stops where v c h < ulp / 2: here below 50 ulp, and never at rest.
    const Velocity factor = 0.01;
    Velocity speed = 1;
    for (int i = 0; i < 5000; ++i) {
        speed -= speed * factor;
    }
    EXPECT_EQ(speed.raw(), 49);
}

} // namespace
} // namespace lockwind
