#pragma once

#include "geometry/shape_instance.h"

#include "lockwind/fixed.h"
#include "lockwind/int128.h"

#include <cstdint>

namespace lockwind {

/// Q19.44 m^2: squares of Q9.22 lengths are exact in it.
using SquareMetres = Fixed<std::int64_t, 44>;

/// Principal moments of inertia about the centre divided by the mass (squared gyration radii), in
/// the shape's own axes. For spheres, boxes and capsules. Relative error < 1e-8.
///   sphere: 2/5 r^2
///   box:    (h_j^2 + h_k^2) / 3
///   capsule of radius r, segment half height h, about y: r^2 (15 h + 8 r) / (10 (3 h + 2 r)),
///           across: (20 h^3 + 40 r h^2 + 45 r^2 h + 16 r^3) / (20 (3 h + 2 r))
/// (cylinder and two half spheres by the parallel-axis theorem).
struct UnitInertia {
    SquareMetres moment[3];

    friend bool operator==(const UnitInertia&, const UnitInertia&) = default;
};
UnitInertia unit_inertia(ShapeType type, const std::int32_t size[3]);

/// mantissa / 2^fraction m^3.
struct Volume {
    std::uint64_t mantissa;
    int fraction;

    friend bool operator==(const Volume&, const Volume&) = default;
};

/// The leading 64 bits of value / 2^fraction.
Volume leading_bits(const UInt128& value, int fraction);

/// Of a sphere, box or capsule; relative error < 1e-8.
///   sphere: 4/3 pi r^3; box: 8 h_x h_y h_z; capsule: pi r^2 (2 h + 4/3 r)
Volume volume_of(ShapeType type, const std::int32_t size[3]);

/// density x volume, to the nearest; saturates at the largest Real.
Real mass_of(const Volume& volume, Real density);

/// The same of a sphere, box or capsule; relative error < 1e-8 or 2^-32 kg.
Real mass_of(ShapeType type, const std::int32_t size[3], Real density);

} // namespace lockwind
