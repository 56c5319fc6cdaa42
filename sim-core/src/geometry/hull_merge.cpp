#include "geometry/hull.h"
#include "geometry/hull_surface.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace lockwind {

namespace {

using Face = std::vector<std::uint32_t>;

constexpr std::uint32_t kNone = 0xffffffffU;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

int bits_of(const Int128& value) {
    const Int128 size = value < Int128(0) ? raw_subtract(Int128(0), value) : value;
    return bit_width(
        UInt128{static_cast<std::uint64_t>(raw_narrow<std::int64_t>(shift_right(size, 64))),
                low_limb(size)});
}

/// Which face has the edge from one vertex to another.
class EdgeTable {
public:
    explicit EdgeTable(const HullSurface& surface)
        : count_(surface.vertices.size()), faces_(count_ * count_, kNone) {
        for (std::uint32_t face = 0; face < surface.faces.size(); ++face) {
            const Face& corners = surface.faces[face];
            for (std::size_t corner = 0; corner < corners.size(); ++corner) {
                faces_[corners[corner] * count_ + corners[(corner + 1) % corners.size()]] = face;
            }
        }
    }
    std::uint32_t face(std::uint32_t from, std::uint32_t to) const {
        return faces_[from * count_ + to];
    }

private:
    std::size_t count_;
    std::vector<std::uint32_t> faces_;
};

/// The edges that a face shares with another: `count` from corner `first` on.
struct Seam {
    std::size_t first = 0;
    std::size_t count = 0;
};

/// Count 0 where they have none in common, or not in one row.
Seam seam_between(const EdgeTable& edges, const Face& corners, std::uint32_t other) {
    const std::size_t size = corners.size();
    const auto is_shared = [&](std::size_t corner) {
        return edges.face(corners[(corner + 1) % size], corners[corner % size]) == other;
    };
    Seam seam;
    std::size_t beginnings = 0;
    for (std::size_t corner = 0; corner < size; ++corner) {
        if (is_shared(corner)) {
            ++seam.count;
            if (!is_shared(corner + size - 1)) {
                ++beginnings;
                seam.first = corner;
            }
        }
    }
    return beginnings == 1 ? seam : Seam{};
}

/// Both faces without their seam.
Face united(const Face& first, const Seam& seam, const Face& second) {
    Face result;
    for (std::size_t step = seam.count; step <= first.size(); ++step) {
        result.push_back(first[(seam.first + step) % first.size()]);
    }
    const auto start = std::find(second.begin(), second.end(), first[seam.first]);
    const auto begin = static_cast<std::size_t>(start - second.begin());
    for (std::size_t step = 1; step + seam.count < second.size(); ++step) {
        result.push_back(second[(begin + step) % second.size()]);
    }
    return result;
}

/// How far apart the corners of both faces lie along the normal of the two together, Q52.
std::int64_t spread_of(const HullSurface& surface, const Face& first, const Face& second) {
    std::array<Int128, 3> area = face_area(surface, first);
    const std::array<Int128, 3> more = face_area(surface, second);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        area[axis] = raw_add(area[axis], more[axis]);
    }
    std::int32_t normal[3];
    unit_of(area, normal);
    std::int64_t low = kNever;
    std::int64_t high = std::numeric_limits<std::int64_t>::min();
    for (const Face* face : {&first, &second}) {
        for (const std::uint32_t vertex : *face) {
            const std::int64_t height = dot_wide(normal, surface.vertices[vertex].data());
            low = std::min(low, height);
            high = std::max(high, height);
        }
    }
    return high - low;
}

/// The two flattest neighbours.
struct FlatPair {
    std::uint32_t first = kNone;
    std::uint32_t second = kNone;
    std::int64_t spread = std::int64_t{kHullTolerance} << kUnitFraction;
};

FlatPair flattest_pair(const HullSurface& surface, const EdgeTable& edges) {
    FlatPair best;
    for (std::uint32_t first = 0; first < surface.faces.size(); ++first) {
        const Face& corners = surface.faces[first];
        for (std::size_t corner = 0; corner < corners.size(); ++corner) {
            const std::uint32_t second =
                edges.face(corners[(corner + 1) % corners.size()], corners[corner]);
            if (second < first) {
                continue; // seen from the other side
            }
            const Face& other = surface.faces[second];
            const Seam seam = seam_between(edges, corners, second);
            if (seam.count == 0 || corners.size() + other.size() < 2 * seam.count + 3) {
                continue;
            }
            const std::int64_t spread = spread_of(surface, corners, other);
            if (spread < best.spread) {
                best = {first, second, spread};
            }
        }
    }
    return best;
}

