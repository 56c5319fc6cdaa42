#include "geometry/hull_surface.h"

#include "geometry/hull.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <string>

namespace lockwind {

namespace {

using Normal = std::array<std::int64_t, 3>;

constexpr std::uint32_t kNone = 0xffffffffU;
/// Beyond this many the result cannot come down to kHullVerticesMax.
constexpr std::uint32_t kVerticesMax = 2 * kHullVerticesMax;
/// Distances are compared in 2^-8 of Q9.22.
constexpr int kDistanceFraction = 8;
constexpr std::uint64_t kDistanceMin = std::uint64_t{kHullTolerance} << kDistanceFraction;

UInt128 magnitude_of(const Int128& value) {
    const Int128 size = value < Int128(0) ? raw_subtract(Int128(0), value) : value;
    return {static_cast<std::uint64_t>(raw_narrow<std::int64_t>(shift_right(size, 64))),
            low_limb(size)};
}

std::uint64_t length_of(const Normal& v) {
    UInt128 square{};
    for (const std::int64_t component : v) {
        const std::uint64_t size = raw_magnitude(component);
        square = square + multiply_wide(size, size);
    }
    return floor_sqrt128(square);
}

Normal difference(const HullPoint& a, const HullPoint& b) {
    return {std::int64_t{b[0]} - a[0], std::int64_t{b[1]} - a[1], std::int64_t{b[2]} - a[2]};
}

struct Triangle {
    std::uint32_t vertex[3];
    std::uint32_t neighbour[3]; // across the edge from vertex[i] to the next
    Normal normal;              // exact, not a unit vector
    std::uint64_t length;       // of the normal
    bool alive;
    bool visible; // from the point that is being added
};

/// A point outside, and the face that it is farthest from among those it was compared with.
struct Outside {
    std::uint32_t point;
    std::uint32_t face;
    std::uint64_t distance;
};

class Builder {
public:
    explicit Builder(std::span<const HullPoint> points) : points_(points) {}

    std::optional<Error> run();
    const std::vector<Triangle>& triangles() const { return triangles_; }

private:
    std::optional<Error> begin();
    std::uint32_t add(std::uint32_t a, std::uint32_t b, std::uint32_t c);
    void link(std::uint32_t first, std::uint32_t second);
    std::uint64_t distance(const Triangle& face, std::uint32_t point) const;
    bool sees(std::uint32_t point, const Triangle& face) const;
    void assign(std::uint32_t point, std::size_t first_face);
    bool assign_all();
    void mark_visible(std::uint32_t point, std::uint32_t face);
    void replace_visible(std::uint32_t point);

    std::span<const HullPoint> points_;
    std::vector<Triangle> triangles_;
    std::vector<Outside> outside_;
    std::vector<std::uint32_t> seen_; // indices of the visible triangles
};

/// Above the face: 0 where not.
std::uint64_t Builder::distance(const Triangle& face, std::uint32_t point) const {
    const Int128 height = hull_height(face.normal, points_[face.vertex[0]], points_[point]);
    if (height < Int128(1)) {
        return 0;
    }
    return divide_wide(magnitude_of(height) << kDistanceFraction, face.length).low;
}

bool Builder::sees(std::uint32_t point, const Triangle& face) const {
    return Int128(0) < hull_height(face.normal, points_[face.vertex[0]], points_[point]);
}

std::uint32_t Builder::add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    Triangle face{{a, b, c}, {kNone, kNone, kNone}, {}, 0, true, false};
    face.normal = hull_normal(points_[a], points_[b], points_[c]);
    face.length = length_of(face.normal);
    triangles_.push_back(face);
    return static_cast<std::uint32_t>(triangles_.size() - 1);
}

/// Two triangles that share an edge learn of each other.
void Builder::link(std::uint32_t first, std::uint32_t second) {
    Triangle& a = triangles_[first];
    Triangle& b = triangles_[second];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (a.vertex[i] == b.vertex[(j + 1) % 3] && a.vertex[(i + 1) % 3] == b.vertex[j]) {
                a.neighbour[i] = second;
                b.neighbour[j] = first;
            }
        }
    }
}

