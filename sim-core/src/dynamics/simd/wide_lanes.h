#pragma once

#include "dynamics/lanes.h"

// The file that includes this one is compiled for one instruction set, and Highway's for that one.
#define HWY_COMPILE_ONLY_STATIC
#define HWY_DISABLE_PCLMUL_AES
#include <cstdint>
#include <hwy/highway.h>
#include <limits>

// A namespace of its own for each instruction set: two of them must not share an inline function.
namespace lockwind::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Four or eight lanes of a vector unit; the bits of ScalarLanes.
///
/// A product of int32 fills 64 bits, so a Wide is two vectors: the sums of the even lanes and those
/// of the odd ones.
struct WideLanes {
    using Tag = hn::CappedTag<std::int32_t, kBlockLanes>;
    using SumTag = hn::RepartitionToWide<Tag>;
    using SeedTag = hn::RebindToFloat<SumTag>;

    static constexpr int kWidth = static_cast<int>(hn::MaxLanes(Tag()));
    static_assert(kWidth == 4 || kWidth == 8);

    using Vector = hn::Vec<Tag>;
    struct Wide {
        hn::Vec<SumTag> even;
        hn::Vec<SumTag> odd;
    };
    /// A vector that only multiplies, loaded twice: a load is cheaper than a shuffle. It reads one
    /// value past its lanes.
    struct Factor {
        Vector even;
        Vector odd;
    };

    static Vector load(const std::int32_t* from) { return hn::LoadU(Tag(), from); }
    static Factor load_factor(const std::int32_t* from) {
        return {hn::LoadU(Tag(), from), hn::LoadU(Tag(), from + 1)};
    }
    static void store(std::int32_t* to, Vector value) { hn::StoreU(value, Tag(), to); }
    static Vector set(std::int32_t value) { return hn::Set(Tag(), value); }

    template <class Source>
    static void gather_quad(int first, Source&& source, Vector* out) {
        Vector rows[4];
        LOCKWIND_UNROLL
        for (int row = 0; row < 4; ++row) {
            rows[row] = load_row(Tag(), source, first + row);
        }
        transpose(rows, out);
    }
    template <class Target>
    static void scatter_quad(int first, const Vector* values, Target&& target) {
        Vector rows[4];
        transpose(values, rows);
        LOCKWIND_UNROLL
        for (int row = 0; row < 4; ++row) {
            store_row(Tag(), rows[row], target, first + row);
        }
    }

    static Vector add(Vector a, Vector b) { return hn::Add(a, b); }
    static Vector subtract(Vector a, Vector b) { return hn::Sub(a, b); }
    static Vector negate(Vector a) { return hn::Sub(hn::Zero(Tag()), a); }
    template <int Shift>
    static Vector shift_right(Vector a) {
        return hn::ShiftRight<Shift>(a);
    }
    static Vector minimum(Vector a, Vector b) { return hn::Min(a, b); }
    static Vector maximum(Vector a, Vector b) { return hn::Max(a, b); }
    static Vector clamp(Vector value, Vector low, Vector high) {
        return minimum(maximum(value, low), high);
    }
    static Vector select_positive(Vector value, Vector positive, Vector other) {
        return hn::IfThenElse(hn::Gt(value, hn::Zero(Tag())), positive, other);
    }

    static Vector add_difference(Vector difference, Vector a, Vector b) {
        return hn::Or(difference, hn::Xor(a, b));
    }
    static bool is_zero(Vector a) { return hn::AllTrue(Tag(), hn::Eq(a, hn::Zero(Tag()))); }

