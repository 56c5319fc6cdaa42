#pragma once

#include "reference_vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lockwind::reference {

/// A convex polyhedron by brute force from its vertices: every triple that has all others on one
/// side is a triangle of its surface, every side of one counts as an edge.
struct Solid {
    std::vector<Vec> vertices;
    std::vector<std::array<std::size_t, 3>> triangles; // counter-clockwise, seen from outside
    std::vector<Vec> normals;
    std::vector<std::array<std::size_t, 2>> edges;

    explicit Solid(std::vector<Vec> points) : vertices(std::move(points)) {
        const std::size_t count = vertices.size();
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t j = i + 1; j < count; ++j) {
                for (std::size_t k = j + 1; k < count; ++k) {
                    add_triangle(i, j, k);
                    add_triangle(i, k, j);
                }
            }
        }
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    }

    double height(std::size_t triangle, const Vec& point) const {
        return dot(normals[triangle], point - vertices[triangles[triangle][0]]);
    }
    /// Negative inside, by the nearest face.
    double distance(const Vec& point) const;
    /// Extent along an axis.
    std::array<double, 2> extent(const Vec& axis) const {
        std::array<double, 2> range{1e9, -1e9};
        for (const Vec& vertex : vertices) {
            range[0] = std::min(range[0], dot(axis, vertex));
            range[1] = std::max(range[1], dot(axis, vertex));
        }
        return range;
    }

private:
    void add_triangle(std::size_t i, std::size_t j, std::size_t k) {
        // As far as rounded vertices of one face lie apart, and flat triangles tell no normal.
        constexpr double kFlat = 2e-4;
        const Vec normal = cross(vertices[j] - vertices[i], vertices[k] - vertices[i]);
        const double size = length(normal);
        if (size < 1e-6) {
            return;
        }
        for (const Vec& vertex : vertices) {
            if (dot(normal, vertex - vertices[i]) > kFlat * size) {
                return;
            }
        }
        triangles.push_back({i, j, k});
        normals.push_back(normal * (1 / size));
        edges.push_back({std::min(i, j), std::max(i, j)});
        edges.push_back({std::min(j, k), std::max(j, k)});
        edges.push_back({std::min(i, k), std::max(i, k)});
    }
};

/// From a point to a segment.
inline double point_segment(const Vec& point, const Vec& from, const Vec& to) {
    const Vec way = to - from;
    const double along = std::clamp(dot(point - from, way) / dot(way, way), 0.0, 1.0);
    return length(point - from - way * along);
}

/// Of two segments: the crossing of their lines, or an end.
inline double segments_distance(const Vec& p, const Vec& q, const Vec& r, const Vec& s) {
    double best = std::min({point_segment(p, r, s),
                            point_segment(q, r, s),
                            point_segment(r, p, q),
                            point_segment(s, p, q)});
    const Vec u = q - p;
    const Vec v = s - r;
    const Vec w = p - r;
    const double uu = dot(u, u);
    const double uv = dot(u, v);
    const double vv = dot(v, v);
    const double across = uu * vv - uv * uv;
    if (across > 1e-12 * uu * vv) {
        const double a = (uv * dot(v, w) - vv * dot(u, w)) / across;
        const double b = (uu * dot(v, w) - uv * dot(u, w)) / across;
        if (a >= 0 && a <= 1 && b >= 0 && b <= 1) {
            best = std::min(best, length(w + u * a - v * b));
        }
    }
    return best;
}

inline double Solid::distance(const Vec& point) const {
    double inside = -1e9;
    double outside = 1e9;
    for (std::size_t index = 0; index < triangles.size(); ++index) {
        const double above = height(index, point);
        inside = std::max(inside, above);
        const auto& [i, j, k] = triangles[index];
        const std::size_t corner[3] = {i, j, k};
        bool over = above >= 0;
        for (int side = 0; side < 3; ++side) {
            const Vec& from = vertices[corner[side]];
            const Vec& to = vertices[corner[(side + 1) % 3]];
            over = over && dot(cross(normals[index], to - from), point - from) >= 0;
            outside = std::min(outside, point_segment(point, from, to));
        }
        outside = over ? std::min(outside, above) : outside;
    }
    return inside <= 0 ? inside : outside;
}

/// Largest separation over the normals of all faces and all pairs of edges: exact overlap where
/// negative.
inline double axes_separation(const Solid& a, const Solid& b) {
    double best = -1e9;
    const auto test = [&](const Vec& axis) {
        const auto range_a = a.extent(axis);
        const auto range_b = b.extent(axis);
        best = std::max({best, range_b[0] - range_a[1], range_a[0] - range_b[1]});
    };
    for (const Vec& normal : a.normals) {
        test(normal);
    }
    for (const Vec& normal : b.normals) {
        test(normal);
    }
    for (const auto& [i, j] : a.edges) {
        for (const auto& [k, l] : b.edges) {
            const Vec axis = cross(a.vertices[j] - a.vertices[i], b.vertices[l] - b.vertices[k]);
            const double size = length(axis);
            if (size > 1e-3 * length(a.vertices[j] - a.vertices[i]) *
                           length(b.vertices[l] - b.vertices[k])) {
                test(axis * (1 / size));
            }
        }
    }
    return best;
}

/// From all pairs of features; 0 or less where they overlap.
inline double distance(const Solid& a, const Solid& b) {
    const double axes = axes_separation(a, b);
    if (axes <= 0) {
        return axes;
    }
    double best = 1e9;
    for (const Vec& vertex : a.vertices) {
        best = std::min(best, b.distance(vertex));
    }
    for (const Vec& vertex : b.vertices) {
        best = std::min(best, a.distance(vertex));
    }
    for (const auto& [i, j] : a.edges) {
        for (const auto& [k, l] : b.edges) {
            best = std::min(
                best,
                segments_distance(a.vertices[i], a.vertices[j], b.vertices[k], b.vertices[l]));
        }
    }
    return best;
}

} // namespace lockwind::reference
