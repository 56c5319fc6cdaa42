// The wrapping arithmetic, in every build: it lives in an inline namespace of its own.
#undef LOCKWIND_CHECKED

#include "math/integer.h"

#include "lockwind/vector.h"

#include <gtest/gtest.h>
#include <limits>

namespace lockwind {
namespace {

static_assert(!kChecked);

TEST(Wrapping, SumsAndDifferencesWrapInTwosComplement) {
    EXPECT_EQ(Real::highest() + Real::ulp(), Real::lowest());
    EXPECT_EQ(Real::lowest() - Real::ulp(), Real::highest());
    EXPECT_EQ(-Real::lowest(), Real::lowest());
    EXPECT_EQ(Unit::highest() + Unit::ulp(), Unit::lowest());
}

TEST(Wrapping, ProductsKeepTheirLowBits) {
    EXPECT_EQ(Real(65536) * Real(65536), 0);
    EXPECT_EQ(Real(46341) * Real(46341),
              Real(std::int64_t{46341} * 46341 - (std::int64_t{1} << 32)));
    EXPECT_EQ(Unit(1.5) * Unit(1.5), Unit(-1.75));
}

TEST(Wrapping, ASentinelIsNoValueToAddToOrToSquare) {
    // "Infinitely far" turns negative, or near: use a flag.
    const Real sentinel = Real::highest();
    EXPECT_LT(sentinel + 1, 0);
    EXPECT_EQ(sentinel * sentinel, -1);
}

TEST(Wrapping, NarrowingKeepsTheLowBits) {
    EXPECT_EQ(convert<Velocity>(Real(2048)), Velocity(-2048));
    EXPECT_EQ(raw_narrow<std::int32_t>(std::int64_t{0x180000000}),
              std::numeric_limits<std::int32_t>::min());
}

TEST(Wrapping, IsDefinedForEveryOperand) {
    constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min();
    static_assert(raw_multiply(kLow, std::int64_t{-1}) == kLow);
    static_assert(raw_add(kLow, kLow) == 0);
    static_assert(raw_shift_left(kLow, 1) == 0);
    static_assert(raw_magnitude(kLow) == std::uint64_t{1} << 63U);
}

} // namespace
} // namespace lockwind
