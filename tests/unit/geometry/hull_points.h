#pragma once

#include "geometry/hull.h"
#include "reference.h"

#include <cmath>
#include <vector>

namespace lockwind::reference {

// Points of known solids, and hulls made of them.

using Points = std::vector<Vec>;

inline Vec3 to_real(const Vec& v) {
    const auto raw = [](double value) { return Real::from_raw(std::llround(value * 0x1p32)); };
    return {raw(v[0]), raw(v[1]), raw(v[2])};
}

inline std::vector<Vec3> to_real(const Points& points) {
    std::vector<Vec3> result;
    for (const Vec& point : points) {
        result.push_back(to_real(point));
    }
    return result;
}

inline Points box_points(double x, double y, double z) {
    Points points;
    for (int corner = 0; corner < 8; ++corner) {
        points.push_back(
            {(corner & 1) != 0 ? x : -x, (corner & 2) != 0 ? y : -y, (corner & 4) != 0 ? z : -z});
    }
    return points;
}

/// Edge length sqrt(8) a.
inline Points tetrahedron_points(double a) {
    return {{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}};
}

/// Edge length sqrt(2) a.
inline Points octahedron_points(double a) {
    return {{a, 0, 0}, {-a, 0, 0}, {0, a, 0}, {0, -a, 0}, {0, 0, a}, {0, 0, -a}};
}

/// Edge length 2 a.
inline Points icosahedron_points(double a) {
    const double phi = a * (1 + std::sqrt(5.0)) / 2;
    Points points;
    for (const double s : {-a, a}) {
        for (const double t : {-phi, phi}) {
            points.push_back({0, s, t});
            points.push_back({s, t, 0});
            points.push_back({t, 0, s});
        }
    }
    return points;
}

/// About y, its first corner at +x.
inline Points prism_points(int sides, double radius, double half_height) {
    Points points;
    for (int side = 0; side < sides; ++side) {
        const double angle = 2 * 3.14159265358979323846 * side / sides;
        for (const double y : {-half_height, half_height}) {
            points.push_back({radius * std::cos(angle), y, radius * std::sin(angle)});
        }
    }
    return points;
}

inline Points sphere_points(Random& random, int count, double radius) {
    Points points;
    for (int index = 0; index < count; ++index) {
        points.push_back(random.direction() * radius);
    }
    return points;
}

/// Anywhere in a box that is up to five times as long as thick.
inline Points cloud_points(Random& random, int count) {
    const Vec half{random.uniform(0.1, 0.5), random.uniform(0.1, 0.5), random.uniform(0.1, 0.5)};
    Points points;
    for (int index = 0; index < count; ++index) {
        points.push_back({random.uniform(-half[0], half[0]),
                          random.uniform(-half[1], half[1]),
                          random.uniform(-half[2], half[2])});
    }
    return points;
}

/// Of up to `count` vertices, about as large as `size`.
inline Hull random_hull(Random& random, int count, double size) {
    for (;;) {
        Points points;
        const int used =
            4 + static_cast<int>(random.bits() % static_cast<std::uint64_t>(count - 3));
        const Points cloud =
            random.bits() % 2 == 0 ? cloud_points(random, used) : sphere_points(random, used, 0.4);
        for (const Vec& point : cloud) {
            points.push_back(point * (2 * size));
        }
        const Result<Hull> hull = make_hull(to_real(points));
        if (hull && hull.value().width_least > raw_length(0.1 * size)) {
            return hull.value();
        }
    }
}

inline Points turned_points(const Points& points, const Vec& axis, double angle, const Vec& to) {
    const Body turn = Body::box(1, 1, 1).turn(axis, angle);
    Points result;
    for (const Vec& point : points) {
        result.push_back(turn.to_world(point) + to);
    }
    return result;
}

inline Vec rotated(const double q[4], const Vec& v) {
    const Vec u{q[0], q[1], q[2]};
    const Vec t = cross(u, v) * 2;
    return v + t * q[3] + cross(u, t);
}

/// A point of the hull's own frame in the one that its points were given in.
inline Vec given(const Hull& hull, const Vec& own) {
    double q[4];
    for (int index = 0; index < 4; ++index) {
        q[index] = hull.orientation[index] * kUnitUlp;
    }
    return rotated(q, own) + metres(hull.centre);
}

} // namespace lockwind::reference
