#pragma once

#include <cstdint>

namespace lockwind {

/// (sin h, cos h) / (h, 1) from h^2 in Q.30, h^2 <= 1/4: error < 2^-29. Taylor's series to h^8.
struct SincCos {
    std::int64_t sinc; // Q.30
    std::int64_t cos;
};
SincCos sinc_cos(std::int64_t square);

/// Sine and cosine of an angle of at most 4 rad, Q.30.
struct SinCos {
    std::int64_t sin;
    std::int64_t cos;
};
SinCos sin_cos(std::int64_t angle);

/// Unit quaternion (x y z w, Q.30) that turns by the vector 2 x half_angle (Q.30 rad, each <= 2).
void turn_quaternion(const std::int64_t half_angle[3], std::int64_t quaternion[4]);

/// out = a b, Q2.30, rounded; `out` may be either.
void multiply_quaternions(const std::int64_t a[4], const std::int64_t b[4], std::int64_t out[4]);

/// Brings a quaternion that is nearly of unit length (to 1 part in 10^4) back to it.
void normalize_quaternion(const std::int64_t quaternion[4], std::int32_t out[4]);

/// A rigid body that turns freely for a time, by symplectic splitting: the turns about each
/// principal axis alone are exact, and composed symmetrically (half x, half y, z, half y, half x).
/// Angular momentum is conserved exactly in the world (each part is a rotation), energy to second
/// order without drift. Dullweber, Leimkuhler, McLachlan, "Symplectic splitting methods for rigid
/// body molecular dynamics", J. Chem. Phys. 107 (1997).
struct FreeTurn {
    std::int64_t
        momentum[3];         // body frame, Q.24 m/s: velocity x least inverse inertia / this axis's
    std::int64_t inertia[3]; // inverse inertia by axis, Q.22, > 0
    std::int64_t inertia_min;       // the least of them
    std::int64_t angle_of_velocity; // Q.32: radians a tick per m/s
    std::int64_t velocity_max;      // Q.24: that turns by 4 rad
    std::int64_t orientation[4];    // Q.30

    void run();

private:
    void turn_about(int axis, int halvings);
};

} // namespace lockwind