    static Wide zero() { return {hn::Zero(SumTag()), hn::Zero(SumTag())}; }
    template <int Shift>
    static Wide start(Halves halves = Halves::up) {
        const auto half =
            hn::Set(SumTag(), (std::int64_t{1} << (Shift - 1)) - static_cast<std::int64_t>(halves));
        return {half, half};
    }
    static Wide add_product(const Wide& sum, Vector a, Vector b) {
        return {hn::Add(sum.even, hn::MulEven(a, b)),
                hn::Add(sum.odd, hn::MulEven(odd_lanes(a), odd_lanes(b)))};
    }
    static Wide add_product(const Wide& sum, Vector a, const Factor& b) {
        return {hn::Add(sum.even, hn::MulEven(a, b.even)),
                hn::Add(sum.odd, hn::MulEven(odd_lanes(a), b.odd))};
    }
    template <int Shift>
    static Vector round(const Wide& sum) {
        // The low 32 bits of the shifted sums, whichever way the bits above them would be filled.
        static_assert(Shift > 0 && Shift <= 32);
        const hn::RebindToUnsigned<SumTag> bits;
        const auto even = hn::ShiftRight<Shift>(hn::BitCast(bits, sum.even));
        const auto odd = [&] {
            if constexpr (Shift == 32) {
                return hn::BitCast(bits, sum.odd);
            } else {
                return hn::ShiftLeft<32 - Shift>(hn::BitCast(bits, sum.odd));
            }
        }();
        return hn::OddEven(hn::BitCast(Tag(), odd), hn::BitCast(Tag(), even));
    }
    template <int Shift>
    static Vector round_within(const Wide& sum, std::int32_t most) {
        const Sum high = hn::Set(SumTag(), std::int64_t{most} << Shift);
        const Sum low = hn::Neg(high);
        return round<Shift>(
            {hn::Min(hn::Max(sum.even, low), high), hn::Min(hn::Max(sum.odd, low), high)});
    }
    template <int Shift, class Multiplier>
    static Vector multiply(Vector a, const Multiplier& b) {
        return round<Shift>(add_product(start<Shift>(), a, b));
    }

    template <int Power>
    static Vector reciprocal(Vector value) {
        const Sum whole = hn::Set(SumTag(), std::int64_t{1} << Power);
        return interleave(floor_quotient(whole, even_part(value)),
                          floor_quotient(whole, odd_part(value)));
    }
    static Vector root(const Wide& sum) {
        return interleave(floor_root(sum.even), floor_root(sum.odd));
    }

    [[gnu::always_inline]] static void clamp_to_cone(Vector& first, Vector& second, Vector limit) {
        const Vector least = set(-std::numeric_limits<std::int32_t>::max());
        first = maximum(first, least);
        second = maximum(second, least);
        const Wide square = add_product(add_product(zero(), first, first), second, second);
        const Wide limit_2 = add_product(zero(), limit, limit);
        const auto is_out_even = hn::Gt(square.even, limit_2.even);
        const auto is_out_odd = hn::Gt(square.odd, limit_2.odd);
        if (hn::AllFalse(SumTag(), hn::Or(is_out_even, is_out_odd))) {
            return;
        }
        const Sum one = hn::Set(SumTag(), std::int64_t{1} << kCoefficientFraction);
        const auto scale_of = [one](auto is_out, Sum length_2, Sum longest) {
            const Sum scale =
                floor_quotient(hn::ShiftLeft<kCoefficientFraction>(longest), floor_root(length_2));
            return hn::IfThenElse(is_out, scale, one);
        };
        const Vector scale = interleave(scale_of(is_out_even, square.even, even_part(limit)),
                                        scale_of(is_out_odd, square.odd, odd_part(limit)));
        first = multiply<kCoefficientFraction>(first, scale);
        second = multiply<kCoefficientFraction>(second, scale);
    }

private:
    using Sum = hn::Vec<SumTag>;
    using Bits = hn::RebindToUnsigned<SumTag>;

