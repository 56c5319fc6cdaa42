#pragma once

#include "lockwind/types.h"
#include "lockwind/vector.h"
#include "lockwind/world_definition.h"

#include <cstdint>

namespace lockwind {

/// Which bodies a query sees.
struct QueryFilter {
    std::uint32_t layers = kAllLayers; // bit L: bodies of layer L
    bool sensors = true;               // sensors too
    BodyId ignore = 0;                 // but not this one
};

/// Where a segment enters a body.
struct RayHit {
    BodyId body;
    Real fraction; // of the ray, 0 .. 1
    Vec3 point;    // m
    Vec3 normal;   // unit, out of the body
    bool operator==(const RayHit&) const = default;
};

/// Where a shape that moves first meets a body.
struct ShapeCastHit {
    BodyId body;
    Real fraction; // of the translation, 0 .. 1, rounded down
    Vec3 point;    // m, on the body: where it is met, or one such place of many
    Vec3 normal;   // unit, out of the body; 0 where the shape overlaps it at the start
    bool operator==(const ShapeCastHit&) const = default;
};

/// The place on bodies' surfaces that is nearest to a point.
struct ClosestPoint {
    BodyId body;
    Real distance; // m; 0 within the body
    Vec3 point;    // m, on the surface; the point itself within the body
    Vec3 normal;   // unit, out of the body; 0 within the body
    bool operator==(const ClosestPoint&) const = default;
};

} // namespace lockwind
