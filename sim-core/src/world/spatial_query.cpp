#include "dynamics/make_body.h"
#include "geometry/bounds_probe.h"
#include "geometry/ray_cast.h"
#include "geometry/rotation.h"
#include "geometry/shape_parts.h"
#include "world/impl.h"

#include <algorithm>

namespace lockwind {

namespace {

Vec3 vector_of(const std::int64_t raw[3]) {
    return {Real::from_raw(raw[0]), Real::from_raw(raw[1]), Real::from_raw(raw[2])};
}

Vec3 unit_of(const std::int32_t raw[3]) {
    return {convert<Real>(Unit::from_raw(raw[0])),
            convert<Real>(Unit::from_raw(raw[1])),
            convert<Real>(Unit::from_raw(raw[2]))};
}

bool is_in_range(const Vec3& point) {
    constexpr Real kLimit = kRayCoordinateMax;
    return point.x <= kLimit && point.x >= -kLimit && point.y <= kLimit && point.y >= -kLimit &&
           point.z <= kLimit && point.z >= -kLimit;
}

/// Whether two ends are in range; their difference then fits.
bool is_way_in_range(const Vec3& from, const Vec3& way) {
    constexpr Real kLimit = 2 * kRayCoordinateMax;
    return is_in_range(from) && way.x <= kLimit && way.x >= -kLimit && way.y <= kLimit &&
           way.y >= -kLimit && way.z <= kLimit && way.z >= -kLimit && is_in_range(from + way);
}

/// The bodies of a world as one query sees them.
class Bodies {
public:
    Bodies(World::Impl& world, const QueryFilter& filter)
        : world_(world), filter_(filter), tables_(world.tables()) {
        world.query_index.refresh(tables_, world.shapes);
    }

    BodyId id(BodyRow row) const { return tables_.motion[row].id; }
    const std::int64_t* centre(BodyRow row) const { return tables_.motion[row].position; }
    ShapeInstance shape(BodyRow row) const {
        return world_.query_index.shape(row, tables_, world_.shapes);
    }
    /// Calls visit(row) for each body that the filter lets through and the probe does not refuse.
    template <class Probe, class Visit>
    void visit(const Probe& probe, Visit&& visit) const {
        world_.query_index.tree().visit(probe, [&](BodyRow row) {
            if (lets_through(row)) {
                visit(row);
            }
        });
    }
    /// From a body's centre to a point.
    void delta_to(const std::int64_t point[3], BodyRow row, std::int64_t delta[3]) const {
        for (int axis = 0; axis < 3; ++axis) {
            delta[axis] = point[axis] - centre(row)[axis];
        }
    }

private:
    bool lets_through(BodyRow row) const {
        const BodyProperties& properties = tables_.properties[row];
        return (filter_.layers >> properties.layer & 1U) != 0 &&
               (filter_.sensors || properties.sensor == 0) && id(row) != filter_.ignore;
    }

    World::Impl& world_;
    const QueryFilter& filter_;
    DynamicsTables tables_;
};

/// A shape that a query puts somewhere.
struct QueryShape {
    std::int32_t rotation[9];
    std::int64_t centre[3]; // Q31.32 m
    ShapeInstance instance; // `rotation` points into this
    ConvexCore core;

    QueryShape(const ShapeDefinition& shape,
               const Vec3& position,
               const RealQuat& orientation,
               const ShapeLibrary& shapes) {
        BodyMotion motion;
        BodyProperties properties;
        make_query_shape(shape, position, orientation, shapes, motion, properties);
        rotation_matrix(motion.orientation, rotation);
        std::copy(motion.position, motion.position + 3, centre);
        instance = shape_of(
            properties, shapes, shape.type == ShapeType::sphere ? kIdentityRotation : rotation);
        make_core(instance, core);
    }
    QueryShape(const QueryShape&) = delete;
    QueryShape& operator=(const QueryShape&) = delete;
};

/// A segment, cast at one body after the other.
struct RayCaster {
    const Bodies& bodies;
    std::int64_t start[3];
    std::int64_t end[3];

