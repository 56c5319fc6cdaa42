#include "geometry/ray_cast.h"

#include "geometry/bounds_probe.h"
#include "geometry/compound.h"
#include "geometry/fixed_geometry.h"
#include "geometry/hull.h"
#include "geometry/rotation.h"
#include "geometry/surface.h"
#include "geometry/triangle.h"

#include "lockwind/int128.h"
#include "lockwind/integer.h"
#include "lockwind/overflow.h"

#include <bit>
#include <initializer_list>

namespace lockwind {

namespace {

constexpr int kRayFraction = 32;
/// A point this close to where two surfaces of a capsule join belongs to either, Q31.32.
constexpr std::int64_t kSeam = 16;
/// Rounding of a start on the surface, Q31.32.
constexpr std::int64_t kStartError = 8;

/// A point of the segment: numerator / denominator of it, both >= 0.
struct Fraction {
    std::int64_t numerator;
    std::int64_t denominator;
};

/// a < b, exactly.
bool before(const Fraction& a, const Fraction& b) {
    return multiply_wide(raw_magnitude(a.numerator), raw_magnitude(b.denominator)) <
           multiply_wide(raw_magnitude(b.numerator), raw_magnitude(a.denominator));
}

/// The segment in the shape's frame, Q31.32, |.| < 2^50.
struct LocalRay {
    std::int64_t start[3];
    std::int64_t way[3];

