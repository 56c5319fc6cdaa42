#pragma once

#include "hull_points.h"
#include "reference.h"

#include <cmath>
#include <cstdint>

namespace lockwind::reference {

inline constexpr ShapeType kConvexTypes[] = {
    ShapeType::sphere, ShapeType::capsule, ShapeType::box, ShapeType::hull};

/// Of sizes 5 cm .. 2 m times `scale`, turned anyhow; a hull is that of so many points.
inline Body random_body(Random& random, ShapeType type, double scale, int hull_points) {
    const auto size = [&] { return random.uniform(0.05, 2) * scale; };
    Body body = Body::plane();
    if (type == ShapeType::sphere) {
        body = Body::sphere(size());
    } else if (type == ShapeType::capsule) {
        body = Body::capsule(size() / 2, size());
    } else if (type == ShapeType::box) {
        body = Body::box(size(), size(), size());
    } else if (type == ShapeType::hull) {
        body = Body::hull(random_hull(random, hull_points, scale));
    }
    return body.turn(random.direction(), random.uniform(0, 3.14));
}

inline Body random_body(Random& random, ShapeType type, double scale) {
    return random_body(random, type, scale, 10);
}

/// Q31.32.
inline void to_raw(const Vec& v, std::int64_t raw[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        raw[axis] = std::llround(v[axis] * 0x1p32);
    }
}
inline double from_raw(std::int64_t raw) {
    return static_cast<double>(raw) * 0x1p-32;
}
inline Vec from_raw(const std::int64_t raw[3]) {
    return {from_raw(raw[0]), from_raw(raw[1]), from_raw(raw[2])};
}

} // namespace lockwind::reference
