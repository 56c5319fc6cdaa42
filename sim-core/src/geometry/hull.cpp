#include "geometry/hull.h"

#include "geometry/hull_mass.h"
#include "geometry/hull_surface.h"
#include "geometry/rotation.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/wide.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace lockwind {

namespace {

std::string text_of(Real value) {
    const auto millimetres = static_cast<std::uint64_t>(
        round_shift(raw_multiply(value.raw(), std::int64_t{1000}), Real::kFraction));
    std::string digits = std::to_string(millimetres % 1000);
    digits.insert(0, 3 - digits.size(), '0');
    return std::to_string(millimetres / 1000) + "." + digits + " m";
}

std::string text_of_length(std::int64_t length) {
    return text_of(Real::from_raw(length << (Real::kFraction - kLengthFraction)));
}

/// As they will be stored, sorted, each once.
Result<std::vector<HullPoint>> stored_points(std::span<const Vec3> points) {
    if (points.size() > kHullPointsMax) {
        return Error{"has " + std::to_string(points.size()) + " points; give at most " +
                     std::to_string(kHullPointsMax)};
    }
    std::vector<HullPoint> stored;
    for (std::size_t index = 0; index < points.size(); ++index) {
        const Vec3& point = points[index];
        for (const Real coordinate : {point.x, point.y, point.z}) {
            if (coordinate < -kShapeSizeMax || coordinate > kShapeSizeMax) {
                return Error{"has a coordinate beyond " + text_of(kShapeSizeMax) + " in point " +
                             std::to_string(index)};
            }
        }
        stored.push_back({convert<Length>(point.x).raw(),
                          convert<Length>(point.y).raw(),
                          convert<Length>(point.z).raw()});
    }
    std::sort(stored.begin(), stored.end());
    stored.erase(std::unique(stored.begin(), stored.end()), stored.end());
    if (stored.size() < 4) {
        return Error{"has " + std::to_string(stored.size()) +
                     (stored.size() == 1 ? " point" : " different points") +
                     "; give at least 4 that stand out of one plane"};
    }
    return stored;
}

/// floor(|v|) + 1, v below 2^31 each.
std::int64_t length_above(const std::int64_t v[3]) {
    std::uint64_t square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        square += static_cast<std::uint64_t>(v[axis] * v[axis]);
    }
    return static_cast<std::int64_t>(floor_sqrt(square)) + 1;
}

/// Puts a surface into the frame of its principal axes.
class HullMaker {
public:
    explicit HullMaker(const HullSurface& surface) : surface_(surface) {}

    Result<Hull> run();

private:
    std::optional<Error> place_vertices();
    void make_faces();
    std::uint8_t edge_between(std::uint8_t from, std::uint8_t to, std::uint8_t face);
    void make_edges();
    std::optional<Error> measure();

    const HullSurface& surface_;
    HullSurface turned_; // the same about the centre and principal axes, rounded
    Hull hull_{};
};

std::optional<Error> HullMaker::place_vertices() {
    const HullMass mass = mass_of_hull(surface_);
    std::copy(mass.orientation, mass.orientation + 4, hull_.orientation);
    hull_.volume = mass.volume;
    hull_.inertia = mass.inertia;
    std::int32_t rotation[9];
    rotation_matrix(hull_.orientation, rotation);
    turned_.faces = surface_.faces;
    std::int64_t radius = 0;
    for (const HullPoint& point : surface_.vertices) {
        std::int64_t from_centre[3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            from_centre[axis] = point[axis] - mass.centre[axis];
        }
        radius = std::max(radius, length_above(from_centre));
        std::int64_t local[3];
        inverse_rotate(rotation, from_centre, local);
        turned_.vertices.push_back({raw_saturate<std::int32_t>(local[0]),
                                    raw_saturate<std::int32_t>(local[1]),
                                    raw_saturate<std::int32_t>(local[2])});
    }
    if (radius > convert<Length>(kFixedRadiusMax).raw()) {
        return Error{"reaches " + text_of_length(radius) +
                     " from its centre of mass; that may be at most " + text_of(kFixedRadiusMax)};
    }
    hull_.bounding_radius = raw_narrow<std::int32_t>(radius + 1); // the turn rounds
    for (std::size_t axis = 0; axis < 3; ++axis) {
        hull_.centre[axis] = raw_narrow<std::int32_t>(mass.centre[axis]);
    }
    hull_.vertex_count = static_cast<std::uint32_t>(turned_.vertices.size());
    for (std::size_t vertex = 0; vertex < turned_.vertices.size(); ++vertex) {
        std::copy(turned_.vertices[vertex].begin(),
                  turned_.vertices[vertex].end(),
                  hull_.vertices[vertex].place);
    }
    return std::nullopt;
}

