#pragma once

#include "lockwind/vector.h"

#include <cstdint>

namespace lockwind {

/// How a particle's motion is stepped. Orders of convergence, and what becomes of the energy of an
/// oscillator (Hairer, Lubich, Wanner, "Geometric Numerical Integration", 2006):
enum class Integrator : std::uint8_t {
    semi_implicit_euler = 0, // 1; swings about the true one for ever. Rigid bodies
    explicit_euler = 1,      // 1; grows: for short visual effects alone
    verlet = 2,              // 2; bounded. Cloth and rope (velocity Verlet)
    leapfrog = 3,            // 2; bounded (drift, kick, drift: one force a step). Fluids
    rk4 = 4,                 // 4; falls a little with h^5. Orbits
};

struct ParticleMotion {
    Vec3 position; // m
    Vec3 velocity; // m/s
    bool operator==(const ParticleMotion&) const = default;
};

namespace detail {

template <class Acceleration>
ParticleMotion
runge_kutta_4(const ParticleMotion& start, Real step, const Acceleration& acceleration) {
    const Real half = step / Real(2);
    const auto ahead = [&](Real by, const ParticleMotion& slope) {
        return ParticleMotion{start.position + slope.position * by,
                              start.velocity + slope.velocity * by};
    };
    const auto slope = [&](const ParticleMotion& at) {
        return ParticleMotion{at.velocity, acceleration(at)};
    };
    const ParticleMotion first = slope(start);
    const ParticleMotion second = slope(ahead(half, first));
    const ParticleMotion third = slope(ahead(half, second));
    const ParticleMotion fourth = slope(ahead(step, third));
    // One division, last: a sixth is no fixed-point number.
    const auto mean = [step](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
        return (a + Real(2) * (b + c) + d) * step / Real(6);
    };
    return {start.position + mean(first.position, second.position, third.position, fourth.position),
            start.velocity +
                mean(first.velocity, second.velocity, third.velocity, fourth.velocity)};
}

} // namespace detail

/// The motion after `step` seconds. acceleration(motion) gives m/s^2; verlet and leapfrog want one
/// that does not depend on the velocity. Costs one call of it (verlet two, rk4 four).
template <class Acceleration>
ParticleMotion integrate(Integrator integrator,
                         const ParticleMotion& start,
                         Real step,
                         const Acceleration& acceleration) {
    ParticleMotion next = start;
    switch (integrator) {
    case Integrator::semi_implicit_euler:
        next.velocity += acceleration(start) * step;
        next.position += next.velocity * step;
        break;
    case Integrator::explicit_euler:
        next.position += start.velocity * step;
        next.velocity += acceleration(start) * step;
        break;
    case Integrator::verlet: {
        const Real half = step / Real(2);
        next.velocity += acceleration(start) * half;
        next.position += next.velocity * step;
        next.velocity += acceleration(next) * half;
        break;
    }
    case Integrator::leapfrog: {
        const Real half = step / Real(2);
        next.position += start.velocity * half;
        next.velocity += acceleration(next) * step;
        next.position += next.velocity * half;
        break;
    }
    case Integrator::rk4:
        next = detail::runge_kutta_4(start, step, acceleration);
        break;
    }
    return next;
}

} // namespace lockwind
