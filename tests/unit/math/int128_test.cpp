#include "tests/unit/math/support.h"

#include "lockwind/int128.h"
#include "lockwind/integer.h"

#include <array>
#include <gtest/gtest.h>
#include <limits>

namespace lockwind {
namespace {

constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kHigh = std::numeric_limits<std::int64_t>::max();
constexpr std::array<std::int64_t, 9> kEdges{
    kLow, kLow + 1, -0x100000000, -1, 0, 1, 0xffffffff, kHigh - 1, kHigh};

TEST(TwoLimb, MultipliesEdgesAsPublished) {
    EXPECT_EQ(TwoLimb::product(kLow, kLow), TwoLimb(std::int64_t{1} << 62, 0));
    EXPECT_EQ(TwoLimb::product(kLow, kHigh),
              TwoLimb(-(std::int64_t{1} << 62), std::uint64_t{1} << 63));
    EXPECT_EQ(TwoLimb::product(-1, 1), TwoLimb(-1));
    EXPECT_EQ(multiply_portable(~0ULL, ~0ULL), (UInt128{~0ULL - 1, 1}));
}

TEST(TwoLimb, OrdersBySignThenLimbs) {
    EXPECT_LT(TwoLimb(-1), TwoLimb(0));
    EXPECT_LT(TwoLimb(-1, 0), TwoLimb(-1, 1));
    EXPECT_LT(TwoLimb(0, ~0ULL), TwoLimb(1, 0));
    EXPECT_GT(TwoLimb(0, std::uint64_t{1} << 63), TwoLimb(0, 1));
}

TEST(TwoLimb, NarrowsToTheNearestWhenSaturating) {
    EXPECT_EQ(raw_saturate<std::int64_t>(TwoLimb(1, 0)), kHigh);
    EXPECT_EQ(raw_saturate<std::int64_t>(TwoLimb(-2, 0)), kLow);
    EXPECT_EQ(raw_saturate<std::int32_t>(TwoLimb(-7)), -7);
}

#if LOCKWIND_HAS_INT128

UInt128 bits_of(NativeInt128 value) {
    return {low_limb(shift_right(value, 64)), low_limb(value)};
}

void expect_same_arithmetic(std::int64_t a, std::int64_t b, std::int64_t c, std::int64_t d) {
    const TwoLimb limbs = TwoLimb::product(a, b);
    const TwoLimb other = TwoLimb::product(c, d);
    const NativeInt128 native = wide_product<NativeInt128>(a, b);
    const NativeInt128 native_other = wide_product<NativeInt128>(c, d);
    ASSERT_EQ(limbs.bits(), bits_of(native)) << a << " * " << b;
    ASSERT_EQ(limbs < other, native < native_other);
    ASSERT_EQ(limbs == other, native == native_other);
    // A quarter of the range, so that nothing overflows in a CHECKED build.
    const TwoLimb quarter = shift_right(limbs, 2);
    const NativeInt128 native_quarter = shift_right(native, 2);
    ASSERT_EQ(raw_add(quarter, shift_right(other, 2)).bits(),
              bits_of(raw_add(native_quarter, shift_right(native_other, 2))));
    ASSERT_EQ(raw_subtract(quarter, shift_right(other, 2)).bits(),
              bits_of(raw_subtract(native_quarter, shift_right(native_other, 2))));
    ASSERT_EQ(raw_saturate<std::int64_t>(limbs), raw_saturate<std::int64_t>(native));
    ASSERT_EQ(raw_saturate<std::int32_t>(limbs), raw_saturate<std::int32_t>(native));
    for (const int shift : {0, 1, 31, 32, 63, 64, 65, 127}) {
        ASSERT_EQ(shift_right(limbs, shift).bits(), bits_of(shift_right(native, shift))) << shift;
        ASSERT_EQ(round_shift(limbs, shift).bits(), bits_of(round_shift(native, shift))) << shift;
    }
}

TEST(TwoLimb, HasTheBitsOfTheNativeTypeAtEdges) {
    for (const std::int64_t a : kEdges) {
        for (const std::int64_t b : kEdges) {
            for (const std::int64_t c : kEdges) {
                expect_same_arithmetic(a, b, c, a ^ b);
            }
        }
    }
}

TEST(TwoLimb, HasTheBitsOfTheNativeTypeAnywhere) {
    Draws draws(1);
    for (int i = 0; i < 20000; ++i) {
        const std::int64_t a = draws.any_signed();
        const std::int64_t b = draws.any_signed();
        const std::int64_t c = draws.any_signed();
        expect_same_arithmetic(a, b, c, draws.any_signed());
    }
}

TEST(MultiplyWide, HasTheBitsOfThePortableForm) {
    Draws draws(2);
    for (int i = 0; i < 20000; ++i) {
        const std::uint64_t a = draws.any();
        const std::uint64_t b = draws.any();
        ASSERT_EQ(multiply_wide(a, b), multiply_portable(a, b)) << a << " * " << b;
    }
}

TEST(UInt128, AddsSubtractsAndShiftsAsTheNativeType) {
    Draws draws(3);
    const auto native = [](const UInt128& a) {
        return (static_cast<NativeUInt128>(a.high) << 64U) | a.low;
    };
    for (int i = 0; i < 20000; ++i) {
        const UInt128 a{draws.any(), draws.any()};
        const UInt128 b{draws.any(), draws.any()};
        const int shift = static_cast<int>(draws.bits() % 128);
        ASSERT_TRUE(native(a + b) == native(a) + native(b));
        ASSERT_TRUE(native(a - b) == native(a) - native(b));
        ASSERT_TRUE(native(a << shift) == native(a) << shift);
        ASSERT_TRUE(native(a >> shift) == native(a) >> shift);
        ASSERT_EQ(a < b, native(a) < native(b));
    }
}

#endif

} // namespace
} // namespace lockwind