void HullMaker::make_faces() {
    hull_.face_count = static_cast<std::uint32_t>(turned_.faces.size());
    std::uint16_t next_corner = 0;
    for (std::size_t index = 0; index < turned_.faces.size(); ++index) {
        const std::vector<std::uint32_t>& corners = turned_.faces[index];
        HullFace& face = hull_.faces[index];
        unit_of(face_area(turned_, corners), face.normal);
        std::int64_t offset = std::numeric_limits<std::int64_t>::min();
        for (const HullPoint& point : turned_.vertices) {
            offset = std::max(offset, round_unit_wide(dot_wide(face.normal, point.data())));
        }
        face.offset = raw_narrow<std::int32_t>(offset);
        face.first_corner = next_corner;
        face.corner_count = static_cast<std::uint16_t>(corners.size());
        for (const std::uint32_t vertex : corners) {
            hull_.corners[next_corner++].vertex = static_cast<std::uint8_t>(vertex);
            hull_.vertices[vertex].faces |= std::uint64_t{1} << index;
        }
    }
}

/// Index of the edge from `from` to `to` as the corner of this face; made if no face had it yet.
std::uint8_t HullMaker::edge_between(std::uint8_t from, std::uint8_t to, std::uint8_t face) {
    const auto end = hull_.edges.begin() + hull_.edge_count;
    const auto edge = std::find_if(hull_.edges.begin(), end, [&](const HullEdge& known) {
        return known.from == to && known.to == from;
    });
    if (edge != end) {
        edge->right = face;
    } else {
        ++hull_.edge_count;
        *edge = {{}, from, to, face, 0};
        std::array<Int128, 3> way{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            way[axis] = std::int64_t{turned_.vertices[to][axis]} - turned_.vertices[from][axis];
        }
        unit_of(way, edge->direction);
    }
    return static_cast<std::uint8_t>(edge - hull_.edges.begin());
}

/// Edges in the order of the first face that has them.
void HullMaker::make_edges() {
    for (std::uint32_t index = 0; index < hull_.face_count; ++index) {
        const std::vector<std::uint32_t>& corners = turned_.faces[index];
        for (std::size_t corner = 0; corner < corners.size(); ++corner) {
            const auto from = static_cast<std::uint8_t>(corners[corner]);
            const auto to = static_cast<std::uint8_t>(corners[(corner + 1) % corners.size()]);
            hull_.corners[hull_.faces[index].first_corner + corner].edge =
                edge_between(from, to, static_cast<std::uint8_t>(index));
        }
    }
}

std::optional<Error> HullMaker::measure() {
    hull_.width_least = std::numeric_limits<std::int32_t>::max();
    for (std::uint32_t index = 0; index < hull_.face_count; ++index) {
        const HullFace& face = hull_.faces[index];
        std::int64_t lowest = face.offset;
        for (const HullPoint& point : turned_.vertices) {
            lowest = std::min(lowest, round_unit_wide(dot_wide(face.normal, point.data())));
        }
        const auto half = static_cast<std::int32_t>((face.offset - lowest) >> 1);
        hull_.width_most = std::max(hull_.width_most, half);
        hull_.width_least = std::min(hull_.width_least, half);
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (const HullPoint& point : turned_.vertices) {
            std::int64_t across[3] = {point[0], point[1], point[2]};
            across[axis] = 0;
            hull_.arm[axis] =
                std::max(hull_.arm[axis], static_cast<std::int32_t>(length_above(across)));
        }
    }
    if (hull_.width_least < convert<Length>(kShapeSizeMin).raw()) {
        return Error{"is too thin: " + text_of_length(2 * std::int64_t{hull_.width_least}) +
                     " across a face; that must be at least " + text_of(2 * kShapeSizeMin)};
    }
    return std::nullopt;
}

Result<Hull> HullMaker::run() {
    if (std::optional<Error> error = place_vertices(); error) {
        return *error;
    }
    make_faces();
    make_edges();
    if (std::optional<Error> error = measure(); error) {
        return *error;
    }
    return hull_;
}

std::string too_many(std::size_t count, const char* what, std::uint32_t limit) {
    return "has " + std::to_string(count) + " " + what + "; it may have at most " +
           std::to_string(limit);
}

} // namespace

Result<Hull> make_hull(std::span<const Vec3> points) {
    const Result<std::vector<HullPoint>> stored = stored_points(points);
    if (!stored) {
        return stored.error();
    }
    Result<HullSurface> surface = triangulated_hull(stored.value());
    if (!surface) {
        return surface.error();
    }
    merge_flat_faces(surface.value());
    const HullSurface& merged = surface.value();
    if (merged.vertices.size() > kHullVerticesMax) {
        return Error{too_many(merged.vertices.size(), "vertices", kHullVerticesMax)};
    }
    if (merged.faces.size() > kHullFacesMax) {
        return Error{too_many(merged.faces.size(), "faces", kHullFacesMax)};
    }
    return HullMaker(merged).run();
}

} // namespace lockwind
