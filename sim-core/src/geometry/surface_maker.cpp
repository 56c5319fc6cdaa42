#include "geometry/surface_maker.h"

#include "geometry/fixed_geometry.h"
#include "geometry/hull_surface.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/trig.h"
#include "lockwind/wide.h"

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

namespace lockwind {

namespace {

using Point = Surface::Point;
using Area = std::array<Int128, 3>;

/// (b - a) x (c - a), exact.
Area area_of(const Point& a, const Point& b, const Point& c) {
    Area area{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t j = (axis + 1) % 3;
        const std::size_t k = (axis + 2) % 3;
        const auto ab = [&](std::size_t i) { return std::int64_t{b[i]} - a[i]; };
        const auto ac = [&](std::size_t i) { return std::int64_t{c[i]} - a[i]; };
        area[axis] =
            raw_subtract(wide_product<Int128>(ab(j), ac(k)), wide_product<Int128>(ab(k), ac(j)));
    }
    return area;
}

/// floor(|a - b|), Q9.22.
std::int64_t distance_of(const Point& a, const Point& b) {
    UInt128 square{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::uint64_t way = raw_magnitude(std::int64_t{b[axis]} - a[axis]);
        square = square + multiply_wide(way, way);
    }
    return static_cast<std::int64_t>(floor_sqrt128(square));
}

/// Twice a triangle's area, Q.22 m^2, rounded down.
std::uint64_t length_of(const Area& area) {
    UInt128 square{};
    for (const Int128& component : area) {
        const std::uint64_t size =
            raw_magnitude(raw_narrow<std::int64_t>(shift_right(component, kLengthFraction)));
        square = square + multiply_wide(size, size);
    }
    return floor_sqrt128(square);
}

/// The triangle's angle at a corner, 2^20 a turn.
std::int64_t angle_at(const Point& corner, const Point& next, const Point& former) {
    std::int32_t ways[2][3];
    const Point* ends[2] = {&next, &former};
    for (int end = 0; end < 2; ++end) {
        std::int32_t way[3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            way[axis] = raw_narrow<std::int32_t>(std::int64_t{(*ends[end])[axis]} - corner[axis]);
        }
        normalise(way, ways[end]);
    }
    const std::int64_t cosine = round_unit_wide(dot_wide(ways[0], ways[1]));
    const std::int64_t one = std::int64_t{kUnitOne} * kUnitOne;
    const std::int64_t square = std::max<std::int64_t>(one - cosine * cosine, 0);
    const auto sine = static_cast<std::int64_t>(floor_sqrt(static_cast<std::uint64_t>(square)));
    constexpr int kTurnShift = 64 - 20;
    return static_cast<std::int64_t>(
        atan2_angle(Real::from_raw(sine), Real::from_raw(cosine)).raw() >> kTurnShift);
}

/// An edge as one of its triangles has it.
struct Side {
    std::uint32_t low; // vertices
    std::uint32_t high;
    std::uint32_t triangle;
    std::uint32_t corner; // where it begins
    bool upwards;         // from low to high
};

} // namespace

/// Points at one place become the first of them.
void SurfaceMaker::weld() {
    std::vector<std::uint32_t> order(points_.size());
    for (std::uint32_t index = 0; index < order.size(); ++index) {
        order[index] = index;
    }
    std::sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
        return std::tie(points_[a], a) < std::tie(points_[b], b);
    });
    std::vector<std::uint32_t> first(points_.size());
    for (std::size_t index = 0; index < order.size(); ++index) {
        const bool same = index > 0 && points_[order[index]] == points_[order[index - 1]];
        first[order[index]] = same ? first[order[index - 1]] : order[index];
    }
    for (std::uint32_t& index : indices_) {
        index = first[index];
    }
}

/// Moves the vertices that triangles have about the middle of their bounds.
std::optional<Error> SurfaceMaker::centre() {
    Point low = points_[indices_[0]];
    Point high = low;
    for (const std::uint32_t vertex : indices_) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], points_[vertex][axis]);
            high[axis] = std::max(high[axis], points_[vertex][axis]);
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        surface_.centre_[axis] =
            static_cast<std::int32_t>((std::int64_t{low[axis]} + high[axis]) >> 1);
    }
    surface_.vertices_.resize(points_.size());
    std::int64_t radius = 0;
    for (const std::uint32_t vertex : indices_) {
        radius = std::max(radius, distance_of(points_[vertex], surface_.centre_) + 1);
    }
    const std::int64_t radius_max = convert<Length>(kFixedRadiusMax).raw();
    if (radius > radius_max) {
        return Error{"reaches " + std::to_string(radius >> kLengthFraction) +
                     " m from the middle of its bounds; that may be at most 434 m"};
    }
    surface_.bounding_radius_ = static_cast<std::int32_t>(radius);
    for (const std::uint32_t vertex : indices_) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            surface_.vertices_[vertex][axis] = points_[vertex][axis] - surface_.centre_[axis];
            surface_.half_extents_[axis] =
                std::max(surface_.half_extents_[axis], magnitude(surface_.vertices_[vertex][axis]));
        }
    }
    return std::nullopt;
}

