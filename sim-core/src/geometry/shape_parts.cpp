#include "geometry/shape_parts.h"

#include "geometry/bounds_probe.h"
#include "geometry/compound.h"
#include "geometry/fixed_geometry.h"
#include "geometry/rotation.h"
#include "geometry/surface.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr int kFiner = 32 - kLengthFraction;

/// Half extents of a core's bounds along a turned frame's axes, rounded up.
void turned_extents(const std::int32_t* rotation, const ConvexCore& core, std::int32_t out[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        std::int64_t sum = 0;
        for (int row = 0; row < 3; ++row) {
            sum += std::int64_t{magnitude(rotation[3 * row + axis])} * core.half_extents[row];
        }
        out[axis] = raw_saturate<std::int32_t>(round_unit_wide(sum) + 2);
    }
}

/// The nearest of several parts.
struct NearestPart {
    ShapeDistance& out;
    std::int64_t limit;
    std::uint32_t part = 0;
    bool found = false;

    void offer(const ShapeDistance& distance, std::uint32_t index, const std::int32_t offset[3]) {
        const std::int64_t size = distance.overlapping ? 0 : distance.distance;
        if (size > limit || (found && size == limit && index > part)) {
            return;
        }
        out = distance;
        for (int axis = 0; axis < 3; ++axis) {
            out.point[axis] += std::int64_t{offset[axis]} << kFiner;
        }
        part = index;
        limit = size;
        found = true;
    }
};

void distance_to_compound(const ConvexCore& a,
                          const std::int64_t delta[3],
                          const ShapeInstance& b,
                          NearestPart& nearest) {
    for (std::uint32_t child = 0; child < b.compound->child_count; ++child) {
        const CompoundPart part(b, child);
        std::int64_t from_part[3];
        for (int axis = 0; axis < 3; ++axis) {
            from_part[axis] = delta[axis] - (std::int64_t{part.offset[axis]} << kFiner);
        }
        ConvexCore core;
        make_core(part.shape, core);
        ShapeDistance distance{};
        shape_distance(a, core, from_part, distance);
        nearest.offer(distance, child, part.offset);
    }
}

void distance_to_surface(const ConvexCore& a,
                         const std::int64_t delta[3],
                         const ShapeInstance& b,
                         NearestPart& nearest) {
    constexpr std::int32_t kNoOffset[3] = {0, 0, 0};
    // From the core's centre: what is within its reach and radius of what is looked for.
    constexpr std::int64_t kFarthest = std::int64_t{1} << (17 + 32);
    const std::int64_t reach = (std::int64_t{a.reach} + a.radius) << kFiner;
    const auto within = [&] { return std::min(nearest.limit, kFarthest) + reach; };
    std::int64_t place[3];
    inverse_rotate(b.rotation, delta, place);
    PointProbe probe(place, within());
    b.surface->tree().visit(probe, [&](std::uint32_t index) {
        ConvexCore core;
        make_triangle_core(b, index, core);
        ShapeDistance distance{};
        shape_distance(a, core, delta, distance);
        nearest.offer(distance, index, kNoOffset);
        probe.shorten(within());
    });
}

/// The first of several parts.
struct FirstPart {
    ConvexCastHit& hit;
    std::uint32_t part = 0;
    bool found = false;

    bool offer(const ConvexCastHit& other, std::uint32_t index) {
        if (found &&
            (other.fraction > hit.fraction || (other.fraction == hit.fraction && index > part))) {
            return false;
        }
        hit = other;
        part = index;
        found = true;
        return true;
    }
};

void cast_at_compound(const ConvexCore& shape,
                      const std::int64_t start[3],
                      const std::int64_t way[3],
                      const ShapeInstance& body,
                      const std::int64_t centre[3],
                      FirstPart& first) {
    for (std::uint32_t child = 0; child < body.compound->child_count; ++child) {
        const CompoundPart part(body, child);
        std::int64_t place[3];
        for (int axis = 0; axis < 3; ++axis) {
            place[axis] = centre[axis] + (std::int64_t{part.offset[axis]} << kFiner);
        }
        ConvexCore core;
        make_core(part.shape, core);
        ConvexCastHit hit{};
        if (shape_cast(shape, start, way, core, place, hit)) {
            first.offer(hit, child);
        }
    }
}

void cast_at_surface(const ConvexCore& shape,
                     const std::int64_t start[3],
                     const std::int64_t way[3],
                     const ShapeInstance& body,
                     const std::int64_t centre[3],
                     FirstPart& first) {
    std::int64_t delta[3];
    for (int axis = 0; axis < 3; ++axis) {
        delta[axis] = start[axis] - centre[axis];
    }
    std::int64_t local_start[3];
    std::int64_t local_way[3];
    std::int32_t extents[3];
    inverse_rotate(body.rotation, delta, local_start);
    inverse_rotate(body.rotation, way, local_way);
    turned_extents(body.rotation, shape, extents);
    SegmentProbe probe(local_start, local_way, extents);
    body.surface->tree().visit(probe, [&](std::uint32_t index) {
        // What leaves through the front is not stopped, but tells what it overlaps.
        constexpr std::int64_t kNowhere[3] = {0, 0, 0};
        const bool leaves = dot_unit(body.surface->triangle(index).normal, local_way) > 0;
        ConvexCore core;
        make_triangle_core(body, index, core);
        ConvexCastHit hit{};
        if (shape_cast(shape, start, leaves ? kNowhere : way, core, centre, hit) &&
            first.offer(hit, index)) {
            probe.shorten(hit.fraction);
        }
    });
}

} // namespace

bool distance_to_shape(const ConvexCore& a,
                       const std::int64_t delta[3],
                       const ShapeInstance& b,
                       std::int64_t limit,
                       ShapeDistance& out) {
    NearestPart nearest{out, limit};
    if (b.type == ShapeType::compound) {
        distance_to_compound(a, delta, b, nearest);
    } else if (is_surface(b.type)) {
        distance_to_surface(a, delta, b, nearest);
    } else {
        constexpr std::int32_t kNoOffset[3] = {0, 0, 0};
        ConvexCore core;
        make_core(b, core);
        ShapeDistance distance{};
        shape_distance(a, core, delta, distance);
        nearest.offer(distance, 0, kNoOffset);
    }
    return nearest.found;
}

bool cast_at_shape(const ConvexCore& shape,
                   const std::int64_t start[3],
                   const std::int64_t way[3],
                   const ShapeInstance& body,
                   const std::int64_t centre[3],
                   ConvexCastHit& hit) {
    FirstPart first{hit};
    if (body.type == ShapeType::compound) {
        cast_at_compound(shape, start, way, body, centre, first);
        return first.found;
    }
    if (is_surface(body.type)) {
        cast_at_surface(shape, start, way, body, centre, first);
        return first.found;
    }
    ConvexCore core;
    make_core(body, core);
    return shape_cast(shape, start, way, core, centre, hit);
}

} // namespace lockwind