    std::int64_t at(int axis, const Fraction& fraction) const {
        return start[axis] + multiply_divide(way[axis], fraction.numerator, fraction.denominator);
    }
};

struct LocalHit {
    Fraction fraction;
    std::int32_t normal[3]; // Q2.30, local
    std::uint32_t part = 0;
};

std::int64_t widened(std::int32_t length) {
    return static_cast<std::int64_t>(length) << (kRayFraction - kLengthFraction);
}

/// Slabs (Kay and Kajiya 1986) on exact fractions: the latest entry must precede the earliest exit.
bool cast_box(const LocalRay& ray, const std::int32_t half_extents[3], LocalHit& hit) {
    Fraction enter{-1, 1};
    Fraction leave{1, 1};
    int face = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t half = widened(half_extents[axis]);
        const std::int64_t way = magnitude(ray.way[axis]);
        // Seen along the way: from -half to half.
        const std::int64_t start = ray.way[axis] < 0 ? -ray.start[axis] : ray.start[axis];
        if (way == 0) {
            if (magnitude(start) > half) {
                return false;
            }
            continue;
        }
        const Fraction out{half - start, way};
        if (out.numerator < 0) {
            return false;
        }
        leave = before(out, leave) ? out : leave;
        const Fraction in{-half - start, way};
        if (in.numerator >= 0 && (enter.numerator < 0 || before(enter, in))) {
            enter = in;
            face = axis;
        }
    }
    if (enter.numerator < 0 || before(leave, enter)) {
        return false;
    }
    hit.fraction = enter;
    hit.normal[0] = hit.normal[1] = hit.normal[2] = 0;
    hit.normal[face] = ray.way[face] < 0 ? kUnitOne : -kUnitOne;
    return true;
}

/// Clips the segment against the faces (Cyrus and Beck 1978), on exact fractions of heights that
/// are rounded to 2^-32 m.
bool cast_hull(const LocalRay& ray, const Hull& hull, LocalHit& hit) {
    Fraction enter{-1, 1};
    Fraction leave{1, 1};
    std::uint32_t entered = 0;
    for (std::uint32_t index = 0; index < hull.face_count; ++index) {
        const HullFace& face = hull.faces[index];
        const std::int64_t start = dot_unit(face.normal, ray.start) - widened(face.offset);
        const std::int64_t way = dot_unit(face.normal, ray.way);
        if (way >= 0) {
            if (start > 0) {
                return false;
            }
            const Fraction out{-start, way};
            leave = way > 0 && before(out, leave) ? out : leave;
            continue;
        }
        const Fraction in{start, -way};
        if (start >= 0 && (enter.numerator < 0 || before(enter, in))) {
            enter = in;
            entered = index;
        }
    }
    if (enter.numerator < 0 || before(leave, enter)) {
        return false;
    }
    hit.fraction = enter;
    for (int axis = 0; axis < 3; ++axis) {
        hit.normal[axis] = hull.faces[entered].normal[axis];
    }
    return true;
}

bool cast_plane(const LocalRay& ray, LocalHit& hit) {
    if (ray.start[1] < 0 || ray.way[1] >= 0 || ray.start[1] > -ray.way[1]) {
        return false;
    }
    hit = {{ray.start[1], -ray.way[1]}, {0, kUnitOne, 0}};
    return true;
}

/// A segment and a ball about the origin, in two (then the third entries are 0) or three
/// dimensions.
struct BallEntry {
    Fraction fraction;
    std::int64_t point[3]; // relative to the ball's centre, Q31.32
};

Int128 dot128(const std::int64_t a[3], const std::int64_t b[3]) {
    return raw_add(raw_add(wide_product<Int128>(a[0], b[0]), wide_product<Int128>(a[1], b[1])),
                   wide_product<Int128>(a[2], b[2]));
}

bool is_inside(const std::int64_t point[3], std::int64_t radius) {
    return dot128(point, point) < wide_product<Int128>(radius, radius);
}

/// Where the segment enters the ball. Works about the ray's point nearest to the centre, so that
/// digits are not lost to the ray's length; the direction is a unit vector in Q2.60.
bool enter_ball(const std::int64_t start[3],
                const std::int64_t way[3],
                std::int64_t radius,
                BallEntry& entry) {
    constexpr int kDirectionFraction = 60;
    const auto bits =
        static_cast<std::uint64_t>(magnitude(way[0]) | magnitude(way[1]) | magnitude(way[2]));
    if (bits == 0 || is_inside(start, radius)) {
        return false;
    }
    const int shift = std::countl_zero(bits) - 4; // scaled components below 2^60
    std::int64_t scaled[3];
    for (int axis = 0; axis < 3; ++axis) {
        scaled[axis] = way[axis] * (std::int64_t{1} << shift);
    }
    const Int128 square = dot128(scaled, scaled);
    const auto length = static_cast<std::int64_t>(floor_sqrt128(
        {static_cast<std::uint64_t>(raw_narrow<std::int64_t>(shift_right(square, 64))),
         low_limb(square)}));
    std::int64_t direction[3];
    for (int axis = 0; axis < 3; ++axis) {
        direction[axis] =
            multiply_divide(scaled[axis], std::int64_t{1} << kDirectionFraction, length);
    }
    const auto nearest = raw_narrow<std::int64_t>(
        round_shift(raw_subtract(Int128(0), dot128(start, direction)), kDirectionFraction));
    std::int64_t foot[3];
    for (int axis = 0; axis < 3; ++axis) {
        foot[axis] =
            start[axis] + raw_narrow<std::int64_t>(round_shift(
                              wide_product<Int128>(direction[axis], nearest), kDirectionFraction));
    }
    const Int128 left = raw_subtract(wide_product<Int128>(radius, radius), dot128(foot, foot));
    if (left < Int128(0)) {
        return false;
    }
    const auto half = static_cast<std::int64_t>(
        floor_sqrt128({static_cast<std::uint64_t>(raw_narrow<std::int64_t>(shift_right(left, 64))),
                       low_limb(left)}));
    std::int64_t distance = nearest - half;
    distance = distance < 0 && distance >= -kStartError ? 0 : distance;
    if (distance < 0 || distance > length >> shift) {
        return false;
    }
    entry.fraction = {distance << shift, length};
    for (int axis = 0; axis < 3; ++axis) {
        entry.point[axis] =
            foot[axis] - raw_narrow<std::int64_t>(round_shift(
                             wide_product<Int128>(direction[axis], half), kDirectionFraction));
    }
    return true;
}

void take_entry(const BallEntry& entry, LocalHit& hit) {
    hit.fraction = entry.fraction;
    std::int32_t outwards[3];
    const auto bits = static_cast<std::uint64_t>(
        magnitude(entry.point[0]) | magnitude(entry.point[1]) | magnitude(entry.point[2]));
    const int shift = 34 - std::countl_zero(bits); // to 30 bits
    for (int axis = 0; axis < 3; ++axis) {
        outwards[axis] =
            static_cast<std::int32_t>(shift > 0 ? entry.point[axis] >> shift : entry.point[axis]);
    }
    normalise(outwards, hit.normal);
}

bool cast_sphere(const LocalRay& ray, std::int32_t radius, LocalHit& hit) {
    BallEntry entry{};
    if (!enter_ball(ray.start, ray.way, widened(radius), entry)) {
        return false;
    }
    take_entry(entry, hit);
    return true;
}

/// The side's entry if it lies between the ends, else the earlier of the end balls' on their own
/// side.
bool cast_capsule(const LocalRay& ray, const std::int32_t size[3], LocalHit& hit) {
    const std::int64_t radius = widened(size[0]);
    const std::int64_t half = widened(size[1]);
    const std::int64_t from_segment[3] = {
        ray.start[0], ray.start[1] - clamped(ray.start[1], -half, half), ray.start[2]};
    if (is_inside(from_segment, radius)) {
        return false;
    }
    BallEntry entry{};
    const std::int64_t side_start[3] = {ray.start[0], 0, ray.start[2]};
    const std::int64_t side_way[3] = {ray.way[0], 0, ray.way[2]};
    if (enter_ball(side_start, side_way, radius, entry) &&
        magnitude(ray.at(1, entry.fraction)) <= half) {
        take_entry(entry, hit);
        return true;
    }
    bool found = false;
    for (const std::int64_t sign : {-1, 1}) {
        const std::int64_t start[3] = {ray.start[0], ray.start[1] - sign * half, ray.start[2]};
        if (enter_ball(start, ray.way, radius, entry) && sign * entry.point[1] >= -kSeam &&
            (!found || before(entry.fraction, hit.fraction))) {
            take_entry(entry, hit);
            found = true;
        }
    }
    return found;
}

/// Whether a point of the triangle's plane (Q31.32) lies in it, or at its edge: by 1 um farther
/// than it reaches, so that no ray slips through between neighbours.
bool is_within(const Triangle& triangle, const std::int64_t point[3]) {
    constexpr std::int64_t kSlack = std::int64_t{1} << (kRayFraction - 20);
    for (int edge = 0; edge < 3; ++edge) {
        std::int64_t from_corner[3];
        for (int axis = 0; axis < 3; ++axis) {
            from_corner[axis] = point[axis] - widened(triangle.corners[edge][axis]);
        }
        if (dot_unit(triangle.edges[edge].outwards, from_corner) > kSlack) {
            return false;
        }
    }
    return true;
}

/// From its front alone.
bool cast_triangle(const LocalRay& ray,
                   const Surface& surface,
                   std::uint32_t index,
                   LocalHit& hit) {
    const std::int32_t* normal = surface.triangle(index).normal;
    const std::int32_t* corner = surface.corner(index, 0);
    std::int64_t from_corner[3];
    for (int axis = 0; axis < 3; ++axis) {
        from_corner[axis] = ray.start[axis] - widened(corner[axis]);
    }
    const std::int64_t height = dot_unit(normal, from_corner);
    const std::int64_t down = -dot_unit(normal, ray.way);
    if (height < 0 || down <= 0 || height > down) {
        return false;
    }
    const Fraction fraction{height, down};
    const std::int64_t point[3] = {ray.at(0, fraction), ray.at(1, fraction), ray.at(2, fraction)};
    if (!is_within(triangle_of(surface, index), point)) {
        return false;
    }
    hit = {fraction, {normal[0], normal[1], normal[2]}, index};
    return true;
}

/// Of hits at one place that of the lowest part counts.
bool is_sooner(const LocalHit& hit, const LocalHit& other) {
    return before(hit.fraction, other.fraction) ||
           (!before(other.fraction, hit.fraction) && hit.part < other.part);
}

bool cast_surface(const LocalRay& ray, const Surface& surface, LocalHit& nearest) {
    constexpr std::int32_t kNoExtents[3] = {0, 0, 0};
    SegmentProbe probe(ray.start, ray.way, kNoExtents);
    bool found = false;
    surface.tree().visit(probe, [&](std::uint32_t index) {
        LocalHit hit{};
        if (cast_triangle(ray, surface, index, hit) && (!found || is_sooner(hit, nearest))) {
            found = true;
            nearest = hit;
            const Fraction& at = hit.fraction;
            probe.shorten(
                multiply_divide(at.numerator, std::int64_t{1} << kRayFraction, at.denominator));
        }
    });
    return found;
}

bool cast_convex(const ShapeInstance& shape, const LocalRay& ray, LocalHit& hit) {
    switch (shape.type) {
    case ShapeType::sphere:
        return cast_sphere(ray, shape.size[0], hit);
    case ShapeType::capsule:
        return cast_capsule(ray, shape.size, hit);
    case ShapeType::box:
        return cast_box(ray, shape.size, hit);
    case ShapeType::plane:
        return cast_plane(ray, hit);
    case ShapeType::hull:
        return cast_hull(ray, *shape.hull, hit);
    default:
        return false;
    }
}

bool cast_compound(const LocalRay& ray, const Compound& compound, LocalHit& nearest) {
    bool found = false;
    for (std::uint32_t index = 0; index < compound.child_count; ++index) {
        const CompoundShape& child = compound.children[index];
        const ShapeInstance shape{
            child.type, {child.size[0], child.size[1], child.size[2]}, child.rotation, child.hull};
        std::int64_t start[3];
        for (int axis = 0; axis < 3; ++axis) {
            start[axis] = ray.start[axis] - widened(child.position[axis]);
        }
        LocalRay turned{};
        inverse_rotate(child.rotation, start, turned.start);
        inverse_rotate(child.rotation, ray.way, turned.way);
        LocalHit hit{};
        if (cast_convex(shape, turned, hit)) {
            hit.part = index;
            if (!found || is_sooner(hit, nearest)) {
                found = true;
                nearest.fraction = hit.fraction;
                nearest.part = index;
                rotate(child.rotation, hit.normal, nearest.normal);
            }
        }
    }
    return found;
}

bool cast_local(const ShapeInstance& shape, const LocalRay& ray, LocalHit& hit) {
    switch (shape.type) {
    case ShapeType::compound:
        return cast_compound(ray, *shape.compound, hit);
    case ShapeType::height_field:
    case ShapeType::mesh:
        return cast_surface(ray, *shape.surface, hit);
    default:
        return cast_convex(shape, ray, hit);
    }
}

bool in_range(const std::int64_t point[3]) {
    constexpr std::int64_t kLimit = kRayCoordinateMax << kRayFraction;
    for (int axis = 0; axis < 3; ++axis) {
        if (point[axis] > kLimit || point[axis] < -kLimit) {
            return false;
        }
    }
    return true;
}

} // namespace

