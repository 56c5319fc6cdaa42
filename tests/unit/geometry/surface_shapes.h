#pragma once

#include "geometry/surface.h"
#include "hull_points.h"
#include "reference.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace lockwind::reference {

// Surfaces for tests, and their distances in double precision.

inline Surface made(Result<Surface> surface) {
    if (!surface.ok()) {
        throw std::runtime_error(surface.error().message);
    }
    return std::move(surface).value();
}

/// Ground over [-size, size]^2 of cells x cells, y = height(x, z).
template <class Height>
HeightFieldDefinition field_of(std::uint32_t cells, double size, const Height& height) {
    HeightFieldDefinition field;
    field.columns = cells + 1;
    field.rows = cells + 1;
    field.spacing_x = to_real(Vec{2 * size / cells, 0, 0}).x;
    field.spacing_z = field.spacing_x;
    for (std::uint32_t row = 0; row <= cells; ++row) {
        for (std::uint32_t column = 0; column <= cells; ++column) {
            const double x = (2.0 * column / cells - 1) * size;
            const double z = (2.0 * row / cells - 1) * size;
            field.heights.push_back(to_real(Vec{0, height(x, z), 0}).y);
        }
    }
    return field;
}

inline Vec corner_of(const Surface& surface, std::uint32_t triangle, std::uint32_t corner) {
    return metres(surface.corner(triangle, corner));
}

/// From a point to a triangle: its inside, else an edge.
inline double point_triangle(const Vec& point, const Vec& a, const Vec& b, const Vec& c) {
    const Vec normal = cross(b - a, c - a);
    const Vec* corners[4] = {&a, &b, &c, &a};
    bool inside = true;
    double best = 1e9;
    for (int edge = 0; edge < 3; ++edge) {
        const Vec& from = *corners[edge];
        const Vec& to = *corners[edge + 1];
        inside = inside && dot(cross(normal, to - from), point - from) >= 0;
        best = std::min(best, point_segment(point, from, to));
    }
    return inside ? std::abs(dot(normal, point - a)) / length(normal) : best;
}

inline double point_surface(const Vec& point, const Surface& surface) {
    double best = 1e9;
    for (std::uint32_t index = 0; index < surface.triangle_count(); ++index) {
        best = std::min(best,
                        point_triangle(point,
                                       corner_of(surface, index, 0),
                                       corner_of(surface, index, 1),
                                       corner_of(surface, index, 2)));
    }
    return best;
}

/// The instance of one triangle, in the surface's own frame.
inline ShapeInstance triangle_instance(const Surface& surface, std::uint32_t index) {
    ShapeInstance shape{ShapeType::mesh, {0, 0, 0}, kIdentityRotation};
    shape.surface = &surface;
    shape.part = index;
    return shape;
}

/// Contacts of a body at a place in the surface's frame with all of the surface's triangles.
inline std::vector<ManifoldGeometry>
touch_all(const Surface& surface, const Body& body, const Vec& place) {
    std::vector<ManifoldGeometry> contacts;
    const std::int32_t delta[3] = {
        raw_length(place[0]), raw_length(place[1]), raw_length(place[2])};
    for (std::uint32_t index = 0; index < surface.triangle_count(); ++index) {
        ManifoldGeometry manifold;
        collide(triangle_instance(surface, index), body.instance(), delta, {}, manifold);
        if (manifold.point_count != 0) {
            contacts.push_back(manifold);
        }
    }
    return contacts;
}

inline double lowest_separation(const std::vector<ManifoldGeometry>& contacts) {
    double least = 1e9;
    for (const ManifoldGeometry& contact : contacts) {
        for (std::uint32_t point = 0; point < contact.point_count; ++point) {
            least = std::min(least, contact.points[point].separation * kLengthUlp);
        }
    }
    return least;
}

} // namespace lockwind::reference
