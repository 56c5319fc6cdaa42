#pragma once

#include "geometry/fixed_geometry.h"
#include "geometry/mass.h"

#include "lockwind/result.h"
#include "lockwind/shape.h"

#include <array>
#include <cstdint>
#include <span>

namespace lockwind {

/// Euler's formula: V - E + F = 2.
inline constexpr std::uint32_t kHullEdgesMax = kHullVerticesMax + kHullFacesMax - 2;

/// 122 um, Q9.22. Points that stand out of the hull of the others by no more are left out of it,
/// and a face's vertices may lie as far apart along its normal: decimals that were rounded, or a
/// mesh of single precision, still give the quadrangles that were meant.
inline constexpr std::int32_t kHullTolerance = 512;

struct HullVertex {
    std::int32_t place[3]; // Q9.22 m
    std::uint64_t faces;   // bit f: the vertex is a corner of face f

    friend bool operator==(const HullVertex&, const HullVertex&) = default;
};

/// The hull lies below: normal . x <= offset, within an ulp.
struct HullFace {
    std::int32_t normal[3];     // Q2.30, outwards
    std::int32_t offset;        // Q9.22 m
    std::uint16_t first_corner; // counter-clockwise, seen from outside
    std::uint16_t corner_count;

    friend bool operator==(const HullFace&, const HullFace&) = default;
};

struct HullCorner {
    std::uint8_t vertex;
    std::uint8_t edge; // from here to the face's next corner

    friend bool operator==(const HullCorner&, const HullCorner&) = default;
};

struct HullEdge {
    std::int32_t direction[3]; // Q2.30, from -> to
    std::uint8_t from;
    std::uint8_t to;
    std::uint8_t
        left; // the face whose corners go from -> to; its normal x right's is the direction
    std::uint8_t right;

    friend bool operator==(const HullEdge&, const HullEdge&) = default;
};

/// A convex polytope in the frame of its principal axes, about its centre of mass. Never changes
/// once it is made.
struct Hull {
    std::uint32_t vertex_count;
    std::uint32_t face_count;
    std::uint32_t edge_count; // there are twice as many corners
    std::array<HullVertex, kHullVerticesMax> vertices;
    std::array<HullFace, kHullFacesMax> faces;
    std::array<HullEdge, kHullEdgesMax> edges;
    std::array<HullCorner, 2 * kHullEdgesMax> corners;

    // Where this frame lies in the one that the points were given in.
    std::int32_t centre[3];      // Q9.22 m
    std::int32_t orientation[4]; // Q2.30 x y z w; w >= 0

    std::int32_t bounding_radius; // Q9.22 m, rounded up
    std::int32_t arm[3];          // Q9.22 m, rounded up: of the farthest vertex from each axis
    std::int32_t width_most;      // Q9.22 m: half of the way across along a face's normal
    std::int32_t width_least;
    Volume volume;
    UnitInertia inertia; // principal moments / mass

    friend bool operator==(const Hull&, const Hull&) = default;
};

/// The convex hull of `points`, whatever their order: the same for every permutation, and for
/// points given twice. An Error says what is wrong, and reads after the hull's name.
Result<Hull> make_hull(std::span<const Vec3> points);

} // namespace lockwind