    static Vector odd_lanes(Vector v) { return hn::DupOdd(v); }
    /// Lanes that are not negative, as 64-bit numbers.
    static Sum even_part(Vector v) {
        return hn::And(hn::BitCast(SumTag(), v), hn::Set(SumTag(), 0xffffffff));
    }
    static Sum odd_part(Vector v) {
        return hn::BitCast(SumTag(), hn::ShiftRight<32>(hn::BitCast(Bits(), v)));
    }
    static Vector interleave(Sum even, Sum odd) {
        return hn::OddEven(hn::BitCast(Tag(), hn::ShiftLeft<32>(odd)), hn::BitCast(Tag(), even));
    }
    /// a b of numbers below 2^32.
    static Sum product(Sum a, Sum b) {
        const hn::Repartition<std::uint32_t, SumTag> halves;
        return hn::BitCast(SumTag(), hn::MulEven(hn::BitCast(halves, a), hn::BitCast(halves, b)));
    }
    template <class Seed>
    static Sum nearest(Seed seed) {
        const auto shifted = hn::Add(seed, hn::Set(SeedTag(), 0x1p52)); // float seed: its mantissa
        return hn::And(hn::BitCast(SumTag(), shifted),
                       hn::Set(SumTag(), (std::int64_t{1} << 52) - 1));
    }
    /// value + 1 where the mask holds; masks of 64-bit lanes are -1.
    template <class Mask>
    static Sum increment(Sum value, Mask mask) {
        return hn::Sub(value, hn::VecFromMask(SumTag(), mask));
    }
    template <class Mask>
    static Sum decrement(Sum value, Mask mask) {
        return hn::Add(value, hn::VecFromMask(SumTag(), mask));
    }
    /// floor(sqrt(square)), 0 <= square < 2^63: a seed that is off by at most one, put right.
    static Sum floor_root(Sum square) {
        Sum root = nearest(hn::Sqrt(hn::ConvertTo(SeedTag(), square)));
        root = decrement(root, hn::Gt(product(root, root), square));
        const Sum twice = hn::Add(root, root);
        return increment(root, hn::Gt(hn::Sub(square, product(root, root)), twice));
    }
    /// floor(a / b), 0 <= a < 2^60, 0 < b < 2^32, the quotient below 2^31: likewise. Of b = 0: any.
    static Sum floor_quotient(Sum a, Sum b) {
        Sum quotient = nearest(hn::Div(hn::ConvertTo(SeedTag(), a), hn::ConvertTo(SeedTag(), b)));
        quotient = decrement(quotient, hn::Gt(product(quotient, b), a));
        const Sum next = hn::Add(product(quotient, b), b);
        return increment(quotient, hn::Not(hn::Gt(next, a)));
    }

    /// Four values of one row a lane; lane 4 + i in the upper half.
    template <class AnyTag, class Source>
    static Vector load_row(AnyTag tag, Source& source, int lane) {
        if constexpr (kWidth == 4) {
            return hn::LoadU(tag, source(lane));
        } else {
            const hn::Half<AnyTag> half;
            return hn::Combine(
                tag, hn::LoadU(half, source(lane + 4)), hn::LoadU(half, source(lane)));
        }
    }
    template <class AnyTag, class Target>
    static void store_row(AnyTag tag, Vector row, Target& target, int lane) {
        if constexpr (kWidth == 4) {
            hn::StoreU(row, tag, target(lane));
        } else {
            const hn::Half<AnyTag> half;
            hn::StoreU(hn::LowerHalf(half, row), half, target(lane));
            hn::StoreU(hn::UpperHalf(half, row), half, target(lane + 4));
        }
    }
    /// Of the 4 x 4 values in each 128 bits.
    static void transpose(const Vector* rows, Vector* columns) {
        const auto wide = [](Vector v) { return hn::BitCast(SumTag(), v); };
        const Sum low_01 = wide(hn::InterleaveLower(Tag(), rows[0], rows[1]));
        const Sum high_01 = wide(hn::InterleaveUpper(Tag(), rows[0], rows[1]));
        const Sum low_23 = wide(hn::InterleaveLower(Tag(), rows[2], rows[3]));
        const Sum high_23 = wide(hn::InterleaveUpper(Tag(), rows[2], rows[3]));
        columns[0] = hn::BitCast(Tag(), hn::InterleaveLower(SumTag(), low_01, low_23));
        columns[1] = hn::BitCast(Tag(), hn::InterleaveUpper(SumTag(), low_01, low_23));
        columns[2] = hn::BitCast(Tag(), hn::InterleaveLower(SumTag(), high_01, high_23));
        columns[3] = hn::BitCast(Tag(), hn::InterleaveUpper(SumTag(), high_01, high_23));
    }
};

} // namespace lockwind::HWY_NAMESPACE
