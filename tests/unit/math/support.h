#pragma once

#include "lockwind/trig.h"

#include <cstdint>
#include <iomanip>
#include <ostream>
#include <random>

namespace lockwind {
inline namespace LOCKWIND_ARITHMETIC {

template <class Raw, int FractionBits>
std::ostream& operator<<(std::ostream& out, Fixed<Raw, FractionBits> value) {
    const auto scale = static_cast<double>(std::uint64_t{1} << FractionBits);
    return out << std::setprecision(17) << static_cast<double>(value.raw()) / scale << " (raw "
               << value.raw() << ')';
}

inline std::ostream& operator<<(std::ostream& out, const Vec3& v) {
    return out << v.x << ' ' << v.y << ' ' << v.z;
}

/// Seeded draws whose magnitudes are spread over all powers of two, edges included.
class Draws {
public:
    explicit Draws(std::uint64_t seed) : engine_(seed) {}

    std::uint64_t bits() { return engine_(); }

    /// A value of 0 .. `width` bits.
    std::uint64_t any(int width = 64) {
        const auto size = static_cast<int>(engine_() % static_cast<unsigned>(width + 1));
        const std::uint64_t value = size == 0 ? 0 : engine_() >> (64 - size);
        switch (engine_() % 8) {
        case 0: // all ones
            return size == 0 ? 0 : ~std::uint64_t{0} >> (64 - size);
        case 1: // a power of two
            return size == 0 ? 0 : std::uint64_t{1} << (size - 1);
        default:
            return value;
        }
    }

    /// |value| < 2^width, both signs.
    std::int64_t any_signed(int width = 63) {
        const auto magnitude = static_cast<std::int64_t>(any(width));
        return (engine_() & 1U) != 0 ? -magnitude : magnitude;
    }

    /// |value| < 2^(width - 32).
    Real real(int width) { return Real::from_raw(any_signed(width)); }

    Vec3 vec3(int width) { return {real(width), real(width), real(width)}; }

    Vec3 unit() {
        Vec3 v{};
        while (v == Vec3{}) {
            v = vec3(40);
        }
        return normalized(v);
    }

    RealQuat rotation() {
        const Vec3 axis = unit();
        return from_axis_angle(axis, Angle::from_raw(bits()));
    }

private:
    std::mt19937_64 engine_;
};

} // namespace LOCKWIND_ARITHMETIC
} // namespace lockwind