bool ray_cast(const ShapeInstance& shape,
              const std::int64_t centre[3],
              const std::int64_t from[3],
              const std::int64_t to[3],
              ShapeRayHit& hit) {
    if (!in_range(centre) || !in_range(from) || !in_range(to)) {
        return false;
    }
    const bool turned = shape.type != ShapeType::sphere;
    const std::int32_t* rotation = turned ? shape.rotation : kIdentityRotation;
    std::int64_t start[3];
    std::int64_t way[3];
    for (int axis = 0; axis < 3; ++axis) {
        start[axis] = from[axis] - centre[axis];
        way[axis] = to[axis] - from[axis];
    }
    LocalRay ray{};
    inverse_rotate(rotation, start, ray.start);
    inverse_rotate(rotation, way, ray.way);
    LocalHit local{};
    if ((way[0] | way[1] | way[2]) == 0 || !cast_local(shape, ray, local)) {
        return false;
    }
    const Fraction& at = local.fraction;
    hit.fraction = multiply_divide(at.numerator, std::int64_t{1} << kRayFraction, at.denominator);
    for (int axis = 0; axis < 3; ++axis) {
        hit.point[axis] = from[axis] + multiply_divide(way[axis], at.numerator, at.denominator);
    }
    rotate(rotation, local.normal, hit.normal);
    hit.part = local.part;
    return true;
}

} // namespace lockwind
