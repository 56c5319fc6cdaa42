#pragma once

#include <compare>
#include <concepts>
#include <cstdint>
#include <type_traits>

namespace lockwind {

/// A fixed-point number: raw / 2^kFraction in two's complement. Arithmetic wraps (defined); a CHECKED
/// build traps instead. Products and quotients: see multiply and divide in math.
template <class Raw, int FractionBits>
class Fixed {
public:
    using raw_type = Raw;
    static constexpr int kFraction = FractionBits;

    constexpr Fixed() = default;
    /// Integers convert exactly.
    template <class Integer>
        requires std::is_integral_v<Integer>
    constexpr Fixed(Integer value)
        : raw_(static_cast<Raw>(static_cast<std::uint64_t>(value) << FractionBits)) {}
    /// Literals convert at compile time, to the nearest; run-time doubles do not compile.
    consteval Fixed(double value)
        : raw_(static_cast<Raw>(value * static_cast<double>(1ULL << FractionBits) +
                                (value < 0 ? -0.5 : 0.5))) {}

    static constexpr Fixed from_raw(Raw raw) {
        Fixed result;
        result.raw_ = raw;
        return result;
    }
    constexpr Raw raw() const { return raw_; }

    friend constexpr auto operator<=>(Fixed, Fixed) = default;

private:
    Raw raw_ = 0;
};

} // namespace lockwind
