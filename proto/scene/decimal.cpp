#include "scene/decimal.h"

#include <bit>

namespace lockwind {

std::optional<Real> to_real(double value) {
    constexpr int kMantissaBits = 52;
    constexpr std::uint64_t kMantissaMask = (1ULL << kMantissaBits) - 1;
    constexpr int kExponentBias = 1023;

    const auto bits = std::bit_cast<std::uint64_t>(value);
    const bool negative = (bits >> 63U) != 0;
    const int exponent = static_cast<int>((bits >> kMantissaBits) & 0x7ffU);
    if (exponent >= kExponentBias + 31) {
        return std::nullopt;
    }
    if (exponent == 0) {
        return Real(0); // zero and the subnormals, all far below 2^-33
    }
    // |value| = mantissa * 2^(exponent - bias - 52), so |raw| = mantissa * 2^shift.
    const std::uint64_t mantissa = (bits & kMantissaMask) | (1ULL << kMantissaBits);
    const int shift = exponent - kExponentBias - kMantissaBits + Real::kFraction;
    std::uint64_t magnitude = 0;
    if (shift >= 0) {
        magnitude = mantissa << static_cast<unsigned>(shift);
    } else if (shift >= -kMantissaBits - 1) {
        // A half goes up, so that of a negative value's magnitude down.
        const auto drop = static_cast<unsigned>(-shift);
        magnitude = (mantissa + (1ULL << (drop - 1)) - (negative ? 1 : 0)) >> drop;
    }
    const auto raw = static_cast<std::int64_t>(magnitude);
    return Real::from_raw(negative ? -raw : raw);
}

} // namespace lockwind
