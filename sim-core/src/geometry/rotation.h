#pragma once

#include "geometry/fixed_geometry.h"

#include <cstdint>

namespace lockwind {

/// Row-major 3x3 matrix (Q2.30) that turns a vector of the body's frame into the world's; columns
/// are the body's axes. `orientation` is a unit quaternion x y z w, Q2.30. Error of an entry <= 1.5
/// ulp + the quaternion's own distance from unit length.
void rotation_matrix(const std::int32_t orientation[4], std::int32_t rotation[9]);

inline constexpr std::int32_t kIdentityRotation[9] = {
    kUnitOne, 0, 0, 0, kUnitOne, 0, 0, 0, kUnitOne};

/// out = R v, v in Q9.22 with |v| < 512 m. `out` may not alias `v`.
inline void rotate(const std::int32_t* rotation, const std::int32_t v[3], std::int32_t out[3]) {
    for (int row = 0; row < 3; ++row) {
        out[row] = round_unit(dot_wide(rotation + 3 * row, v));
    }
}

/// out = R^T v, v in Q9.22 with |v| < 512 m. `out` may not alias `v`.
inline void
inverse_rotate(const std::int32_t* rotation, const std::int32_t v[3], std::int32_t out[3]) {
    for (int column = 0; column < 3; ++column) {
        out[column] = round_unit(static_cast<std::int64_t>(rotation[column]) * v[0] +
                                 static_cast<std::int64_t>(rotation[3 + column]) * v[1] +
                                 static_cast<std::int64_t>(rotation[6 + column]) * v[2]);
    }
}

/// Sum of unit[i] * v[i] for a 64-bit vector, |v| < 2^55, rounded back to v's format: exact but
/// for that one rounding, from two halves of v and without 128-bit products.
std::int64_t dot_unit(const std::int32_t unit[3], const std::int64_t v[3]);

/// The same turns for 64-bit vectors of any format, |v| < 2^55.
void rotate(const std::int32_t* rotation, const std::int64_t v[3], std::int64_t out[3]);
void inverse_rotate(const std::int32_t* rotation, const std::int64_t v[3], std::int64_t out[3]);

} // namespace lockwind