/// The first tetrahedron: the lowest point, the farthest from it, from their line, from their
/// plane; of equals the lower.
std::optional<Error> Builder::begin() {
    const auto count = static_cast<std::uint32_t>(points_.size());
    std::uint32_t corner[4] = {0, 0, 0, 0};
    const auto farthest = [&](auto&& size_of, auto least) {
        std::uint32_t best = kNone;
        for (std::uint32_t point = 0; point < count; ++point) {
            const auto size = size_of(points_[point]);
            if (size > least) {
                least = size;
                best = point;
            }
        }
        return best;
    };
    corner[1] = farthest([&](const HullPoint& p) { return length_of(difference(points_[0], p)); },
                         std::uint64_t{0});
    const HullPoint& origin = points_[0];
    const HullPoint& second = points_[corner[1]];
    const std::uint64_t reach = length_of(difference(origin, second));
    corner[2] = farthest(
        [&](const HullPoint& p) { return length_of(hull_normal(origin, second, p)) / reach; },
        std::uint64_t{kHullTolerance});
    if (corner[2] == kNone) {
        return Error{"is a line: its points need to stand out of one plane"};
    }
    const Normal normal = hull_normal(origin, second, points_[corner[2]]);
    const std::uint64_t length = length_of(normal);
    corner[3] = farthest(
        [&](const HullPoint& p) {
            return divide_wide(magnitude_of(hull_height(normal, origin, p)), length).low;
        },
        std::uint64_t{kHullTolerance});
    if (corner[3] == kNone) {
        return Error{"is flat: its points need to stand out of one plane"};
    }
    if (Int128(0) < hull_height(normal, origin, points_[corner[3]])) {
        std::swap(corner[1], corner[2]);
    }
    add(corner[0], corner[1], corner[2]);
    add(corner[0], corner[3], corner[1]);
    add(corner[1], corner[3], corner[2]);
    add(corner[2], corner[3], corner[0]);
    for (std::uint32_t face = 0; face < 4; ++face) {
        for (std::uint32_t other = 0; other < face; ++other) {
            link(face, other);
        }
    }
    return std::nullopt;
}

/// Gives the point to the face that it is farthest above, of those from `first_face` on.
void Builder::assign(std::uint32_t point, std::size_t first_face) {
    Outside best{point, kNone, 0};
    for (std::size_t face = first_face; face < triangles_.size(); ++face) {
        const Triangle& triangle = triangles_[face];
        if (triangle.alive && sees(point, triangle)) {
            const std::uint64_t height = distance(triangle, point);
            if (best.face == kNone || height > best.distance) {
                best = {point, static_cast<std::uint32_t>(face), height};
            }
        }
    }
    if (best.face != kNone) {
        outside_.push_back(best);
    }
}

/// Compares all points with all faces: a point was perhaps given to a face that it is near to,
/// though another is farther. False where none is farther outside than the tolerance.
bool Builder::assign_all() {
    outside_.clear();
    for (std::uint32_t point = 0; point < points_.size(); ++point) {
        assign(point, 0);
    }
    return std::any_of(outside_.begin(), outside_.end(), [](const Outside& outside) {
        return outside.distance > kDistanceMin;
    });
}

void Builder::mark_visible(std::uint32_t point, std::uint32_t face) {
    seen_.assign(1, face);
    triangles_[face].visible = true;
    for (std::size_t index = 0; index < seen_.size(); ++index) {
        for (const std::uint32_t neighbour : triangles_[seen_[index]].neighbour) {
            if (!triangles_[neighbour].visible && sees(point, triangles_[neighbour])) {
                triangles_[neighbour].visible = true;
                seen_.push_back(neighbour);
            }
        }
    }
}

/// A triangle from the point to each edge of the horizon, in place of those that it sees.
void Builder::replace_visible(std::uint32_t point) {
    const std::size_t first_new = triangles_.size();
    for (const std::uint32_t index : seen_) {
        for (int side = 0; side < 3; ++side) {
            const Triangle triangle = triangles_[index];
            const std::uint32_t beyond = triangle.neighbour[side];
            if (!triangles_[beyond].visible) {
                const std::uint32_t made =
                    add(triangle.vertex[side], triangle.vertex[(side + 1) % 3], point);
                link(made, beyond);
            }
        }
    }
    for (std::size_t one = first_new; one < triangles_.size(); ++one) {
        for (std::size_t other = first_new; other < one; ++other) {
            link(static_cast<std::uint32_t>(one), static_cast<std::uint32_t>(other));
        }
    }
    for (const std::uint32_t index : seen_) {
        triangles_[index].alive = false;
    }
    std::vector<Outside> before;
    before.swap(outside_);
    for (const Outside& outside : before) {
        if (triangles_[outside.face].alive) {
            outside_.push_back(outside);
        } else if (outside.point != point) {
            assign(outside.point, first_new);
        }
    }
}

