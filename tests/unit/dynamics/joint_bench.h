#pragma once

#include "tests/unit/dynamics/dynamics_bench.h"

#include <array>
#include <numbers>

namespace lockwind {

using Vector = std::array<double, 3>;

inline Vector rotated(const std::int32_t orientation[4], const Vector& v) {
    const Vector u{std::ldexp(orientation[0], -30),
                   std::ldexp(orientation[1], -30),
                   std::ldexp(orientation[2], -30)};
    const double w = std::ldexp(orientation[3], -30);
    const auto cross = [](const Vector& a, const Vector& b) {
        return Vector{
            a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const Vector t = cross(u, v);
    const Vector s = cross(u, t);
    return {
        v[0] + 2 * (w * t[0] + s[0]), v[1] + 2 * (w * t[1] + s[1]), v[2] + 2 * (w * t[2] + s[2])};
}

/// Bodies and joints whose anchors and axes can be measured.
class JointBench : public DynamicsBench {
public:
    using DynamicsBench::DynamicsBench;

    static WorldSettings weightless() {
        WorldSettings settings;
        settings.gravity = vec(0, 0, 0);
        return settings;
    }

    /// World place of a point of the body, m.
    Vector place(BodyRow row, const Vector& local) {
        const Vector arm = rotated(motion(row).orientation, local);
        return {position(row, 0) + arm[0], position(row, 1) + arm[1], position(row, 2) + arm[2]};
    }
    static Vector metres(const std::int32_t raw[3]) {
        return {std::ldexp(raw[0], -22), std::ldexp(raw[1], -22), std::ldexp(raw[2], -22)};
    }
    /// Distance between the joint's anchors, m.
    double gap(std::uint32_t row) {
        const Joint& j = joint(row);
        const Vector a = place(j.row_a, metres(j.anchor_a));
        const Vector b = place(j.row_b, metres(j.anchor_b));
        return std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    }
    double worst_gap() {
        double worst = 0;
        for (std::uint32_t row = 0; row < state().joint_count; ++row) {
            worst = std::max(worst, gap(row));
        }
        return worst;
    }
    /// Angle about z of a body that turns about z alone, rad.
    double angle_z(BodyRow row) {
        const Vector x = rotated(motion(row).orientation, {1, 0, 0});
        return std::atan2(x[1], x[0]);
    }
    double energy(BodyRow row, double moment_by_mass) const {
        const double spin_size = std::hypot(spin(row, 0), spin(row, 1), spin(row, 2));
        return speed(row) * speed(row) / 2 + moment_by_mass * spin_size * spin_size / 2 +
               9.81 * position(row, 1);
    }
};

inline JointDefinition
join(JointKind kind, BodyRow a, BodyRow b, const Vec3& anchor_a, const Vec3& anchor_b) {
    JointDefinition definition;
    definition.kind = kind;
    definition.body_a = a + 1;
    definition.body_b = b + 1;
    definition.anchor_a = anchor_a;
    definition.anchor_b = anchor_b;
    return definition;
}

/// The joint's x axis along z of both bodies.
inline JointDefinition about_z(JointDefinition definition) {
    const Real half = real(std::sqrt(0.5));
    definition.frame_a = {0, -half, 0, half};
    definition.frame_b = definition.frame_a;
    return definition;
}
/// The joint's x axis along y of both bodies.
inline JointDefinition along_y(JointDefinition definition) {
    const Real half = real(std::sqrt(0.5));
    definition.frame_a = {0, 0, half, half};
    definition.frame_b = definition.frame_a;
    return definition;
}

} // namespace lockwind
