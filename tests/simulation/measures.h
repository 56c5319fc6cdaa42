#pragma once

#include "tests/support/code_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

// What the tests of this folder measure on a world, in double and by the textbook, from what any
// reader of a world sees.
namespace lockwind::test {

inline constexpr double kGravity = 9.81;

/// Whether the runs of minutes are asked for too.
inline bool long_tests() {
    return std::getenv("LOCKWIND_LONG_TESTS") != nullptr;
}

inline Real real(double value) {
    return Real::from_raw(std::llround(std::ldexp(value, 32)));
}
inline Vec3 vec(double x, double y, double z) {
    return {real(x), real(y), real(z)};
}

struct Vector {
    double x = 0;
    double y = 0;
    double z = 0;
};

inline Vector operator+(const Vector& a, const Vector& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vector operator*(const Vector& a, double scale) {
    return {a.x * scale, a.y * scale, a.z * scale};
}
inline double dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vector& v) {
    return std::sqrt(dot(v, v));
}
inline Vector vector_of(const Vec3& v) {
    return {to_double(v.x), to_double(v.y), to_double(v.z)};
}
inline Vec3 vec(const Vector& v) {
    return vec(v.x, v.y, v.z);
}

/// v turned by the unit quaternion q; back, by its conjugate.
inline Vector turned(const RealQuat& q, const Vector& v) {
    const Vector u{to_double(q.x), to_double(q.y), to_double(q.z)};
    const Vector t = cross(u, v) * 2;
    return v + t * to_double(q.w) + cross(u, t);
}
inline Vector turned_back(const RealQuat& q, const Vector& v) {
    return turned({-q.x, -q.y, -q.z, q.w}, v);
}
/// A turn by `angle` (rad) about a unit axis.
inline RealQuat turn(const Vector& axis, double angle) {
    const Vec3 u = vec(axis * std::sin(angle / 2));
    return {u.x, u.y, u.z, real(std::cos(angle / 2))};
}

/// Moments of inertia about the body's axes, kg m^2, of a solid of even density.
inline Vector inertia_of(const ShapeDefinition& shape, double mass) {
    if (shape.type == ShapeType::box) {
        const Vector h = vector_of(shape.half_extents);
        return Vector{h.y * h.y + h.z * h.z, h.z * h.z + h.x * h.x, h.x * h.x + h.y * h.y} *
               (mass / 3);
    }
    const double r = to_double(shape.radius);
    if (shape.type == ShapeType::sphere) {
        return Vector{1, 1, 1} * (0.4 * mass * r * r);
    }
    // A cylinder and two half balls, whose centres of mass lie 3/8 r beyond its ends.
    const double half = to_double(shape.half_height);
    const double ends = mass * (4.0 / 3 * r) / (4.0 / 3 * r + 2 * half);
    const double middle = mass - ends;
    const double beyond = half + 0.375 * r;
    const double across =
        middle * (r * r / 4 + half * half / 3) + ends * (83.0 / 320 * r * r + beyond * beyond);
    return {across, middle * r * r / 2 + ends * 0.4 * r * r, across};
}

inline Vector angular_momentum(const BodyView& body) {
    const Vector inertia = inertia_of(body.shape, to_double(body.mass));
    const Vector spin = turned_back(body.orientation, vector_of(body.angular_velocity));
    return turned(body.orientation, {inertia.x * spin.x, inertia.y * spin.y, inertia.z * spin.z});
}
inline double kinetic_energy(const BodyView& body) {
    const Vector velocity = vector_of(body.linear_velocity);
    return (to_double(body.mass) * dot(velocity, velocity) +
            dot(angular_momentum(body), vector_of(body.angular_velocity))) /
           2;
}

/// Of the dynamic bodies; heights are counted from y = 0.
inline double kinetic_energy(const World& world) {
    double sum = 0;
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        const BodyView body = world.body_at(row);
        sum += body.mode == BodyMode::dynamic ? kinetic_energy(body) : 0;
    }
    return sum;
}
inline double energy(const World& world, double gravity = kGravity) {
    double sum = kinetic_energy(world);
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        const BodyView body = world.body_at(row);
        sum += to_double(body.mass) * gravity * to_double(body.position.y);
    }
    return sum;
}

inline std::vector<Vector> places_of(const World& world) {
    std::vector<Vector> places;
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        places.push_back(vector_of(world.body_at(row).position));
    }
    return places;
}

struct Drift {
    double largest = 0;    // m, of any body
    double mean = 0;       // m
    double horizontal = 0; // m, the largest
};

/// How far the dynamic bodies are from `places`, by row.
inline Drift drift_from(const std::vector<Vector>& places, const World& world) {
    Drift drift;
    int bodies = 0;
    for (BodyRow row = 0; row < world.body_count(); ++row) {
        const BodyView body = world.body_at(row);
        if (body.mode != BodyMode::dynamic) {
            continue;
        }
        const Vector off = vector_of(body.position) - places[row];
        ++bodies;
        drift.largest = std::max(drift.largest, length(off));
        drift.mean += length(off);
        drift.horizontal = std::max(drift.horizontal, std::hypot(off.x, off.z));
    }
    drift.mean /= std::max(bodies, 1);
    return drift;
}

} // namespace lockwind::test
