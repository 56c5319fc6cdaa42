#include "geometry/simplex.h"

#include "geometry/fixed_geometry.h"

#include "lockwind/integer.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr int kUnitWide = 60;

// Places are below 2^29 and their differences below 2^30, so that a dot or cross product fits an
// int64, and what multiplies it by one more place, or by another such product, 128 bits.

std::int64_t dot64(const std::int64_t a[3], const std::int64_t b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Int128 dot128(const std::int64_t a[3], const std::int64_t b[3]) {
    return raw_add(raw_add(wide_product<Int128>(a[0], b[0]), wide_product<Int128>(a[1], b[1])),
                   wide_product<Int128>(a[2], b[2]));
}

struct Way {
    std::int64_t by[3];
};

Way between(const SimplexCorner& from, const SimplexCorner& to) {
    return {
        {to.place[0] - from.place[0], to.place[1] - from.place[1], to.place[2] - from.place[2]}};
}

Way cross(const Way& a, const Way& b) {
    return {{a.by[1] * b.by[2] - a.by[2] * b.by[1],
             a.by[2] * b.by[0] - a.by[0] * b.by[2],
             a.by[0] * b.by[1] - a.by[1] * b.by[0]}};
}

int sign_of(const Int128& value) {
    return value < Int128(0) ? -1 : (value == Int128(0) ? 0 : 1);
}

UInt128 magnitude_of(const Int128& value) {
    const Int128 positive = value < Int128(0) ? raw_subtract(Int128(0), value) : value;
    return {static_cast<std::uint64_t>(raw_narrow<std::int64_t>(shift_right(positive, 64))),
            low_limb(positive)};
}

/// Completes a feature whose exact direction is `direction` (0: the origin lies on it).
void measure(const Int128 direction[3], SimplexFeature& feature) {
    int bits = 0;
    for (int axis = 0; axis < 3; ++axis) {
        bits = std::max(bits, bit_width(magnitude_of(direction[axis])));
    }
    if (bits == 0) {
        feature.count = 0;
        return;
    }
    std::int64_t scaled[3];
    for (int axis = 0; axis < 3; ++axis) {
        scaled[axis] = raw_narrow<std::int64_t>(
            bits > kUnitWide ? shift_right(direction[axis], bits - kUnitWide)
                             : raw_shift_left(direction[axis], kUnitWide - bits));
    }
    const auto length =
        static_cast<std::int64_t>(floor_sqrt128(magnitude_of(dot128(scaled, scaled))));
    for (int axis = 0; axis < 3; ++axis) {
        feature.unit[axis] = multiply_divide(scaled[axis], std::int64_t{1} << kUnitWide, length);
        feature.normal[axis] =
            raw_narrow<std::int32_t>(round_shift(feature.unit[axis], kUnitWide - kUnitFraction));
    }
    feature.distance = raw_narrow<std::int64_t>(
        round_shift(dot128(feature.unit, feature.corners[0].place), kUnitWide - 30));
}

SimplexFeature nearest_to_corner(const SimplexCorner& a) {
    SimplexFeature feature{};
    feature.corners[0] = a;
    feature.count = 1;
    feature.weights[0] = Int128(1);
    const Int128 direction[3] = {Int128(a.place[0]), Int128(a.place[1]), Int128(a.place[2])};
    measure(direction, feature);
    return feature;
}

SimplexFeature nearest_to_edge(const SimplexCorner& a, const SimplexCorner& b) {
    const Way ab = between(a, b);
    const std::int64_t along = -dot64(a.place, ab.by);
    const std::int64_t whole = dot64(ab.by, ab.by);
    if (along <= 0) {
        return nearest_to_corner(a);
    }
    if (along >= whole) {
        return nearest_to_corner(b);
    }
    SimplexFeature feature{};
    feature.corners[0] = a;
    feature.corners[1] = b;
    feature.count = 2;
    feature.weights[0] = Int128(whole - along);
    feature.weights[1] = Int128(along);
    Int128 direction[3];
    for (int axis = 0; axis < 3; ++axis) {
        direction[axis] = raw_add(wide_product<Int128>(a.place[axis], whole),
                                  wide_product<Int128>(ab.by[axis], along));
    }
    measure(direction, feature);
    return feature;
}

/// a b - c d
Int128 minor_of(std::int64_t a, std::int64_t b, std::int64_t c, std::int64_t d) {
    return raw_subtract(wide_product<Int128>(a, b), wide_product<Int128>(c, d));
}

SimplexFeature
nearest_to_face(const SimplexCorner& a, const SimplexCorner& b, const SimplexCorner& c) {
    const Way ab = between(a, b);
    const Way ac = between(a, c);
    // Names as in Ericson's ClosestPtPointTriangle; the point is the origin.
    const std::int64_t d1 = -dot64(ab.by, a.place);
    const std::int64_t d2 = -dot64(ac.by, a.place);
    if (d1 <= 0 && d2 <= 0) {
        return nearest_to_corner(a);
    }
    const std::int64_t d3 = -dot64(ab.by, b.place);
    const std::int64_t d4 = -dot64(ac.by, b.place);
    if (d3 >= 0 && d4 <= d3) {
        return nearest_to_corner(b);
    }
    const Int128 vc = minor_of(d1, d4, d3, d2);
    if (sign_of(vc) <= 0 && d1 >= 0 && d3 <= 0) {
        return nearest_to_edge(a, b);
    }
    const std::int64_t d5 = -dot64(ab.by, c.place);
    const std::int64_t d6 = -dot64(ac.by, c.place);
    if (d6 >= 0 && d5 <= d6) {
        return nearest_to_corner(c);
    }
    const Int128 vb = minor_of(d5, d2, d1, d6);
    if (sign_of(vb) <= 0 && d2 >= 0 && d6 <= 0) {
        return nearest_to_edge(a, c);
    }
    const Int128 va = minor_of(d3, d6, d5, d4);
    if (sign_of(va) <= 0 && d4 >= d3 && d5 >= d6) {
        return nearest_to_edge(b, c);
    }
    SimplexFeature feature{{a, b, c}, 3, {va, vb, vc}, {}, {}, 0};
    const Way across = cross(ab, ac);
    const int side = sign_of(dot128(across.by, a.place));
    Int128 direction[3];
    for (int axis = 0; axis < 3; ++axis) {
        direction[axis] = wide_product<Int128>(across.by[axis], side);
    }
    measure(direction, feature);
    return feature;
}

/// Whether the origin lies beyond the face a b c, seen from d; of a flat tetrahedron, always.
bool is_beyond(const SimplexCorner& a,
               const SimplexCorner& b,
               const SimplexCorner& c,
               const SimplexCorner& d) {
    const Way across = cross(between(a, b), between(a, c));
    const int inner = sign_of(dot128(across.by, between(a, d).by));
    const int origin = -sign_of(dot128(across.by, a.place));
    return inner == 0 || inner * origin < 0;
}

SimplexFeature nearest_to_tetrahedron(const SimplexCorner corners[4]) {
    constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    SimplexFeature nearest{};
    bool found = false;
    for (const int* face : kFaces) {
        const SimplexCorner& a = corners[face[0]];
        const SimplexCorner& b = corners[face[1]];
        const SimplexCorner& c = corners[face[2]];
        if (!is_beyond(a, b, c, corners[face[3]])) {
            continue;
        }
        const SimplexFeature feature = nearest_to_face(a, b, c);
        if (feature.count == 0) {
            return feature;
        }
        if (!found || feature.distance < nearest.distance) {
            nearest = feature;
            found = true;
        }
    }
    return nearest;
}

} // namespace

SimplexFeature nearest_feature(const Simplex& simplex) {
    const SimplexCorner* corners = simplex.corners;
    switch (simplex.count) {
    case 1:
        return nearest_to_corner(corners[0]);
    case 2:
        return nearest_to_edge(corners[0], corners[1]);
    case 3:
        return nearest_to_face(corners[0], corners[1], corners[2]);
    default:
        return nearest_to_tetrahedron(corners);
    }
}

} // namespace lockwind
