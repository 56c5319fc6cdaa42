#include "tests/unit/math/accuracy.h"

#include "tests/unit/math/support.h"

#include <algorithm>

__extension__ using Quad = __float128;

// libquadmath, declared here because clang does not find its header.
extern "C" {
Quad sqrtq(Quad);
Quad sinq(Quad);
Quad cosq(Quad);
Quad atan2q(Quad, Quad);
Quad fabsq(Quad);
}

namespace lockwind {
namespace {

Quad quad(Real value) {
    return static_cast<Quad>(value.raw()) / static_cast<Quad>(std::uint64_t{1} << 32U);
}

template <class Raw, int FractionBits>
Quad error_ulp(Fixed<Raw, FractionBits> result, Quad exact) {
    const Quad scale = static_cast<Quad>(std::uint64_t{1} << FractionBits);
    return fabsq(static_cast<Quad>(result.raw()) - exact * scale);
}

/// The largest error that `trial` returns.
template <class Trial>
double worst(int samples, std::uint64_t seed, Trial trial) {
    Draws draws(seed);
    Quad largest = 0;
    for (int i = 0; i < samples; ++i) {
        largest = std::max(largest, trial(draws));
    }
    return static_cast<double>(largest);
}

Quad product_error(Draws& draws) {
    const Real a = draws.real(47);
    const Real b = draws.real(47);
    return error_ulp(a * b, quad(a) * quad(b));
}

Quad dot_error(Draws& draws) {
    const Vec3 a = draws.vec3(46);
    const Vec3 b = draws.vec3(46);
    return error_ulp(dot(a, b),
                     quad(a.x) * quad(b.x) + quad(a.y) * quad(b.y) + quad(a.z) * quad(b.z));
}

Quad quotient_error(Draws& draws) {
    const Real a = draws.real(46);
    const auto magnitude = static_cast<std::int64_t>(draws.any(44) | (1U << 18U));
    const Real b = Real::from_raw((draws.bits() & 1U) != 0 ? -magnitude : magnitude);
    return error_ulp(a / b, quad(a) / quad(b));
}

Quad root_error(Draws& draws) {
    const Real a = abs(draws.real(63));
    return error_ulp(sqrt(a), sqrtq(quad(a)));
}

Quad inverse_root_error(Draws& draws) {
    const Real a = Real::from_raw(static_cast<std::int64_t>(draws.any(63) | 1U));
    return error_ulp(rsqrt(a), 1 / sqrtq(quad(a)));
}

Quad length_error(Draws& draws) {
    const Vec3 v = draws.vec3(62);
    return error_ulp(length(v),
                     sqrtq(quad(v.x) * quad(v.x) + quad(v.y) * quad(v.y) + quad(v.z) * quad(v.z)));
}

Quad normalized_error(Draws& draws) {
    const Vec3 v = draws.vec3(63);
    if (v == Vec3{}) {
        return 0;
    }
    const Quad exact = sqrtq(quad(v.x) * quad(v.x) + quad(v.y) * quad(v.y) + quad(v.z) * quad(v.z));
    const Vec3 unit = normalized(v);
    return std::max({error_ulp(unit.x, quad(v.x) / exact),
                     error_ulp(unit.y, quad(v.y) / exact),
                     error_ulp(unit.z, quad(v.z) / exact)});
}

Quad radians(Angle angle) {
    const Quad pi = 4 * atan2q(1, 1);
    return 2 * pi * static_cast<Quad>(static_cast<std::int64_t>(angle.raw())) /
           (static_cast<Quad>(std::uint64_t{1} << 63U) * 2);
}

Quad sine_error(Draws& draws) {
    const Angle angle = Angle::from_raw(draws.bits());
    return error_ulp(sin(angle), sinq(radians(angle)));
}

Quad cosine_error(Draws& draws) {
    const Angle angle = Angle::from_raw(draws.bits());
    return error_ulp(cos(angle), cosq(radians(angle)));
}

Quad unit_circle_error(Draws& draws) {
    const Angle angle = Angle::from_raw(draws.bits());
    const SinCos<Unit> circle = sincos<Unit>(angle);
    return std::max(error_ulp(circle.sin, sinq(radians(angle))),
                    error_ulp(circle.cos, cosq(radians(angle))));
}

Quad sine_of_radians_error(Draws& draws) {
    const Real angle = draws.real(42);
    return std::max(error_ulp(sin(angle), sinq(quad(angle))),
                    error_ulp(cos(angle), cosq(quad(angle))));
}

Quad atan2_error(Draws& draws) {
    const Real y = draws.real(63);
    const Real x = draws.real(63);
    return error_ulp(atan2(y, x), atan2q(quad(y), quad(x)));
}

Quad rotate_error(Draws& draws) {
    const RealQuat q =
        normalized(RealQuat{draws.real(34), draws.real(34), draws.real(34), Real(1)});
    const Vec3 v{draws.real(32), draws.real(32), draws.real(32)};
    // u x (u x v + w v), doubled, plus v: of the stored q, which is unit to 2^-33.
    const Quad tx = quad(q.y) * quad(v.z) - quad(q.z) * quad(v.y) + quad(q.w) * quad(v.x);
    const Quad ty = quad(q.z) * quad(v.x) - quad(q.x) * quad(v.z) + quad(q.w) * quad(v.y);
    const Quad tz = quad(q.x) * quad(v.y) - quad(q.y) * quad(v.x) + quad(q.w) * quad(v.z);
    const Vec3 result = rotate(q, v);
    return std::max({error_ulp(result.x, quad(v.x) + 2 * (quad(q.y) * tz - quad(q.z) * ty)),
                     error_ulp(result.y, quad(v.y) + 2 * (quad(q.z) * tx - quad(q.x) * tz)),
                     error_ulp(result.z, quad(v.z) + 2 * (quad(q.x) * ty - quad(q.y) * tx))});
}

} // namespace

std::vector<Accuracy> measure_accuracy(int samples) {
    const auto measure = [samples](auto trial) { return worst(samples, 71, trial); };
    return {
        {"a * b", "below 2^15", "half up", measure(product_error), 0.5},
        {"dot", "below 2^14", "half up, once", measure(dot_error), 0.5},
        {"a / b", "quotient below 2^28", "truncated", measure(quotient_error), 1},
        {"sqrt", "all", "floor", measure(root_error), 1},
        {"rsqrt", "all", "floor", measure(inverse_root_error), 1},
        {"length", "below 2^30", "floor", measure(length_error), 1},
        {"normalized", "all", "nearest", measure(normalized_error), 0.501},
        {"rotate", "below 1", "twice half up", measure(rotate_error), 2.5},
        {"sin(Angle)", "all", "nearest", measure(sine_error), 0.501},
        {"cos(Angle)", "all", "nearest", measure(cosine_error), 0.501},
        {"sincos in Unit", "all", "nearest", measure(unit_circle_error), 0.501},
        {"sin, cos(radians)", "below 2^10 rad", "nearest", measure(sine_of_radians_error), 0.501},
        {"atan2, radians", "all", "nearest", measure(atan2_error), 0.503},
    };
}

} // namespace lockwind