    std::optional<RayHit> hit(BodyRow row) const {
        ShapeRayHit found{};
        if (!lockwind::ray_cast(bodies.shape(row), bodies.centre(row), start, end, found)) {
            return std::nullopt;
        }
        return RayHit{bodies.id(row),
                      Real::from_raw(found.fraction),
                      vector_of(found.point),
                      unit_of(found.normal)};
    }
    SegmentProbe probe() const {
        const std::int64_t way[3] = {end[0] - start[0], end[1] - start[1], end[2] - start[2]};
        constexpr std::int32_t kNoExtents[3] = {0, 0, 0};
        return {start, way, kNoExtents};
    }
};

RayCaster ray_caster(const Bodies& bodies, const Vec3& from, const Vec3& to) {
    return {
        bodies, {from.x.raw(), from.y.raw(), from.z.raw()}, {to.x.raw(), to.y.raw(), to.z.raw()}};
}

/// The canonical order of hits, which is total: a body is hit once.
template <class Hit>
bool is_before(const Hit& a, const Hit& b) {
    return a.fraction != b.fraction ? a.fraction < b.fraction : a.body < b.body;
}

} // namespace

std::optional<RayHit>
World::ray_cast(const Vec3& from, const Vec3& to, const QueryFilter& filter) const {
    std::optional<RayHit> nearest;
    if (!is_in_range(from) || !is_in_range(to)) {
        return nearest;
    }
    const Bodies bodies(*impl_, filter);
    const RayCaster caster = ray_caster(bodies, from, to);
    SegmentProbe probe = caster.probe();
    bodies.visit(probe, [&](BodyRow row) {
        const std::optional<RayHit> hit = caster.hit(row);
        if (hit && (!nearest || is_before(*hit, *nearest))) {
            nearest = hit;
            probe.shorten(hit->fraction.raw());
        }
    });
    return nearest;
}

std::vector<RayHit>
World::ray_cast_all(const Vec3& from, const Vec3& to, const QueryFilter& filter) const {
    std::vector<RayHit> hits;
    if (!is_in_range(from) || !is_in_range(to)) {
        return hits;
    }
    const Bodies bodies(*impl_, filter);
    const RayCaster caster = ray_caster(bodies, from, to);
    bodies.visit(caster.probe(), [&](BodyRow row) {
        if (const std::optional<RayHit> hit = caster.hit(row)) {
            hits.push_back(*hit);
        }
    });
    std::sort(hits.begin(), hits.end(), is_before<RayHit>);
    return hits;
}

Status World::check_query_shape(const ShapeDefinition& shape) const {
    return lockwind::check_query_shape(shape, impl_->shapes);
}

std::vector<BodyId> World::overlap(const ShapeDefinition& shape,
                                   const Vec3& position,
                                   const RealQuat& orientation,
                                   const QueryFilter& filter) const {
    LOCKWIND_ASSERT(check_query_shape(shape).ok());
    std::vector<BodyId> ids;
    if (!is_in_range(position)) {
        return ids;
    }
    const Bodies bodies(*impl_, filter);
    const QueryShape placed(shape, position, orientation, impl_->shapes);
    const OverlapProbe probe(query_bounds(placed.instance, placed.centre));
    bodies.visit(probe, [&](BodyRow row) {
        std::int64_t delta[3];
        bodies.delta_to(placed.centre, row, delta);
        ShapeDistance distance{};
        if (distance_to_shape(placed.core, delta, bodies.shape(row), 0, distance)) {
            ids.push_back(bodies.id(row));
        }
    });
    std::sort(ids.begin(), ids.end());
    return ids;
}

std::optional<ClosestPoint>
World::closest_point(const Vec3& point, Real distance_max, const QueryFilter& filter) const {
    std::optional<ClosestPoint> nearest;
    if (!is_in_range(point) || distance_max < 0) {
        return nearest;
    }
    const Bodies bodies(*impl_, filter);
    constexpr Real kFarthest = 2 * kRayCoordinateMax;
    const Real limit = std::min(distance_max, kFarthest);
    const std::int64_t place[3] = {point.x.raw(), point.y.raw(), point.z.raw()};
    ConvexCore point_core;
    make_point_core(point_core);
    PointProbe probe(place, limit.raw());
    bodies.visit(probe, [&](BodyRow row) {
        std::int64_t delta[3];
        bodies.delta_to(place, row, delta);
        ShapeDistance found{};
        const std::int64_t farthest = nearest ? nearest->distance.raw() : limit.raw();
        if (!distance_to_shape(point_core, delta, bodies.shape(row), farthest, found)) {
            return;
        }
        ClosestPoint candidate{bodies.id(row), 0, point, {}};
        if (!found.overlapping) {
            candidate.distance = Real::from_raw(found.distance);
            candidate.point = vector_of(bodies.centre(row)) + vector_of(found.point);
            candidate.normal = unit_of(found.normal);
        }
        const bool is_nearer =
            !nearest || candidate.distance < nearest->distance ||
            (candidate.distance == nearest->distance && candidate.body < nearest->body);
        if (is_nearer) {
            nearest = candidate;
            probe.shorten(candidate.distance.raw());
        }
    });
    return nearest;
}

std::optional<ShapeCastHit> World::shape_cast(const ShapeDefinition& shape,
                                              const Vec3& position,
                                              const RealQuat& orientation,
                                              const Vec3& translation,
                                              const QueryFilter& filter) const {
    LOCKWIND_ASSERT(check_query_shape(shape).ok());
    std::optional<ShapeCastHit> first;
    if (!is_way_in_range(position, translation)) {
        return first;
    }
    const Bodies bodies(*impl_, filter);
    const QueryShape placed(shape, position, orientation, impl_->shapes);
    const std::int64_t way[3] = {translation.x.raw(), translation.y.raw(), translation.z.raw()};
    SegmentProbe probe(placed.centre, way, placed.core.half_extents);
    bodies.visit(probe, [&](BodyRow row) {
        ConvexCastHit found{};
        if (!cast_at_shape(
                placed.core, placed.centre, way, bodies.shape(row), bodies.centre(row), found)) {
            return;
        }
        const ShapeCastHit hit{bodies.id(row),
                               Real::from_raw(found.fraction),
                               vector_of(found.point),
                               unit_of(found.normal)};
        if (!first || is_before(hit, *first)) {
            first = hit;
            probe.shorten(found.fraction);
        }
    });
    return first;
}

} // namespace lockwind
