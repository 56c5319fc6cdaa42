// The CHECKED arithmetic, in every build: it lives in an inline namespace of its own.
#undef LOCKWIND_CHECKED
#define LOCKWIND_CHECKED 1

#include "math/integer.h"

#include "lockwind/vector.h"
#include "lockwind/wide.h"

#include <gtest/gtest.h>
#include <limits>

namespace lockwind {
namespace {

static_assert(kChecked);

/// The operand, unknown to the compiler.
template <class T>
T opaque(T value) {
    volatile auto raw = value.raw();
    return T::from_raw(raw);
}

std::int64_t opaque(std::int64_t value) {
    volatile std::int64_t hidden = value;
    return hidden;
}

TEST(Checked, TrapsSums) {
    EXPECT_DEATH((void)(opaque(Real::highest()) + Real::ulp()), "fixed-point overflow: add");
    EXPECT_DEATH((void)(opaque(Unit::highest()) + Unit::ulp()), "fixed-point overflow: add");
    Real sum = opaque(Real::lowest());
    EXPECT_DEATH(sum += -Real::ulp(), "fixed-point overflow: add");
}

TEST(Checked, TrapsDifferencesAndNegation) {
    EXPECT_DEATH((void)(opaque(Real::lowest()) - Real::ulp()), "fixed-point overflow: subtract");
    EXPECT_DEATH((void)-opaque(Real::lowest()), "fixed-point overflow: subtract");
    EXPECT_DEATH((void)abs(opaque(Velocity::lowest())), "fixed-point overflow: subtract");
}

TEST(Checked, TrapsProductsThatDoNotFitTheirFormat) {
    EXPECT_EQ(opaque(Real(46340)) * Real(46340), Real(2147395600));
    EXPECT_DEATH((void)(opaque(Real(46341)) * Real(46341)), "fixed-point overflow: narrow");
    EXPECT_EQ(opaque(Unit(1.25)) * Unit(1.5), Unit(1.875));
    EXPECT_DEATH((void)(opaque(Unit(1.5)) * Unit(1.5)), "fixed-point overflow: narrow");
    EXPECT_DEATH((void)(opaque(Unit::lowest()) * Unit(-1)), "fixed-point overflow: narrow");
}

TEST(Checked, TrapsInt64Products) {
    // 40 rad/s x 1/60 s in Q31.32: 2^64 x 2/3. Wrapped, it once halved rotations in silence.
    const std::int64_t speed = Real(40).raw();
    const std::int64_t tick = (Real(1) / 60).raw();
    EXPECT_DEATH((void)raw_multiply(opaque(speed), tick), "fixed-point overflow: multiply");
    EXPECT_DEATH((void)multiply_shift(opaque(speed), tick, 32), "fixed-point overflow: multiply");
    EXPECT_EQ(multiply_shift_wide(opaque(speed), tick, 32), 2863311520);
}

TEST(Checked, TrapsSumsOfProducts) {
    const auto square = product(opaque(Unit::lowest()), Unit::lowest()); // 2^62
    EXPECT_DEATH((void)(square + square), "fixed-point overflow: add");
    const auto wide = product(opaque(Real::lowest()), Real::lowest()); // 2^126
    EXPECT_DEATH((void)(wide + wide), "fixed-point overflow: add");
    EXPECT_DEATH((void)(-wide - wide - wide), "fixed-point overflow: subtract");
}

TEST(Checked, TrapsRoundingIntoANarrowerFormat) {
    // 8.6 m x 240 / s leaves Q11.20.
    EXPECT_DEATH((void)round_to<Velocity>(product(opaque(Length(8.6)), Velocity(240))),
                 "fixed-point overflow: narrow");
    EXPECT_DEATH((void)convert<Velocity>(opaque(Real(2048))), "fixed-point overflow: narrow");
    EXPECT_DEATH((void)convert<InverseMass>(opaque(Real::highest())),
                 "fixed-point overflow: shift left");
    EXPECT_EQ(saturate_to<Velocity>(product(opaque(Length(8.6)), Velocity(240))),
              Velocity::highest());
}

TEST(Checked, TrapsRoundingUpPastTheLastValue) {
    using Finer = Wide<34>;
    const auto largest = wide_product<Int128>(std::numeric_limits<std::int64_t>::max(), 4);
    const auto below = Finer::from_raw(raw_add(largest, Int128(1)));
    EXPECT_EQ(round_to<Real>(below), Real::highest());
    const auto above = Finer::from_raw(raw_add(largest, Int128(2)));
    EXPECT_DEATH((void)round_to<Real>(above), "fixed-point overflow: narrow");
}

TEST(Checked, TrapsIntegersOutOfRange) {
    volatile std::int64_t large = std::int64_t{1} << 31;
    volatile std::uint32_t huge = 0xffffffffU;
    EXPECT_DEATH((void)Real(std::int64_t{large}), "fixed-point overflow: integer conversion");
    EXPECT_DEATH((void)Real(std::uint32_t{huge}), "fixed-point overflow: integer conversion");
    EXPECT_DEATH((void)Unit(std::int64_t{large}), "fixed-point overflow: integer conversion");
    EXPECT_EQ(Real(-std::int64_t{large}), Real::lowest());
}

TEST(Checked, TrapsVectorsThatLeaveTheRange) {
    const Vec3 far{opaque(Real(50000)), 0, 0};
    EXPECT_DEATH((void)dot(far, far), "fixed-point overflow: narrow");
    EXPECT_DEATH((void)cross(far, Vec3{0, 50000, 0}), "fixed-point overflow: narrow");
    EXPECT_EQ(length(far), 50000);
    EXPECT_EQ(normalized(far), (Vec3{1, 0, 0}));
}

TEST(Checked, KineticEnergyOfTenTonsTrapsAbove655MetresPerSecond) {
    const Real half_mass = opaque(Real(5000));
    EXPECT_EQ(half_mass * (Real(655) * Real(655)), Real(2145125000));
    EXPECT_DEATH((void)(half_mass * (Real(656) * Real(656))), "fixed-point overflow: narrow");
}

TEST(Checked, DivisionAndRootsSaturateAsDocumented) {
    EXPECT_EQ(opaque(Real(1)) / 0, Real::highest());
    EXPECT_EQ(opaque(Real::lowest()) / -1, Real::highest());
    EXPECT_EQ(rsqrt(opaque(Real(0))), Real::highest());
}

TEST(Checked, TwoLimbsTrapLikeTheNativeType) {
    const TwoLimb high(std::numeric_limits<std::int64_t>::max(), ~std::uint64_t{0});
    const TwoLimb low(std::numeric_limits<std::int64_t>::min(), 0);
    EXPECT_DEATH((void)raw_add(high, TwoLimb(1)), "fixed-point overflow: add");
    EXPECT_DEATH((void)raw_add(low, TwoLimb(-1)), "fixed-point overflow: add");
    EXPECT_DEATH((void)raw_subtract(low, TwoLimb(1)), "fixed-point overflow: subtract");
    EXPECT_DEATH((void)raw_shift_left(high, 1), "fixed-point overflow: shift left");
    EXPECT_DEATH((void)raw_narrow<std::int64_t>(TwoLimb(1, 0)), "fixed-point overflow: narrow");
    EXPECT_EQ(raw_add(high, low), TwoLimb(-1));
}

} // namespace
} // namespace lockwind