std::optional<Error> Builder::run() {
    if (std::optional<Error> error = begin(); error) {
        return error;
    }
    std::uint32_t vertices = 4;
    while (assign_all()) {
        for (;;) {
            const auto farthest = std::max_element(
                outside_.begin(), outside_.end(), [](const Outside& a, const Outside& b) {
                    return a.distance != b.distance ? a.distance < b.distance : a.point > b.point;
                });
            if (farthest == outside_.end() || farthest->distance <= kDistanceMin) {
                break;
            }
            if (++vertices > kVerticesMax) {
                return Error{"has more than " + std::to_string(kVerticesMax) +
                             " vertices; it may have at most " + std::to_string(kHullVerticesMax)};
            }
            const std::uint32_t point = farthest->point;
            mark_visible(point, farthest->face);
            replace_visible(point);
        }
    }
    return std::nullopt;
}

/// The vertex that a sliver, a triangle less high than the tolerance, has off its longest edge.
/// Such a vertex lies on that edge but for the tolerance, and the sliver's normal means nothing.
/// kNone where there is no sliver; of several, the flattest's.
std::uint32_t sliver_vertex(std::span<const HullPoint> points,
                            const std::vector<Triangle>& triangles) {
    std::uint64_t flattest = kDistanceMin;
    std::uint32_t result = kNone;
    for (const Triangle& triangle : triangles) {
        if (!triangle.alive) {
            continue;
        }
        std::uint64_t longest = 0;
        std::uint32_t apex = 0;
        for (int side = 0; side < 3; ++side) {
            const std::uint64_t length = length_of(
                difference(points[triangle.vertex[side]], points[triangle.vertex[(side + 1) % 3]]));
            if (length > longest) {
                longest = length;
                apex = triangle.vertex[(side + 2) % 3];
            }
        }
        const std::uint64_t height =
            divide_wide(UInt128{0, triangle.length} << kDistanceFraction, longest).low;
        if (height < flattest || (height == flattest && apex < result)) {
            flattest = height;
            result = apex;
        }
    }
    return result;
}

HullSurface surface_of(std::span<const HullPoint> points, const std::vector<Triangle>& triangles) {
    HullSurface surface;
    std::vector<std::uint32_t> index_of(points.size(), kNone);
    for (const Triangle& triangle : triangles) {
        if (triangle.alive) {
            for (const std::uint32_t vertex : triangle.vertex) {
                index_of[vertex] = 0;
            }
        }
    }
    for (std::uint32_t point = 0; point < points.size(); ++point) {
        if (index_of[point] != kNone) {
            index_of[point] = static_cast<std::uint32_t>(surface.vertices.size());
            surface.vertices.push_back(points[point]);
        }
    }
    for (const Triangle& triangle : triangles) {
        if (triangle.alive) {
            surface.faces.push_back({index_of[triangle.vertex[0]],
                                     index_of[triangle.vertex[1]],
                                     index_of[triangle.vertex[2]]});
        }
    }
    return surface;
}

} // namespace

std::array<std::int64_t, 3>
hull_normal(const HullPoint& a, const HullPoint& b, const HullPoint& c) {
    const Normal u = difference(a, b);
    const Normal v = difference(a, c);
    Normal normal{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t j = (axis + 1) % 3;
        const std::size_t k = (axis + 2) % 3;
        normal[axis] = raw_subtract(raw_multiply(u[j], v[k]), raw_multiply(u[k], v[j]));
    }
    return normal;
}

Int128 hull_height(const std::array<std::int64_t, 3>& normal,
                   const HullPoint& origin,
                   const HullPoint& point) {
    const Normal way = difference(origin, point);
    Int128 sum(0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        sum = raw_add(sum, wide_product<Int128>(normal[axis], way[axis]));
    }
    return sum;
}

Result<HullSurface> triangulated_hull(std::span<const HullPoint> points) {
    std::vector<HullPoint> kept(points.begin(), points.end());
    for (;;) {
        Builder builder(kept);
        if (std::optional<Error> error = builder.run(); error) {
            return *error;
        }
        const std::uint32_t sliver = sliver_vertex(kept, builder.triangles());
        if (sliver == kNone) {
            return surface_of(kept, builder.triangles());
        }
        kept.erase(kept.begin() + sliver);
    }
}

} // namespace lockwind
