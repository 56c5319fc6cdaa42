#pragma once

#include "geometry/hull.h"
#include "geometry/mass.h"
#include "geometry/shape_instance.h"

#include "lockwind/result.h"
#include "lockwind/shape.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// A child of a compound, in the compound's own frame.
struct CompoundShape {
    ShapeType type;
    std::int32_t size[3]; // as of a ShapeInstance
    const Hull* hull;
    std::int32_t position[3]; // Q9.22 m, of its centre
    std::int32_t rotation[9]; // Q2.30, of its own axes
};

/// Convex shapes that move as one, in the frame of their principal axes about their centre of mass.
/// Never changes once it is made.
struct Compound {
    std::uint32_t child_count;
    CompoundShape children[kCompoundChildrenMax];

    // As of a Hull.
    std::int32_t centre[3];
    std::int32_t orientation[4];
    std::int32_t bounding_radius;
    std::int32_t arm[3];
    Volume volume; // by the children's densities
    UnitInertia inertia;
};

/// A child as a shape of its own. `shape` points into this.
struct CompoundPart {
    std::int32_t rotation[9];
    std::int32_t offset[3]; // Q9.22 m, world axes, from the compound's centre to its own
    ShapeInstance shape;

    CompoundPart(const ShapeInstance& compound, std::uint32_t child);
    CompoundPart(const CompoundPart&) = delete;
    CompoundPart& operator=(const CompoundPart&) = delete;
};

/// Whether a contact of a child with something outside lies at a seam: its place on the child's
/// surface is on another child too (within kLinearSlop), which a way along the normal leads less
/// straight away from than from this one. It is then the other's to tell. Point (Q9.22 m) and
/// outward normal (Q2.30) in the compound's own frame.
bool is_at_seam(const Compound& compound,
                std::uint32_t child,
                const std::int32_t point[3],
                const std::int32_t normal[3]);

/// Mass, centre and axes by the parallel axis theorem, rounded once a sum. `hulls` must outlive the
/// compound. An Error says what is wrong, and reads after the compound's name.
Result<Compound> make_compound(const CompoundDefinition& definition, std::span<const Hull> hulls);

} // namespace lockwind
