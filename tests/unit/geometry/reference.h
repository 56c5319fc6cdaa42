#pragma once

#include "geometry/collide.h"
#include "geometry/hull.h"
#include "geometry/rotation.h"
#include "solid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

namespace lockwind::reference {

// Double-precision geometry, written apart from the code under test: what the tests compare with.

inline constexpr double kLengthUlp = 1.0 / (1 << kLengthFraction);
inline constexpr double kUnitUlp = 1.0 / (1 << kUnitFraction);

inline std::int32_t raw_length(double metres) {
    return static_cast<std::int32_t>(std::lround(metres / kLengthUlp));
}
inline Vec metres(const std::int32_t raw[3]) {
    return {raw[0] * kLengthUlp, raw[1] * kLengthUlp, raw[2] * kLengthUlp};
}
inline Vec unit(const std::int32_t raw[3]) {
    return {raw[0] * kUnitUlp, raw[1] * kUnitUlp, raw[2] * kUnitUlp};
}

/// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        state_ += 0x9e3779b97f4a7c15U;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }
    double uniform(double low, double high) {
        return low + (high - low) * static_cast<double>(bits() >> 11U) * 0x1p-53;
    }
    Vec direction() {
        for (;;) {
            const Vec v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
            const double size = length(v);
            if (size > 0.1 && size <= 1) {
                return v * (1 / size);
            }
        }
    }

private:
    std::uint64_t state_;
};

/// A shape, its turn and its place (relative to the pair's other body), owned.
struct Body {
    ShapeType type = ShapeType::sphere;
    std::int32_t size[3] = {0, 0, 0};
    std::int32_t rotation[9] = {kUnitOne, 0, 0, 0, kUnitOne, 0, 0, 0, kUnitOne};
    std::shared_ptr<const Hull> shape;  // of a hull
    std::shared_ptr<const Solid> solid; // of a hull, in its own frame

    static Body sphere(double radius) { return make(ShapeType::sphere, radius, 0, 0); }
    static Body capsule(double radius, double half) {
        return make(ShapeType::capsule, radius, half, 0);
    }
    static Body box(double x, double y, double z) { return make(ShapeType::box, x, y, z); }
    static Body plane() { return make(ShapeType::plane, 0, 0, 0); }
    static Body hull(const Hull& of) {
        Body body = make(ShapeType::hull, 0, 0, 0);
        std::vector<Vec> vertices;
        for (std::uint32_t vertex = 0; vertex < of.vertex_count; ++vertex) {
            vertices.push_back(metres(of.vertices[vertex].place));
        }
        body.shape = std::make_shared<const Hull>(of);
        body.solid = std::make_shared<const Solid>(std::move(vertices));
        return body;
    }

    Body& turn(const Vec& axis, double angle) {
        if (type == ShapeType::sphere) {
            return *this;
        }
        const double s = std::sin(angle / 2);
        const double q[4] = {axis[0] * s, axis[1] * s, axis[2] * s, std::cos(angle / 2)};
        std::int32_t orientation[4];
        for (int index = 0; index < 4; ++index) {
            orientation[index] = static_cast<std::int32_t>(std::lround(q[index] / kUnitUlp));
        }
        rotation_matrix(orientation, rotation);
        return *this;
    }
    ShapeInstance instance() const {
        return {type, {size[0], size[1], size[2]}, rotation, shape.get()};
    }
    double extent(int axis) const { return size[axis] * kLengthUlp; }
    Vec axis(int column) const {
        return {rotation[column] * kUnitUlp,
                rotation[3 + column] * kUnitUlp,
                rotation[6 + column] * kUnitUlp};
    }
    Vec to_world(const Vec& local) const {
        return axis(0) * local[0] + axis(1) * local[1] + axis(2) * local[2];
    }
    Vec to_local(const Vec& world) const {
        return {dot(axis(0), world), dot(axis(1), world), dot(axis(2), world)};
    }
    /// Signed distance from the surface to a point given from the body's centre, world axes.
    double distance(const Vec& from_centre) const;

private:
    static Body make(ShapeType type, double x, double y, double z) {
        Body body;
        body.type = type;
        body.size[0] = raw_length(x);
        body.size[1] = raw_length(y);
        body.size[2] = raw_length(z);
        return body;
    }
};

