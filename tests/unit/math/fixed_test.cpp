#include "math/integer.h"
#include "tests/unit/math/support.h"

#include "lockwind/fixed.h"
#include "lockwind/vector.h"

#include <gtest/gtest.h>
#include <limits>
#include <type_traits>

namespace lockwind {
namespace {

static_assert(std::is_trivially_copyable_v<Real> && std::is_standard_layout_v<Real>);
static_assert(sizeof(Real) == 8 && sizeof(Unit) == 4);
static_assert(!std::is_convertible_v<Unit, Real> && !std::is_convertible_v<Real, Unit>);

TEST(Fixed, IntegersAndExactLiteralsConvertExactly) {
    EXPECT_EQ(Real(-3).raw(), -3 * (std::int64_t{1} << 32));
    EXPECT_EQ(Real(3U).raw(), 3 * (std::int64_t{1} << 32));
    EXPECT_EQ(Real(std::uint64_t{2147483647}).raw(), 2147483647 * (std::int64_t{1} << 32));
    EXPECT_EQ(Real(-2147483647 - 1), Real::lowest());
    EXPECT_EQ(Real(0.5).raw(), std::int64_t{1} << 31);
    EXPECT_EQ(Unit(-2), Unit::lowest());
    EXPECT_EQ(Unit(-0.5).raw(), -(1 << 29));
    EXPECT_EQ(Real{}, Real(0));
}

TEST(Fixed, AddsSubtractsNegatesExactly) {
    Draws draws(21);
    for (int i = 0; i < 10000; ++i) {
        const Real a = draws.real(61);
        const Real b = draws.real(61);
        ASSERT_EQ((a + b).raw(), a.raw() + b.raw());
        ASSERT_EQ((a - b).raw(), a.raw() - b.raw());
        ASSERT_EQ((-a).raw(), -a.raw());
        Real c = a;
        c += b;
        c -= a;
        ASSERT_EQ(c, b);
    }
}

TEST(Fixed, ComparesLikeItsRaw) {
    EXPECT_LT(Real(-1), Real(1));
    EXPECT_GT(Real::ulp(), 0);
    EXPECT_LE(Real(2), 2);
    EXPECT_EQ(abs(Real(-2.5)), Real(2.5));
    EXPECT_EQ(abs(Real(2.5)), Real(2.5));
}

TEST(Fixed, CompoundAssignmentsAreTheOperators) {
    Real a = 7;
    a *= Real(1.5);
    EXPECT_EQ(a, Real(10.5));
    a /= 2;
    EXPECT_EQ(a, Real(5.25));
}

#if LOCKWIND_HAS_INT128

TEST(Fixed, ProductIsTheExactOneRoundedHalfUp) {
    Draws draws(22);
    for (int i = 0; i < 100000; ++i) {
        const std::int64_t a = draws.any_signed(47);
        const std::int64_t b = draws.any_signed(47);
        const NativeInt128 half = NativeInt128(1) << 31;
        const NativeInt128 expected = (static_cast<NativeInt128>(a) * b + half) >> 32;
        ASSERT_TRUE((Real::from_raw(a) * Real::from_raw(b)).raw() == expected) << a << ' ' << b;
    }
}

NativeInt128 clamp_to_int64(NativeInt128 value) {
    const NativeInt128 high = std::numeric_limits<std::int64_t>::max();
    const NativeInt128 low = std::numeric_limits<std::int64_t>::min();
    return value > high ? high : (value < low ? low : value);
}

template <class Format>
void expect_exact_quotients(std::uint64_t seed) {
    Draws draws(seed);
    for (int i = 0; i < 100000; ++i) {
        const auto a = static_cast<typename Format::raw_type>(draws.any_signed());
        const auto b = static_cast<typename Format::raw_type>(draws.any_signed());
        if (b == 0) {
            continue;
        }
        const NativeInt128 exact =
            static_cast<NativeInt128>(a) * (NativeInt128(1) << Format::kFraction) / b;
        const NativeInt128 limited = sizeof(a) == 8 ? clamp_to_int64(exact)
                                     : exact > std::numeric_limits<std::int32_t>::max()
                                         ? std::numeric_limits<std::int32_t>::max()
                                     : exact < std::numeric_limits<std::int32_t>::min()
                                         ? std::numeric_limits<std::int32_t>::min()
                                         : exact;
        ASSERT_TRUE((Format::from_raw(a) / Format::from_raw(b)).raw() == limited)
            << a << " / " << b;
    }
}

TEST(Fixed, QuotientIsTheExactOneTruncated) {
    expect_exact_quotients<Real>(23);
    expect_exact_quotients<InverseMass>(24);
    expect_exact_quotients<Velocity>(25);
    expect_exact_quotients<Unit>(26);
}

TEST(Fixed, QuotientBetweenFormatsIsTheExactOneTruncated) {
    Draws draws(27);
    for (int i = 0; i < 100000; ++i) {
        const std::int64_t a = draws.any_signed(60);
        const std::int64_t b = draws.any_signed(40) | 1;
        const NativeInt128 exact = static_cast<NativeInt128>(a) * (NativeInt128(1) << 40) / b;
        ASSERT_TRUE(divide_to<InverseMass>(Real::from_raw(a), Real::from_raw(b)).raw() ==
                    clamp_to_int64(exact));
    }
}

template <class Format>
void expect_exact_roots(std::uint64_t seed) {
    constexpr int kFraction = Format::kFraction;
    Draws draws(seed);
    for (int i = 0; i < 100000; ++i) {
        const std::uint64_t raw = draws.any(sizeof(typename Format::raw_type) == 8 ? 63 : 31);
        if (raw == 0) {
            continue;
        }
        const auto value = Format::from_raw(static_cast<typename Format::raw_type>(raw));
        const auto square = static_cast<NativeUInt128>(raw) << static_cast<unsigned>(kFraction);
        const auto root = static_cast<NativeUInt128>(sqrt(value).raw());
        ASSERT_TRUE(root * root <= square && (root + 1) * (root + 1) > square) << raw;
        // r = floor(2^(3F/2) / sqrt(raw)), so r^2 raw <= 2^3F < (r + 1)^2 raw: by the floor of
        // 2^3F/raw.
        const auto inverse = static_cast<NativeUInt128>(rsqrt(value).raw());
        const NativeUInt128 bound =
            (NativeUInt128(1) << static_cast<unsigned>(3 * kFraction)) / raw;
        const bool saturated = rsqrt(value) == Format::highest();
        ASSERT_TRUE(inverse * inverse <= bound) << raw;
        ASSERT_TRUE(saturated || (inverse + 1) * (inverse + 1) > bound) << raw;
    }
}

TEST(Fixed, RootsAreTheExactOnesFloored) {
    expect_exact_roots<Real>(28);
    expect_exact_roots<Velocity>(29);
    expect_exact_roots<Unit>(30);
    expect_exact_roots<InverseMass>(31);
}

#endif

TEST(Fixed, DivisionSaturatesInsteadOfWrapping) {
    EXPECT_EQ(Real::highest() / Real(0.5), Real::highest());
    EXPECT_EQ(Real::highest() / Real(-0.5), Real::lowest());
    EXPECT_EQ(Real::lowest() / -1, Real::highest());
    EXPECT_EQ(Real::lowest() / 1, Real::lowest());
    EXPECT_EQ(Real(1) / 0, Real::highest());
    EXPECT_EQ(Real(-1) / 0, Real::lowest());
    EXPECT_EQ(Real(0) / 0, 0);
    EXPECT_EQ(Unit(1) / Unit(0.25), Unit::highest());
    EXPECT_EQ(Unit(-1) / Unit(0.25), Unit::lowest());
    EXPECT_EQ(Unit(1) / 0, Unit::highest());
    EXPECT_EQ(Unit(-1) / Unit(0.5), Unit(-2));
}

TEST(Fixed, RootsOfTheNonPositiveAreDocumentedValues) {
    EXPECT_EQ(sqrt(Real(-4)), 0);
    EXPECT_EQ(sqrt(Real(0)), 0);
    EXPECT_EQ(rsqrt(Real(0)), Real::highest());
    EXPECT_EQ(rsqrt(Real(-1)), Real::highest());
    EXPECT_EQ(rsqrt(InverseMass::ulp()), InverseMass(1 << 20));
    EXPECT_EQ(rsqrt(Unit::ulp()), Unit::highest());
}

TEST(Fixed, InverseMassNeverQuantisesToZero) {
    // A dynamic body whose inverse mass is 0 would turn static.
    EXPECT_GT(divide_to<InverseMass>(Real(1), Real::highest()).raw(), 500);
    EXPECT_EQ(divide_to<InverseMass>(Real(1), Real(10000)).raw(), 109951162);
    EXPECT_EQ(divide_to<InverseMass>(Real(1), Real(0.01)).raw() >> 40, 99); // 0.01 rounds up
    // In Velocity's format, for comparison, it does from 2^20 kg on.
    EXPECT_EQ(divide_to<Velocity>(Real(1), Real(1 << 21)), 0);
}

TEST(Convert, RoundTripsFromNarrowToWide) {
    Draws draws(32);
    for (int i = 0; i < 10000; ++i) {
        const auto length = Length::from_raw(static_cast<std::int32_t>(draws.any_signed(31)));
        ASSERT_EQ(convert<Length>(convert<Real>(length)), length);
        ASSERT_EQ(convert_saturated<Length>(convert_saturated<Real>(length)), length);
    }
}

TEST(Convert, SaturatesForWritesToTheState) {
    EXPECT_EQ(convert_saturated<Velocity>(Real(5000)), Velocity::highest());
    EXPECT_EQ(convert_saturated<Velocity>(Real(-5000)), Velocity::lowest());
    EXPECT_EQ(convert_saturated<InverseMass>(Real::highest()), InverseMass::highest());
    EXPECT_EQ(convert_saturated<InverseMass>(Real::lowest()), InverseMass::lowest());
    EXPECT_EQ(convert_saturated<Velocity>(Real(-1.5)), Velocity(-1.5));
}

TEST(Wide, SumsProductsExactly) {
    const auto sum = product(Unit(-2), Unit(-2)) - product(Unit::ulp(), Unit::ulp());
    static_assert(std::is_same_v<decltype(sum), const Wide<60, std::int64_t>>);
    EXPECT_EQ(sum.raw(), (std::int64_t{1} << 62) - 1);
    auto total = product(Real::lowest(), Real::lowest()); // 2^126
    total -= product(Real::ulp(), Real::ulp());
    static_assert(std::is_same_v<decltype(total), Wide<64>>);
    EXPECT_EQ(low_limb(total.raw()), ~std::uint64_t{0});
    EXPECT_LT(total, product(Real::lowest(), Real::lowest()));
    EXPECT_EQ(-(-total), total);
}

TEST(Wide, ProductsOfMixedFormatsKeepTheirScale) {
    EXPECT_EQ(round_to<Velocity>(product(Velocity(3), Coefficient(-0.5))), Velocity(-1.5));
    EXPECT_EQ(round_to<Real>(product(Real(1000000), Unit(0.25))), Real(250000));
    EXPECT_EQ(round_to<Real>(product(InverseMass(0.5), Real(3))), Real(1.5));
}

TEST(Wide, WidenAddsATermAtTheSumsScale) {
    using Sum = Wide<64>;
    const Sum sum = widen<Sum>(Real(-5)) + product(Real(2), Real(3));
    EXPECT_EQ(round_to<Real>(sum), Real(1));
    EXPECT_EQ(round_to<Real>(widen<Sum>(Real::lowest())), Real::lowest());
}

TEST(Wide, SumOf64By32ProductsHoldsLargeCoefficients) {
    // 16 products of 8 x 2^31: an int64 accumulator of such products would have wrapped.
    auto sum = product(Real::highest(), Coefficient::lowest());
    for (int i = 1; i < 16; ++i) {
        sum += product(Real::highest(), Coefficient::lowest());
    }
    EXPECT_EQ(saturate_to<Real>(sum), Real::lowest());
    for (int i = 0; i < 16; ++i) {
        sum -= product(Real::highest(), Coefficient::lowest());
    }
    EXPECT_EQ(round_to<Real>(sum), 0);
}

TEST(Wide, SeparationBiasClampsInsteadOfWrapping) {
    // 8.6 m x 240 / s leaves Q11.20 (2048 m/s) and would come back negative.
    const auto bias = product(Length(8.6), Velocity(240));
    EXPECT_EQ(saturate_to<Velocity>(bias), Velocity::highest());
    EXPECT_EQ(saturate_to<Velocity>(-bias), Velocity::lowest());
    EXPECT_EQ(saturate_to<Velocity>(product(Length(4), Velocity(240))), Velocity(960));
}

TEST(Wide, KineticEnergyOfTenTonsKeepsItsValueAbove655MetresPerSecond) {
    // 1/2 10 t (700 m/s)^2 = 2.45 GJ does not fit a Real, its wide product does.
    const Real speed = 700;
    const auto energy = product(Real(5000), speed * speed);
    EXPECT_EQ(energy, widen<Wide<64>>(Real(1 << 30)) + widen<Wide<64>>(Real(1376258176)));
    EXPECT_EQ(saturate_to<Real>(energy), Real::highest());
}

TEST(Wide, RotationAnglesNeedTheWideProduct) {
    // 40 rad/s x 1/60 s in Q31.32 squares: 2^64 x 2/3 does not fit int64.
    const std::int64_t speed = Real(40).raw();
    const std::int64_t tick = (Real(1) / 60).raw();
    EXPECT_EQ(multiply_shift_wide(speed, tick, 32), 2863311520);
    EXPECT_EQ((Real(40) * (Real(1) / 60)).raw(), 2863311520);
}

TEST(Wide, GyroscopicTermOfALargeBodyDividesLast) {
    // (I_z - I_y) w_y w_z / I_x with I = 10^6 kg m^2, w = 100 rad/s: 10^10 on the way, 5000 at the
    // end.
    const std::int64_t inertia = Real(1000000).raw();
    const std::int64_t rates = (Real(100) * Real(100)).raw();
    EXPECT_EQ(multiply_divide(inertia, rates, 2 * inertia), Real(5000).raw());
}

} // namespace
} // namespace lockwind