/// A vertex that only two faces have lies on the edge between them.
void drop_vertices_in_edges(HullSurface& surface) {
    std::vector<std::uint32_t> uses(surface.vertices.size(), 0);
    std::vector<std::size_t> least_size(surface.vertices.size(), kNone);
    for (const Face& face : surface.faces) {
        for (const std::uint32_t vertex : face) {
            ++uses[vertex];
            least_size[vertex] = std::min(least_size[vertex], face.size());
        }
    }
    // One that goes from one of the two must go from the other, or their edges no longer meet.
    for (Face& face : surface.faces) {
        face.erase(std::remove_if(face.begin(),
                                  face.end(),
                                  [&](std::uint32_t vertex) {
                                      return uses[vertex] == 2 && least_size[vertex] > 3;
                                  }),
                   face.end());
    }
}

/// Leaves out vertices that no face has, and sorts the faces.
void tidy(HullSurface& surface) {
    std::vector<std::uint32_t> index_of(surface.vertices.size(), kNone);
    for (const Face& face : surface.faces) {
        for (const std::uint32_t vertex : face) {
            index_of[vertex] = 0;
        }
    }
    std::vector<HullPoint> kept;
    for (std::size_t vertex = 0; vertex < index_of.size(); ++vertex) {
        if (index_of[vertex] != kNone) {
            index_of[vertex] = static_cast<std::uint32_t>(kept.size());
            kept.push_back(surface.vertices[vertex]);
        }
    }
    surface.vertices = kept;
    for (Face& face : surface.faces) {
        for (std::uint32_t& vertex : face) {
            vertex = index_of[vertex];
        }
        std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    }
    // Not by operator<: libstdc++ 12 compares vectors of unsigned numbers wrongly on big-endian
    // machines (GCC bug 113960).
    std::sort(surface.faces.begin(), surface.faces.end(), [](const Face& a, const Face& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    });
}

} // namespace

void unit_of(const std::array<Int128, 3>& vector, std::int32_t unit[3]) {
    // To 62 bits, so that neither a short nor a long one loses digits.
    const int excess = std::max({bits_of(vector[0]), bits_of(vector[1]), bits_of(vector[2])}) - 62;
    std::int64_t scaled[3];
    UInt128 square{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool negative = vector[axis] < Int128(0);
        const Int128 size = negative ? raw_subtract(Int128(0), vector[axis]) : vector[axis];
        const Int128 shifted =
            excess > 0 ? shift_right(size, excess) : raw_shift_left(size, -excess);
        scaled[axis] = raw_narrow<std::int64_t>(shifted);
        square = square + multiply_wide(raw_magnitude(scaled[axis]), raw_magnitude(scaled[axis]));
        scaled[axis] = negative ? -scaled[axis] : scaled[axis];
    }
    const auto length = static_cast<std::int64_t>(floor_sqrt128(square));
    constexpr std::int64_t kTwice = std::int64_t{2} << kUnitFraction;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t size = multiply_divide(magnitude(scaled[axis]), kTwice, length);
        const auto rounded = static_cast<std::int32_t>((size + 1) >> 1);
        unit[axis] = scaled[axis] < 0 ? -rounded : rounded;
    }
}

std::array<Int128, 3> face_area(const HullSurface& surface, std::span<const std::uint32_t> face) {
    std::array<Int128, 3> sum{};
    for (std::size_t corner = 1; corner + 1 < face.size(); ++corner) {
        const auto part = hull_normal(surface.vertices[face[0]],
                                      surface.vertices[face[corner]],
                                      surface.vertices[face[corner + 1]]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            sum[axis] = raw_add(sum[axis], Int128(part[axis]));
        }
    }
    return sum;
}

void merge_flat_faces(HullSurface& surface) {
    constexpr std::size_t kFacesMin = 4; // of a solid: fewer would have no volume
    tidy(surface);
    while (surface.faces.size() > kFacesMin) {
        const EdgeTable edges(surface);
        const FlatPair flat = flattest_pair(surface, edges);
        if (flat.first == kNone) {
            break;
        }
        Face& first = surface.faces[flat.first];
        const Seam seam = seam_between(edges, first, flat.second);
        first = united(first, seam, surface.faces[flat.second]);
        surface.faces.erase(surface.faces.begin() + flat.second);
        drop_vertices_in_edges(surface);
    }
    tidy(surface);
}

} // namespace lockwind
