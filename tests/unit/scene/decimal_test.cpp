#include "scene/decimal.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace lockwind {
namespace {

TEST(Decimal, EqualsLiteralsOfTheSameText) {
    EXPECT_EQ(to_real(-9.81), Real(-9.81));
    EXPECT_EQ(to_real(0.1), Real(0.1));
    EXPECT_EQ(to_real(1.15), Real(1.15));
    EXPECT_EQ(to_real(-0.05), Real(-0.05));
    EXPECT_EQ(to_real(1e6), Real(1'000'000));
    EXPECT_EQ(to_real(0.0), Real(0));
    EXPECT_EQ(to_real(-0.0), Real(0));
}

TEST(Decimal, RoundsToTheNearestHalvesUp) {
    const double ulp = std::ldexp(1.0, -32);
    EXPECT_EQ(to_real(0.49 * ulp), Real(0));
    EXPECT_EQ(to_real(0.5 * ulp), Real::from_raw(1));
    EXPECT_EQ(to_real(-0.5 * ulp), Real(0));
    EXPECT_EQ(to_real(-0.51 * ulp), Real::from_raw(-1));
    EXPECT_EQ(to_real(1.5 * ulp), Real::from_raw(2));
    EXPECT_EQ(to_real(-1.5 * ulp), Real::from_raw(-1));
    EXPECT_EQ(to_real(-2.75 * ulp), Real::from_raw(-3));
}

TEST(Decimal, KeepsTheWholeRangeExactly) {
    EXPECT_EQ(to_real(2147483647.75), Real::from_raw(0x7fffffff'c0000000));
    EXPECT_EQ(to_real(-2147483647.75), Real::from_raw(-0x7fffffff'c0000000));
    EXPECT_EQ(to_real(std::numeric_limits<double>::denorm_min()), Real(0));
    EXPECT_EQ(to_real(std::ldexp(1.0, -100)), Real(0));
}

TEST(Decimal, RefusesWhatARealCannotHold) {
    EXPECT_EQ(to_real(2147483648.0), std::nullopt);
    EXPECT_EQ(to_real(-2147483648.0), std::nullopt);
    EXPECT_EQ(to_real(1e300), std::nullopt);
    EXPECT_EQ(to_real(std::numeric_limits<double>::infinity()), std::nullopt);
    EXPECT_EQ(to_real(-std::numeric_limits<double>::infinity()), std::nullopt);
    EXPECT_EQ(to_real(std::nan("")), std::nullopt);
}

TEST(Decimal, AgreesWithFloorOfTheScaledDouble) {
    double value = -3.0;
    for (int index = 0; index < 10'000; ++index) {
        value = value * 1.0009 + 0.00071;
        const double scaled = std::floor(std::ldexp(value, 32) + 0.5);
        if (std::fabs(scaled) < std::ldexp(1.0, 52)) {
            ASSERT_EQ(to_real(value), Real::from_raw(static_cast<std::int64_t>(scaled))) << value;
        }
    }
}

} // namespace
} // namespace lockwind