inline double box_distance(const Vec& half, const Vec& point) {
    double outside = 0;
    double inside = -1e9;
    for (int axis = 0; axis < 3; ++axis) {
        const double beyond = std::abs(point[axis]) - half[axis];
        outside += beyond > 0 ? beyond * beyond : 0;
        inside = std::max(inside, beyond);
    }
    return outside > 0 ? std::sqrt(outside) : inside;
}

inline double Body::distance(const Vec& from_centre) const {
    const Vec local = to_local(from_centre);
    switch (type) {
    case ShapeType::sphere:
        return length(local) - extent(0);
    case ShapeType::capsule: {
        const double along = std::min(std::max(local[1], -extent(1)), extent(1));
        return length(local - Vec{0, along, 0}) - extent(0);
    }
    case ShapeType::box:
        return box_distance({extent(0), extent(1), extent(2)}, local);
    case ShapeType::plane:
        return local[1];
    case ShapeType::hull:
        return solid->distance(local);
    default: // made of these
        break;
    }
    return 0;
}

/// Minimum of a convex function on [low, high].
template <class Function>
double minimum(double low, double high, const Function& function) {
    for (int step = 0; step < 100; ++step) {
        const double third = (high - low) / 3;
        if (function(low + third) < function(high - third)) {
            high -= third;
        } else {
            low += third;
        }
    }
    return function((low + high) / 2);
}

inline double segment_distance(const Vec& a, const Vec& way_a, const Vec& b, const Vec& way_b) {
    return minimum(-1, 1, [&](double s) {
        const Vec p = a + way_a * s;
        const double square = dot(way_b, way_b);
        const double t = square > 0 ? dot(p - b, way_b) / square : 0;
        return length(p - b - way_b * std::min(std::max(t, -1.0), 1.0));
    });
}

/// One of the twelve edges: middle and half way.
inline void box_edge(const Body& box, const Vec& centre, int index, Vec& middle, Vec& way) {
    const int axis = index / 4;
    const int j = (axis + 1) % 3;
    const int k = (axis + 2) % 3;
    way = box.axis(axis) * box.extent(axis);
    middle = centre + box.axis(j) * (box.extent(j) * ((index & 1) != 0 ? 1 : -1)) +
             box.axis(k) * (box.extent(k) * ((index & 2) != 0 ? 1 : -1));
}

/// Largest separation over the 15 axes of two boxes: exact overlap where negative.
inline double box_axes_separation(const Body& a, const Body& b, const Vec& delta) {
    double best = -1e9;
    const auto test = [&](const Vec& axis) {
        const double size = length(axis);
        if (size < 1e-3) {
            return;
        }
        double extent = 0;
        for (int index = 0; index < 3; ++index) {
            extent += std::abs(dot(axis, a.axis(index))) * a.extent(index) +
                      std::abs(dot(axis, b.axis(index))) * b.extent(index);
        }
        best = std::max(best, (std::abs(dot(axis, delta)) - extent) / size);
    };
    for (int i = 0; i < 3; ++i) {
        test(a.axis(i));
        test(b.axis(i));
        for (int j = 0; j < 3; ++j) {
            test(cross(a.axis(i), b.axis(j)));
        }
    }
    return best;
}

