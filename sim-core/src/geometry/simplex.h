#pragma once

#include "lockwind/int128.h"

#include <cstdint>

namespace lockwind {

/// A vertex of A - B on core_distance's grid, |place| < 2^29, and the points that made it.
struct SimplexCorner {
    std::int64_t place[3];
    std::uint32_t a;
    std::uint32_t b;
};

struct Simplex {
    SimplexCorner corners[4];
    std::uint32_t count;
};

/// The simplex's part nearest to the origin: a corner, edge or face, and where on it.
struct SimplexFeature {
    SimplexCorner corners[3];
    std::uint32_t count;    // 0: the origin lies in the simplex
    Int128 weights[3];      // >= 0, of the corners, up to a common factor
    std::int64_t unit[3];   // Q2.60: direction from the origin to it
    std::int32_t normal[3]; // the same, Q2.30
    std::int64_t distance;  // of it, Q.30 of a grid unit
};

/// Which feature is nearest is exact for one to three corners; of a tetrahedron's faces the nearest
/// is found to 2^-29 of a grid unit. Corners must differ.
SimplexFeature nearest_feature(const Simplex& simplex);

} // namespace lockwind
