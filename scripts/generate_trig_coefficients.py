#!/usr/bin/env python3
"""Writes sim-core/src/math/trig_coefficients.h: the polynomials of sincos and atan2.

Each is the interpolation of a smooth even function at Chebyshev nodes, in 60 decimal digits, with its
coefficients then rounded to fixed point. The error bounds in the header are measured on a dense grid,
with the rounded coefficients.

    scripts/generate_trig_coefficients.py           write the header
    scripts/generate_trig_coefficients.py --check   exit 1 if the header is not what would be written
"""

import sys
from decimal import Decimal, getcontext
from pathlib import Path

getcontext().prec = 60
HEADER = Path(__file__).resolve().parent.parent / "sim-core/src/math/trig_coefficients.h"
GRID = 2000


def arctangent(x):
    """Euler's series after two halvings of the angle."""
    for _ in range(2):
        x = x / (1 + (1 + x * x).sqrt())
    total, power, k = Decimal(0), x, 0
    while abs(power) > Decimal(10) ** -58:
        total += power / (2 * k + 1)
        power *= -x * x
        k += 1
    return 4 * total


PI = 4 * arctangent(Decimal(1))


def series(x2, first):
    """Sum of (-x2)^k first / ((d + 1)(d + 2) ...): cos for d = 0, sin(x)/x for d = 1."""
    total, term, k = Decimal(0), Decimal(1), first
    while abs(term) > Decimal(10) ** -58:
        total += term
        term *= -x2 / ((k + 1) * (k + 2))
        k += 2
    return total


def sine(w):
    """sin(pi/2 z) / z, w = z^2."""
    return PI / 2 * series(w * PI * PI / 4, 1)


def cosine(w):
    """cos(pi/2 z), w = z^2."""
    return series(w * PI * PI / 4, 0)


def arctangent_turns(w):
    """atan(t) / t in turns, w = t^2."""
    t = w.sqrt()
    ratio = arctangent(t) / t if t > Decimal(10) ** -20 else Decimal(1)
    return ratio / (2 * PI)


def interpolate(function, high, count):
    """Monomial coefficients of the interpolation on [0, high] at `count` Chebyshev nodes."""
    half = high / 2
    nodes = []
    for i in range(count):
        angle = PI * (2 * i + 1) / (2 * count)
        nodes.append(half + half * series(angle * angle, 0))
    divided = [function(x) for x in nodes]
    for level in range(1, count):
        for i in range(count - 1, level - 1, -1):
            divided[i] = (divided[i] - divided[i - 1]) / (nodes[i] - nodes[i - level])
    polynomial = [divided[-1]]
    for k in range(count - 2, -1, -1):
        shifted = [Decimal(0)] + polynomial
        for i, coefficient in enumerate(polynomial):
            shifted[i] -= coefficient * nodes[k]
        shifted[0] += divided[k]
        polynomial = shifted
    return polynomial


def worst(function, coefficients, scale, high, odd):
    """Largest error on the grid, of the function itself (times z for an odd one)."""
    largest = Decimal(0)
    for i in range(GRID + 1):
        z = high.sqrt() * i / GRID
        value = Decimal(0)
        for coefficient in reversed(coefficients):
            value = value * z * z + coefficient / scale
        error = abs(value - function(z * z)) * (z if odd else 1)
        largest = max(largest, error)
    return largest


def table(name, comment, function, high, count, fraction_bits, odd):
    scale = Decimal(2) ** fraction_bits
    polynomial = interpolate(function, high, count)
    coefficients = [(c * scale).to_integral_value() for c in polynomial]
    error = worst(function, coefficients, scale, high, odd)
    lines = [f"/// {comment}", f"/// |error| <= {error:.1e}{' turns' if fraction_bits == 64 else ''}."]
    lines.append(f"inline constexpr std::array<std::int64_t, {count}> {name}{{")
    lines += [f"    {int(c)}," for c in coefficients]
    return lines + ["};", ""]


def header():
    tangent = Decimal(2).sqrt() - 1  # tan(pi / 8)
    lines = [
        "#pragma once",
        "",
        "// Written by scripts/generate_trig_coefficients.py.",
        "",
        "#include <array>",
        "#include <cstdint>",
        "",
        "namespace lockwind {",
        "",
    ]
    lines += table("kSineCoefficients", "sin(pi/2 z) / z in z^2, |z| <= 1/2; Q1.62.",
                   sine, Decimal("0.25"), 6, 62, True)
    lines += table("kCosineCoefficients", "cos(pi/2 z) in z^2, |z| <= 1/2; Q1.62.",
                   cosine, Decimal("0.25"), 6, 62, False)
    lines += table("kArctangentCoefficients",
                   "atan(t) / t in turns, in t^2, 0 <= t <= tan(pi/8); Q-1.64.",
                   arctangent_turns, tangent * tangent, 8, 64, True)
    lines += [
        "/// tan(pi/8), Q0.64.",
        "inline constexpr std::uint64_t kTangentEighth = "
        f"{int((tangent * Decimal(2) ** 64).to_integral_value())}U;",
        "",
        "/// 1 / (2 pi), Q-2.66: turns in a radian.",
        "inline constexpr std::uint64_t kTurnsPerRadian = "
        f"{int((Decimal(2) ** 66 / (2 * PI)).to_integral_value())}U;",
        "",
        "/// 2 pi, Q3.61: radians in a turn.",
        "inline constexpr std::uint64_t kRadiansPerTurn = "
        f"{int((2 * PI * Decimal(2) ** 61).to_integral_value())}U;",
        "",
        "} // namespace lockwind",
        "",
    ]
    return "\n".join(lines)


def main():
    text = header()
    if "--check" in sys.argv[1:]:
        if HEADER.read_text() != text:
            sys.exit(f"{HEADER} differs from what its generator writes: run {sys.argv[0]}")
        return
    HEADER.write_text(text)


if __name__ == "__main__":
    main()
