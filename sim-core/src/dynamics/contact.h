#pragma once

#include "lockwind/schema.h"
#include "lockwind/types.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace lockwind {

/// Two bodies whose fat bounds overlap, at least one dynamic: row of the derived section "pair",
/// sorted by (row_a, row_b, child). Bodies that are made of parts have a row for each two parts
/// that may touch. The pairs follow from fat bounds and layers, what touches from the manifolds.
struct Pair {
    BodyRow row_a; // row_a < row_b
    BodyRow row_b;
    std::uint32_t child;      // which parts, see child_of(); 0 of bodies without
    std::uint32_t manifold;   // row of section "manifold"; kNoIndex unless touching
    std::uint8_t axis;        // that separated boxes or hulls last; touching, their manifold's
    std::uint8_t point_count; // 0 .. 4; 0 unless touching
    std::uint8_t zero[2];

    friend bool operator==(const Pair&, const Pair&) = default;
};
static_assert(sizeof(Pair) == 20);

/// The contact of a touching pair: row of section "manifold", found by Pair::manifold. A free slot
/// is all zero bytes (a live one has points); the lowest free slot is taken first.
///
/// It keeps the geometry of the tick that made it. The solver's rows use those anchors; the
/// separation follows the bodies: separation + normal . (centre_delta, anchors now - then), anchors
/// turned with their bodies from the orientations they had then. B's anchor is anchor_a -
/// centre_delta.
struct Manifold {
    BodyRow row_a; // of its pair
    BodyRow row_b;
    std::uint32_t child;
    std::int32_t normal[3];        // Q2.30, world, from A to B
    std::int32_t tangent[3];       // Q2.30, world; the second one is normal x tangent
    std::int32_t centre_delta[3];  // Q9.22 m: from centre A to centre B
    std::int32_t orientation_a[4]; // Q2.30 x y z w, unit; of a sphere the identity
    std::int32_t orientation_b[4];
    std::int32_t axis_separation; // Q9.22 m, see ManifoldCache
    std::uint8_t point_count;     // 1 .. 4; 0 in a free slot
    std::uint8_t axis;            // of boxes and hulls, see ManifoldCache
    std::uint8_t zero[2];
    // By point; entries past point_count are 0.
    std::int32_t separation[4]; // Q9.22 m
    std::uint32_t feature[4];
    std::int32_t anchor_a[4 * 3]; // Q9.22 m, world, from centre A; xyz of each point
};
static_assert(sizeof(Manifold) == 168);

/// What a manifold's contact bore in the last substep, impulse x (1/m_a + 1/m_b) in Q11.20 m/s: the
/// same row of section "contact_impulse". Apart from the manifold because it changes with every
/// step, and geometry that is recycled need not be copied and hashed again.
struct ContactImpulse {
    std::int32_t friction[2]; // along the tangents
    std::int32_t twist;       // at the smaller gyration radius
    std::int32_t normal[4];   // by point; entries past its point_count are 0
};
static_assert(sizeof(ContactImpulse) == 28);

inline constexpr std::array kPairFields{
    LOCKWIND_FIELD(Pair, row_a, 0, "", ""),
    LOCKWIND_FIELD(Pair, row_b, 0, "", ""),
    LOCKWIND_FIELD(Pair, child, 0, "", ""),
    LOCKWIND_FIELD(Pair, manifold, 0, "", ""),
    LOCKWIND_FIELD(Pair, axis, 0, "", ""),
    LOCKWIND_FIELD(Pair, point_count, 0, "", ""),
    LOCKWIND_FIELD(Pair, zero, 0, "", ""),
};

inline constexpr std::array kManifoldFields{
    LOCKWIND_FIELD(Manifold, row_a, 0, "", ""),
    LOCKWIND_FIELD(Manifold, row_b, 0, "", ""),
    LOCKWIND_FIELD(Manifold, child, 0, "", ""),
    LOCKWIND_FIELD(Manifold, normal, 30, "", "xyz"),
    LOCKWIND_FIELD(Manifold, tangent, 30, "", "xyz"),
    LOCKWIND_FIELD(Manifold, centre_delta, 22, "m", "xyz"),
    LOCKWIND_FIELD(Manifold, orientation_a, 30, "", "xyzw"),
    LOCKWIND_FIELD(Manifold, orientation_b, 30, "", "xyzw"),
    LOCKWIND_FIELD(Manifold, axis_separation, 22, "m", ""),
    LOCKWIND_FIELD(Manifold, point_count, 0, "", ""),
    LOCKWIND_FIELD(Manifold, axis, 0, "", ""),
    LOCKWIND_FIELD(Manifold, zero, 0, "", ""),
    LOCKWIND_FIELD(Manifold, separation, 22, "m", ""),
    LOCKWIND_FIELD(Manifold, feature, 0, "", ""),
    LOCKWIND_FIELD(Manifold, anchor_a, 22, "m", ""),
};

inline constexpr std::array kContactImpulseFields{
    LOCKWIND_FIELD(ContactImpulse, friction, 20, "m/s", ""),
    LOCKWIND_FIELD(ContactImpulse, twist, 20, "m/s", ""),
    LOCKWIND_FIELD(ContactImpulse, normal, 20, "m/s", ""),
};

} // namespace lockwind