/// Distance of two boxes from all pairs of features; 0 or less where they overlap.
inline double boxes_distance(const Body& a, const Body& b, const Vec& delta) {
    const double axes = box_axes_separation(a, b, delta);
    if (axes <= 0) {
        return axes;
    }
    double best = 1e9;
    for (int corner = 0; corner < 8; ++corner) {
        const auto sign = [corner](int bit) { return (corner >> bit & 1) != 0 ? 1.0 : -1.0; };
        const Vec on_a =
            a.to_world({sign(0) * a.extent(0), sign(1) * a.extent(1), sign(2) * a.extent(2)});
        const Vec on_b =
            b.to_world({sign(0) * b.extent(0), sign(1) * b.extent(1), sign(2) * b.extent(2)});
        best = std::min(best, b.distance(on_a - delta));
        best = std::min(best, a.distance(on_b + delta));
    }
    for (int i = 0; i < 12; ++i) {
        for (int j = 0; j < 12; ++j) {
            Vec middle_a;
            Vec way_a;
            Vec middle_b;
            Vec way_b;
            box_edge(a, {0, 0, 0}, i, middle_a, way_a);
            box_edge(b, delta, j, middle_b, way_b);
            best = std::min(best, segment_distance(middle_a, way_a, middle_b, way_b));
        }
    }
    return best;
}

/// Distance of a capsule's segment to a box: 0 where it crosses it.
inline double box_segment_distance(const Body& box, const Body& capsule, const Vec& delta) {
    return minimum(-capsule.extent(1), capsule.extent(1), [&](double along) {
        return std::max(0.0, box.distance(delta + capsule.axis(1) * along));
    });
}

/// A box or hull in the world.
inline Solid solid_of(const Body& body, const Vec& centre) {
    std::vector<Vec> vertices;
    if (body.type == ShapeType::hull) {
        for (const Vec& vertex : body.solid->vertices) {
            vertices.push_back(centre + body.to_world(vertex));
        }
    } else {
        for (int corner = 0; corner < 8; ++corner) {
            const auto sign = [corner](int bit) { return (corner >> bit & 1) != 0 ? 1.0 : -1.0; };
            vertices.push_back(centre + body.to_world({sign(0) * body.extent(0),
                                                       sign(1) * body.extent(1),
                                                       sign(2) * body.extent(2)}));
        }
    }
    return Solid(std::move(vertices));
}

/// Of a hull and another shape.
inline double hull_distance(const Body& hull, const Body& other, const Vec& delta) {
    switch (other.type) {
    case ShapeType::sphere:
        return hull.distance(delta) - other.extent(0);
    case ShapeType::capsule:
        return minimum(-other.extent(1),
                       other.extent(1),
                       [&](double along) {
                           return std::max(0.0, hull.distance(delta + other.axis(1) * along));
                       }) -
               other.extent(0);
    case ShapeType::plane: {
        double lowest = 1e9;
        for (const Vec& vertex : hull.solid->vertices) {
            lowest = std::min(lowest, dot(other.axis(1), hull.to_world(vertex) - delta));
        }
        return lowest;
    }
    default:
        return distance(solid_of(hull, {0, 0, 0}), solid_of(other, delta));
    }
}

/// Surface distance of two shapes; of boxes and capsules across boxes, only a sign where they
/// overlap.
inline double distance(const Body& a, const Body& b, const Vec& delta) {
    if (a.type < b.type) {
        return distance(b, a, delta * -1);
    }
    if (a.type == ShapeType::hull) {
        return hull_distance(a, b, delta);
    }
    if (a.type == ShapeType::box && b.type == ShapeType::box) {
        return boxes_distance(a, b, delta);
    }
    if (b.type == ShapeType::sphere) {
        return a.distance(delta) - b.extent(0);
    }
    if (a.type == ShapeType::box) {
        return box_segment_distance(a, b, delta) - b.extent(0);
    }
    if (a.type == ShapeType::capsule) {
        return segment_distance(
                   {0, 0, 0}, a.axis(1) * a.extent(1), delta, b.axis(1) * b.extent(1)) -
               a.extent(0) - b.extent(0);
    }
    double reach = b.extent(0) + std::abs(dot(a.axis(1), b.axis(1))) * b.extent(1);
    if (b.type == ShapeType::box) {
        reach = 0;
        for (int index = 0; index < 3; ++index) {
            reach += std::abs(dot(a.axis(1), b.axis(index))) * b.extent(index);
        }
    }
    return dot(a.axis(1), delta) - reach;
}

} // namespace lockwind::reference
