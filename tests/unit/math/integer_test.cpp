#include "math/integer.h"
#include "tests/unit/math/support.h"

#include <gtest/gtest.h>
#include <limits>

namespace lockwind {
namespace {

constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kHigh = std::numeric_limits<std::int64_t>::max();

bool is_floor_root(const UInt128& value, std::uint64_t root) {
    // (root + 1)^2 > value, written without overflow: value - root^2 <= 2 root.
    const UInt128 square = multiply_wide(root, root);
    return square <= value && value - square <= multiply_wide(root, 2);
}

TEST(FloorSqrt, IsExactAroundEverySmallSquare) {
    for (std::uint64_t root = 0; root < 2000; ++root) {
        EXPECT_EQ(floor_sqrt(root * root), root);
        EXPECT_EQ(floor_sqrt(root * root + 2 * root), root);
    }
}

TEST(FloorSqrt, IsExactAroundLargeSquaresWhereDoublesAreNot) {
    // Above 2^53 a double rounds these to the same number.
    Draws draws(11);
    for (int i = 0; i < 50000; ++i) {
        const std::uint64_t root = (draws.any(32) | 2U) & 0xffffffffU;
        const std::uint64_t square = root * root;
        ASSERT_EQ(floor_sqrt(square - 1), root - 1) << root;
        ASSERT_EQ(floor_sqrt(square), root) << root;
        ASSERT_EQ(floor_sqrt(square + 2 * root), root) << root;
    }
    EXPECT_EQ(floor_sqrt(~0ULL), 0xffffffffULL);
}

TEST(FloorSqrt, DoesNotDependOnTheSeed) {
    Draws draws(12);
    for (int i = 0; i < 20000; ++i) {
        const std::uint64_t value = draws.any();
        const std::uint64_t root = floor_sqrt(value);
        ASSERT_EQ(floor_sqrt_portable(value), root) << value;
        for (const std::uint64_t wrong : {root + 7, root < 7 ? 0 : root - 7}) {
            ASSERT_EQ(detail::exact_root(value, wrong), root) << value << " from " << wrong;
        }
    }
}

TEST(FloorSqrt, GivesConstantsWhatItGivesAtRunTime) {
    static_assert(floor_sqrt(0) == 0);
    static_assert(floor_sqrt(~0ULL) == 0xffffffffULL);
    static_assert(floor_sqrt128({~0ULL, ~0ULL}) == ~0ULL);
    volatile std::uint64_t value = 152415787501905210ULL;
    constexpr std::uint64_t kRoot = floor_sqrt(152415787501905210ULL);
    EXPECT_EQ(kRoot, 390404645U);
    EXPECT_EQ(floor_sqrt(value), kRoot);
}

TEST(FloorSqrt128, IsTheLargestRootWhoseSquareFits) {
    Draws draws(13);
    for (int i = 0; i < 100000; ++i) {
        const UInt128 value{draws.any(), draws.any()};
        ASSERT_TRUE(is_floor_root(value, floor_sqrt128(value))) << value.high << ' ' << value.low;
    }
}

TEST(FloorSqrt128, IsExactAroundSquares) {
    Draws draws(14);
    for (int i = 0; i < 100000; ++i) {
        const std::uint64_t root = draws.any() | 1U;
        const UInt128 square = multiply_wide(root, root);
        ASSERT_EQ(floor_sqrt128(square), root);
        ASSERT_EQ(floor_sqrt128(square - UInt128{0, 1}), root - 1);
        ASSERT_EQ(floor_sqrt128(square + multiply_wide(root, 2)), root);
    }
}

TEST(Divide, IsTheSameByInstructionAndByDigits) {
    Draws draws(15);
    for (int i = 0; i < 100000; ++i) {
        const std::uint64_t divisor = draws.any() | 1U;
        const UInt128 numerator{draws.any() % divisor, draws.any()};
        const Division hardware = divide(numerator, divisor);
        const Division portable = divide_portable(numerator, divisor);
        ASSERT_EQ(hardware.quotient, portable.quotient);
        ASSERT_EQ(hardware.remainder, portable.remainder);
        ASSERT_LT(portable.remainder, divisor);
        ASSERT_EQ(multiply_wide(portable.quotient, divisor) + (UInt128{0, portable.remainder}),
                  numerator);
    }
}

TEST(Divide, CorrectsDigitsThatAreEstimatedTwoTooLarge) {
    // Divisors of a small second digit and numerators just below them: algorithm D's rare steps.
    for (const std::uint64_t divisor : {0x8000000000000001ULL,
                                        0x80000000ffffffffULL,
                                        0xffffffffffffffffULL,
                                        0x8000000000000000ULL}) {
        for (const std::uint64_t low : {0ULL, 1ULL, 0xffffffffULL, 0xffffffff00000000ULL, ~0ULL}) {
            const UInt128 numerator{divisor - 1, low};
            const Division result = divide_portable(numerator, divisor);
            EXPECT_LT(result.remainder, divisor);
            EXPECT_EQ(multiply_wide(result.quotient, divisor) + (UInt128{0, result.remainder}),
                      numerator);
        }
    }
}

TEST(DivideWide, KeepsAllBitsOfTheQuotient) {
    Draws draws(16);
    for (int i = 0; i < 20000; ++i) {
        const std::uint64_t divisor = draws.any() | 1U;
        const UInt128 numerator{draws.any(), draws.any()};
        const UInt128 quotient = divide_wide(numerator, divisor);
        const UInt128 back =
            multiply_wide(quotient.low, divisor) + UInt128{quotient.high * divisor, 0};
        ASSERT_LE(back, numerator);
        ASSERT_LT(numerator - back, (UInt128{0, divisor}));
    }
}

TEST(MultiplyDivide, TruncatesTowardsZero) {
    EXPECT_EQ(multiply_divide(7, 1, 2), 3);
    EXPECT_EQ(multiply_divide(-7, 1, 2), -3);
    EXPECT_EQ(multiply_divide(7, -1, 2), -3);
    EXPECT_EQ(multiply_divide(-7, -1, -2), -3);
}

TEST(MultiplyDivide, KeepsProductsThatLeave64Bits) {
    EXPECT_EQ(multiply_divide(kHigh, kHigh, kHigh), kHigh);
    EXPECT_EQ(multiply_divide(kLow, kLow, kLow), kLow);
    EXPECT_EQ(multiply_divide(4'000'000'000'000'000'000, 9, 12), 3'000'000'000'000'000'000);
}

TEST(MultiplyDivide, SaturatesBySign) {
    EXPECT_EQ(multiply_divide(kHigh, 2, 1), kHigh);
    EXPECT_EQ(multiply_divide(kHigh, -2, 1), kLow);
    EXPECT_EQ(multiply_divide(kLow, 1, -1), kHigh);
    EXPECT_EQ(multiply_divide(5, 1, 0), kHigh);
    EXPECT_EQ(multiply_divide(-5, 1, 0), kLow);
    EXPECT_EQ(multiply_divide(0, 5, 0), 0);
}

TEST(MultiplyShift, AgreesWithTheWideFormWhereTheProductFits) {
    Draws draws(17);
    for (int i = 0; i < 20000; ++i) {
        const std::int64_t a = draws.any_signed(31);
        const std::int64_t b = draws.any_signed(31);
        const int shift = static_cast<int>(draws.bits() % 60);
        ASSERT_EQ(multiply_shift(a, b, shift), multiply_shift_wide(a, b, shift));
    }
}

} // namespace
} // namespace lockwind
