#pragma once

// Written by scripts/generate_trig_coefficients.py.

#include <array>
#include <cstdint>

namespace lockwind {

/// sin(pi/2 z) / z in z^2, |z| <= 1/2; Q1.62.
/// |error| <= 3.4e-15.
inline constexpr std::array<std::int64_t, 6> kSineCoefficients{
    7244019458077091824,
    -2978983596866688075,
    367517369814214747,
    -21590772967764010,
    739849398554406,
    -16400936794620,
};

/// cos(pi/2 z) in z^2, |z| <= 1/2; Q1.62.
/// |error| <= 5.6e-14.
inline constexpr std::array<std::int64_t, 6> kCosineCoefficients{
    4611686018427131542,
    -5689439577915315218,
    1169844119442104450,
    -96215763681858813,
    4238885330983997,
    -114604840261680,
};

/// atan(t) / t in turns, in t^2, 0 <= t <= tan(pi/8).
/// |error| <= 4.3e-14 turns.
inline constexpr std::array<std::int64_t, 8> kArctangentCoefficients{
    2935890503279783929,
    -978630166104506546,
    587177896716405061,
    -419403307188733014,
    325985336925797806,
    -264011506774294222,
    204754807560863416,
    -110551268143391256,
};

/// tan(pi/8), Q0.64.
inline constexpr std::uint64_t kTangentEighth = 7640891576956012809U;

/// 1 / (2 pi), Q-2.66: turns in a radian.
inline constexpr std::uint64_t kTurnsPerRadian = 11743562013128004906U;

/// 2 pi, Q3.61: radians in a turn.
inline constexpr std::uint64_t kRadiansPerTurn = 14488038916154245685U;

} // namespace lockwind
