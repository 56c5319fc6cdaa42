#include "tests/unit/math/support.h"

#include "lockwind/trig.h"

#include <array>
#include <gtest/gtest.h>

namespace lockwind {
namespace {

TEST(Angle, WrapsExactly) {
    const Angle third = Angle::from_raw(0x5555555555555555U);
    EXPECT_EQ(third * 3 + Angle::from_raw(1), Angle{});
    EXPECT_EQ(Angle::from_turns(7.25), Angle::from_turns(0.25));
    EXPECT_EQ(Angle::from_turns(-0.75), Angle::from_turns(0.25));
    EXPECT_EQ(Angle::from_turns(0.5), -Angle::from_turns(0.5));
    EXPECT_EQ(Angle::from_turns(0.75).turns(), Real(-0.25));
    EXPECT_EQ(Angle::from_turns(0.5).turns(), Real(-0.5));
    Angle angle;
    for (int i = 0; i < 1000; ++i) {
        angle += Angle::from_turns(0.123);
    }
    for (int i = 0; i < 1000; ++i) {
        angle -= Angle::from_turns(0.123);
    }
    EXPECT_EQ(angle, Angle{});
}

TEST(Angle, RadiansRoundTrip) {
    EXPECT_EQ(Angle::from_turns(0.25).radians().raw(), 6746518852); // pi / 2 x 2^32 = ...852.26
    EXPECT_EQ(Angle::from_turns(-0.25).radians().raw(), -6746518852);
    EXPECT_EQ(Angle::from_turns(0.5).radians().raw(), -13493037705); // -pi x 2^32 = ...704.52
    EXPECT_EQ(kPi.raw(), 13493037705);
    Draws draws(51);
    for (int i = 0; i < 20000; ++i) {
        const Real radians = draws.real(33); // |radians| < 2 < pi
        ASSERT_EQ(Angle::from_radians(radians).radians(), radians);
        ASSERT_EQ(Angle::from_radians(-radians), -Angle::from_radians(radians));
    }
}

TEST(SinCos, QuarterTurnsAreExact) {
    struct Quadrant {
        std::uint64_t quarter;
        int sin, cos;
    };
    for (const Quadrant& q :
         {Quadrant{0, 0, 1}, Quadrant{1, 1, 0}, Quadrant{2, 0, -1}, Quadrant{3, -1, 0}}) {
        const Angle angle = Angle::from_raw(q.quarter << 62U);
        EXPECT_EQ(sin(angle), q.sin);
        EXPECT_EQ(cos(angle), q.cos);
        EXPECT_EQ(sincos<Unit>(angle).sin, q.sin);
        EXPECT_EQ(sincos<Unit>(angle).cos, q.cos);
    }
}

TEST(SinCos, HasPublishedValues) {
    // sin 30, 45, 60 degrees x 2^32, rounded.
    EXPECT_EQ(sin(Angle::from_raw(~std::uint64_t{0} / 12)).raw(), 2147483648);
    EXPECT_EQ(sin(Angle::from_turns(0.125)).raw(), 3037000500);
    EXPECT_EQ(cos(Angle::from_turns(0.125)).raw(), 3037000500);
    EXPECT_EQ(sin(Angle::from_raw(~std::uint64_t{0} / 6)).raw(), 3719550787);
    EXPECT_EQ(sin(Real(1)).raw(), 3614090360);
    EXPECT_EQ(cos(Real(1)).raw(), 2320580734);
}

TEST(SinCos, SymmetriesHoldToTheBit) {
    Draws draws(52);
    const Angle half = Angle::from_turns(0.5);
    for (int i = 0; i < 50000; ++i) {
        const Angle angle = Angle::from_raw(draws.bits() >> (draws.bits() % 64));
        ASSERT_EQ(sin(-angle), -sin(angle)) << angle.raw();
        ASSERT_EQ(cos(-angle), cos(angle)) << angle.raw();
        ASSERT_LE(abs(sin(half - angle) - sin(angle)).raw(), 1);
        ASSERT_LE(abs(cos(half - angle) + cos(angle)).raw(), 1);
        ASSERT_LE(abs(sin(angle)), 1);
        ASSERT_LE(abs(cos(angle)), 1);
    }
}

TEST(SinCos, StayOnTheUnitCircle) {
    Draws draws(53);
    for (int i = 0; i < 50000; ++i) {
        const SinCos<Real> circle = sincos(Angle::from_raw(draws.bits()));
        const Real square =
            round_to<Real>(product(circle.sin, circle.sin) + product(circle.cos, circle.cos));
        ASSERT_LE(abs(square - 1).raw(), 2);
    }
}

TEST(SinCos, HasNoStepWhereQuadrantsMeet) {
    for (std::uint64_t eighth = 0; eighth < 8; ++eighth) {
        const std::uint64_t edge = eighth << 61U;
        const SinCos<Real> before = sincos(Angle::from_raw(edge - 1));
        const SinCos<Real> after = sincos(Angle::from_raw(edge));
        EXPECT_LE(abs(before.sin - after.sin).raw(), 1) << eighth;
        EXPECT_LE(abs(before.cos - after.cos).raw(), 1) << eighth;
    }
}

TEST(Atan2, AxesAndDiagonalsAreExact) {
    struct Direction {
        int y, x;
        std::uint64_t eighth;
    };
    for (const Direction& d : {Direction{0, 1, 0},
                               Direction{1, 1, 1},
                               Direction{1, 0, 2},
                               Direction{1, -1, 3},
                               Direction{0, -1, 4},
                               Direction{-1, -1, 5},
                               Direction{-1, 0, 6},
                               Direction{-1, 1, 7}}) {
        EXPECT_EQ(atan2_angle(d.y, d.x), Angle::from_raw(d.eighth << 61U)) << d.y << ' ' << d.x;
        // And at both ends of the scale.
        EXPECT_EQ(atan2_angle(d.y * Real::ulp(), d.x * Real::ulp()),
                  Angle::from_raw(d.eighth << 61U));
        EXPECT_EQ(atan2_angle(d.y * Real::highest(), d.x * Real::highest()),
                  Angle::from_raw(d.eighth << 61U));
    }
    EXPECT_EQ(atan2_angle(0, 0), Angle{});
    EXPECT_EQ(atan2_angle(Real::lowest(), Real::lowest()), Angle::from_turns(-0.375));
}

TEST(Atan2, RadiansFollowTheUsualConvention) {
    EXPECT_EQ(atan2(Real(0), Real(-1)), kPi);
    EXPECT_EQ(atan2(Real(-1), Real(0)).raw(), -6746518852);
    EXPECT_EQ(atan2(Real(1), Real(2)).raw(), 1991351318); // 0.46364760900...
    EXPECT_EQ(acos(Real(-1)), kPi);
    EXPECT_EQ(acos(Real(1)), 0);
    EXPECT_EQ(acos(Real(2)), 0);
    EXPECT_EQ(asin(Real(1)).raw(), 6746518852);
    EXPECT_LE(abs(asin(Real(0.5)) - kPi / 6).raw(), 1);
    EXPECT_LE(abs(acos(Real(-0.5)) - kPi * 2 / 3).raw(), 2);
}

TEST(Atan2, InvertsSinCos) {
    Draws draws(54);
    for (int i = 0; i < 20000; ++i) {
        const Angle angle = Angle::from_raw(draws.bits());
        const SinCos<Real> circle = sincos(angle);
        const Angle difference = atan2_angle(circle.sin, circle.cos) - angle;
        // The point is known to 2^-33 per coordinate: 2^-35 turns.
        ASSERT_LE(abs(difference.turns()).raw(), 1);
    }
}

TEST(Atan2, MirrorsHoldToTheBit) {
    Draws draws(55);
    const Angle half = Angle::from_turns(0.5);
    const Angle quarter = Angle::from_turns(0.25);
    for (int i = 0; i < 20000; ++i) {
        const Real x = Real::from_raw(draws.any_signed() | 1);
        const Real y = Real::from_raw(draws.any_signed() | 1);
        const Angle angle = atan2_angle(y, x);
        ASSERT_EQ(atan2_angle(-y, x), -angle);
        ASSERT_EQ(atan2_angle(y, -x), half - angle);
        ASSERT_EQ(atan2_angle(x, y), quarter - angle);
    }
}

} // namespace
} // namespace lockwind
