#pragma once

// The body of native_digest and portable_digest: included once by each, in its own arithmetic.

#include "math/integer.h"

#include "lockwind/trig.h"

namespace {

class Digest {
public:
    void add(std::uint64_t value) {
        for (int byte = 0; byte < 8; ++byte) {
            hash_ = (hash_ ^ ((value >> (8 * byte)) & 0xffU)) * 0x100000001b3U;
        }
    }
    void add(std::int64_t value) { add(static_cast<std::uint64_t>(value)); }
    void add(lockwind::Real value) { add(value.raw()); }
    void add(const lockwind::Vec3& v) {
        add(v.x);
        add(v.y);
        add(v.z);
    }
    std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 0xcbf29ce484222325U;
};

/// SplitMix64, each draw shifted by a drawn amount: all magnitudes occur.
class Operands {
public:
    std::uint64_t bits() {
        state_ += 0x9e3779b97f4a7c15U;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }
    lockwind::Real real(int width) {
        const auto value = static_cast<std::int64_t>(bits());
        return lockwind::Real::from_raw(value >> (64 - width + static_cast<int>(bits() % 40)));
    }
    lockwind::Vec3 vec3(int width) { return {real(width), real(width), real(width)}; }

private:
    std::uint64_t state_ = 0;
};

inline std::uint64_t arithmetic_digest() {
    using namespace lockwind;
    Digest digest;
    Operands operands;
    for (int i = 0; i < 20000; ++i) {
        const Real a = operands.real(46);
        const Real b = operands.real(46);
        const Vec3 u = operands.vec3(44);
        const Vec3 v = operands.vec3(44);
        digest.add(a * b);
        digest.add(a / b);
        digest.add(divide_to<InverseMass>(a, b).raw());
        digest.add(sqrt(abs(a)));
        digest.add(rsqrt(abs(a)));
        digest.add(dot(u, v));
        digest.add(cross(u, v));
        digest.add(length(u));
        digest.add(normalized(u));
        digest.add(multiply_divide(a.raw(), b.raw(), u.x.raw()));
        digest.add(multiply_shift_wide(a.raw(), b.raw(), 40));
        digest.add(static_cast<std::uint64_t>(dot_wide(u, u) < dot_wide(v, v)));
        const Angle angle = Angle::from_radians(a);
        digest.add(angle.raw());
        digest.add(angle.radians());
        digest.add(sin(angle));
        digest.add(cos(angle));
        digest.add(atan2_angle(a, b).raw());
        digest.add(rotate(from_axis_angle(normalized(u), angle), v));
    }
    return digest.value();
}

} // namespace
