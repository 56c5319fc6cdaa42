#pragma once

#include "dynamics/solver_format.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"

#include <algorithm>
#include <cstdint>
#include <limits>

/// Unrolls the next loop, of at most 16 rounds: g++ -O2 would leave it be, at half the speed.
#define LOCKWIND_UNROLL _Pragma("GCC unroll 16")

namespace lockwind {

/// Contacts in a block; the widest lanes there are.
inline constexpr int kBlockLanes = 8;

/// Scales (first, second) back to length `limit` where it is longer: Coulomb's cone, exactly.
inline void clamp_to_cone(std::int32_t& first, std::int32_t& second, std::int32_t limit) {
    // So that the sum of the squares is below 2^63.
    first = std::max(first, -std::numeric_limits<std::int32_t>::max());
    second = std::max(second, -std::numeric_limits<std::int32_t>::max());
    const auto square = [](std::int32_t value) {
        return static_cast<std::uint64_t>(std::int64_t{value} * value);
    };
    const std::uint64_t length_2 = square(first) + square(second);
    if (length_2 <= square(limit)) {
        return;
    }
    const auto length = static_cast<std::int64_t>(floor_sqrt(length_2));
    const std::int64_t scale = (std::int64_t{limit} << kCoefficientFraction) / length;
    first = static_cast<std::int32_t>(round_shift(first * scale, kCoefficientFraction));
    second = static_cast<std::int32_t>(round_shift(second * scale, kCoefficientFraction));
}

/// Where a half between two units of a velocity goes. Bodies of equal masses share every other
/// impulse in halves: if all went up, what lies still would creep down by a fraction of a unit in
/// each substep, and no friction would notice. So they take turns.
enum class Halves : std::int64_t { up = 0, down = 1 };

/// The solver's kernels are templates over lanes: a vector of int32 and one of the int64 sums of
/// their products. This is the scalar one and the oracle: WideLanes has the same members and gives
/// the same bits, because every operation is exact integer arithmetic.
struct ScalarLanes {
    static constexpr int kWidth = 1;
    using Vector = std::int32_t;
    using Wide = std::int64_t;

    /// A vector that only multiplies.
    struct Factor {
        Vector value;
    };

    static Vector load(const std::int32_t* from) { return *from; }
    static Factor load_factor(const std::int32_t* from) { return {*from}; }
    static void store(std::int32_t* to, Vector value) { *to = value; }
    static Vector set(std::int32_t value) { return value; }
    /// The four values at source(lane) of each lane from `first`: out[i] has the lanes' i-th ones.
    template <class Source>
    static void gather_quad(int first, Source&& source, Vector* out) {
        std::copy_n(source(first), 4, out);
    }
    /// The reverse: the lanes' i-th values are values[i].
    template <class Target>
    static void scatter_quad(int first, const Vector* values, Target&& target) {
        std::int32_t* const to = target(first);
        LOCKWIND_UNROLL
        for (int entry = 0; entry < 4; ++entry) { // one by one: their next reader may want one
            to[entry] = values[entry];
        }
    }

    static Vector add(Vector a, Vector b) { return raw_add(a, b); }
    static Vector subtract(Vector a, Vector b) { return raw_subtract(a, b); }
    static Vector negate(Vector a) { return raw_negate(a); }
    template <int Shift>
    static Vector shift_right(Vector a) {
        return a >> Shift;
    }
    static Vector minimum(Vector a, Vector b) { return a < b ? a : b; }
    static Vector maximum(Vector a, Vector b) { return a > b ? a : b; }
    static Vector clamp(Vector value, Vector low, Vector high) {
        return minimum(maximum(value, low), high);
    }
    /// value > 0 ? positive : other
    static Vector select_positive(Vector value, Vector positive, Vector other) {
        return value > 0 ? positive : other;
    }

    /// Not 0 where `difference` is not, or a and b differ.
    static Vector add_difference(Vector difference, Vector a, Vector b) {
        return difference | (a ^ b);
    }
    static bool is_zero(Vector a) { return a == 0; }

    static Wide zero() { return 0; }
    /// A sum to which products are added, and which round<Shift> turns back into a vector.
    template <int Shift>
    static Wide start(Halves halves = Halves::up) {
        return (std::int64_t{1} << (Shift - 1)) - static_cast<std::int64_t>(halves);
    }
    static Wide add_product(Wide sum, Vector a, Vector b) {
        return raw_add(sum, std::int64_t{a} * b);
    }
    static Wide add_product(Wide sum, Vector a, Factor b) { return add_product(sum, a, b.value); }
    template <int Shift>
    static Vector round(Wide sum) {
        return raw_narrow<std::int32_t>(sum >> Shift);
    }
    /// round(), within +-most.
    template <int Shift>
    static Vector round_within(Wide sum, std::int32_t most) {
        return static_cast<Vector>(std::clamp<Wide>(sum >> Shift, -most, most));
    }
    template <int Shift, class Multiplier>
    static Vector multiply(Vector a, Multiplier b) {
        return round<Shift>(add_product(start<Shift>(), a, b));
    }
    /// floor(2^Power / value), value > 0, exact.
    template <int Power>
    static Vector reciprocal(Vector value) {
        return raw_narrow<std::int32_t>((std::int64_t{1} << Power) / value);
    }
    /// floor(sqrt(sum)), 0 <= sum < 2^52, exact.
    static Vector root(Wide sum) {
        return static_cast<Vector>(floor_sqrt(static_cast<std::uint64_t>(sum)));
    }
    static void clamp_to_cone(Vector& first, Vector& second, Vector limit) {
        lockwind::clamp_to_cone(first, second, limit);
    }
};

} // namespace lockwind
