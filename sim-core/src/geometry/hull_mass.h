#pragma once

#include "geometry/hull_surface.h"
#include "geometry/mass.h"

#include <cstdint>

namespace lockwind {

/// What a solid of one density weighs, and how it turns.
struct HullMass {
    Volume volume;
    std::int64_t centre[3]; // Q9.22 m, to the nearest
    std::int32_t
        orientation[4];  // Q2.30 x y z w: turns the principal axes' frame into the given one
    UnitInertia inertia; // about the principal axes
};

/// Integrals over the tetrahedra between the surface's triangles and a point (B. Mirtich, *Fast and
/// Accurate Computation of Polyhedral Mass Properties*, 1996; D. Eberly, *Polyhedral Mass
/// Properties (Revisited)*, 2002), exact until their quotients are rounded; a solid that reaches
/// more than 128 m from its middle is measured on a grid of 1 um.
HullMass mass_of_hull(const HullSurface& surface);

} // namespace lockwind