std::optional<Error> SurfaceMaker::make_triangle(std::uint32_t index) {
    const std::string name = "triangle " + std::to_string(index);
    SurfaceTriangle triangle{{}, {kNoIndex, kNoIndex, kNoIndex}, {}};
    const Point* corners[3];
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
        triangle.corners[corner] = indices_[3 * std::size_t{index} + corner];
        corners[corner] = &surface_.vertices_[triangle.corners[corner]];
    }
    std::int64_t longest = 0;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        longest = std::max(longest, distance_of(*corners[corner], *corners[(corner + 1) % 3]));
    }
    if (longest > convert<Length>(kSurfaceCoordinateMax).raw()) {
        return Error{name + " has an edge of " + std::to_string(longest >> kLengthFraction) +
                     " m; it may be 500 m long"};
    }
    const Area area = area_of(*corners[0], *corners[1], *corners[2]);
    if (longest == 0 || length_of(area) == 0) {
        return Error{name + " has no area"};
    }
    const auto thickness_min =
        static_cast<std::uint64_t>(convert<Length>(kSurfaceThicknessMin).raw());
    if (length_of(area) < (static_cast<std::uint64_t>(longest) * thickness_min) >>
        kLengthFraction) {
        return Error{name + " is less than 1 mm across"};
    }
    unit_of(area, triangle.normal);
    surface_.triangles_.push_back(triangle);
    return std::nullopt;
}

void SurfaceMaker::join_neighbours() {
    std::vector<SurfaceTriangle>& triangles = surface_.triangles_;
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::uint32_t index = 0; index < triangles.size(); ++index) {
        for (std::uint32_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t from = triangles[index].corners[corner];
            const std::uint32_t to = triangles[index].corners[(corner + 1) % 3];
            sides.push_back({std::min(from, to), std::max(from, to), index, corner, from < to});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.triangle, a.corner) <
               std::tie(b.low, b.high, b.triangle, b.corner);
    });
    for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
        while (end < sides.size() && sides[end].low == sides[first].low &&
               sides[end].high == sides[first].high) {
            ++end;
        }
        if (end - first == 2 && sides[first].upwards != sides[first + 1].upwards) {
            const Side& a = sides[first];
            const Side& b = sides[first + 1];
            triangles[a.triangle].neighbours[a.corner] = b.triangle;
            triangles[b.triangle].neighbours[b.corner] = a.triangle;
        }
    }
}

/// Each triangle names the next vertex of each of its own; where it has no neighbour, both ends.
void SurfaceMaker::make_rings() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const SurfaceTriangle& triangle : surface_.triangles_) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t from = triangle.corners[corner];
            const std::uint32_t to = triangle.corners[(corner + 1) % 3];
            edges.emplace_back(from, to);
            if (triangle.neighbours[corner] == kNoIndex) {
                edges.emplace_back(to, from);
            }
        }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    surface_.ring_starts_.assign(surface_.vertices_.size() + 1, 0);
    for (const auto& [from, to] : edges) {
        ++surface_.ring_starts_[std::size_t{from} + 1];
        surface_.rings_.push_back(to);
    }
    for (std::size_t vertex = 0; vertex < surface_.vertices_.size(); ++vertex) {
        surface_.ring_starts_[vertex + 1] += surface_.ring_starts_[vertex];
    }
}

void SurfaceMaker::make_outwards() {
    std::vector<std::array<std::int64_t, 3>> sums(surface_.vertices_.size());
    for (const SurfaceTriangle& triangle : surface_.triangles_) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = triangle.corners[corner];
            const std::int64_t angle =
                angle_at(surface_.vertices_[vertex],
                         surface_.vertices_[triangle.corners[(corner + 1) % 3]],
                         surface_.vertices_[triangle.corners[(corner + 2) % 3]]);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                // 2^30 2^19 for each of fewer than 2^14 triangles, or their sum wraps.
                sums[vertex][axis] = raw_add(sums[vertex][axis], angle * triangle.normal[axis]);
            }
        }
    }
    surface_.outwards_.resize(surface_.vertices_.size());
    for (std::size_t vertex = 0; vertex < sums.size(); ++vertex) {
        const auto& [x, y, z] = sums[vertex];
        if ((x | y | z) != 0) {
            unit_of({Int128(x), Int128(y), Int128(z)}, surface_.outwards_[vertex].data());
        }
    }
}

void SurfaceMaker::make_tree() {
    std::vector<Bounds> bounds;
    bounds.reserve(surface_.triangles_.size());
    for (std::uint32_t index = 0; index < surface_.triangle_count(); ++index) {
        bounds.push_back(surface_.triangle_bounds(index));
    }
    surface_.tree_ = BoundsTree(static_cast<std::uint32_t>(bounds.size()));
    surface_.tree_.build(bounds);
}

Result<Surface> SurfaceMaker::run() {
    weld();
    if (std::optional<Error> error = centre(); error) {
        return *error;
    }
    for (std::uint32_t index = 0; index < indices_.size() / 3; ++index) {
        if (std::optional<Error> error = make_triangle(index); error) {
            return *error;
        }
    }
    join_neighbours();
    make_rings();
    make_outwards();
    make_tree();
    return std::move(surface_);
}

} // namespace lockwind
