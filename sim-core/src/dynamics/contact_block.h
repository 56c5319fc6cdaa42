#pragma once

#include "dynamics/lanes.h"
#include "dynamics/solver_format.h"

#include "lockwind/types.h"

#include <cstdint>

namespace lockwind {

inline constexpr std::uint32_t kBlockPoints = 4;

/// Where a row of four that holds a vector has room for whether its body is wild.
inline constexpr int kWildEntry = 3;
inline constexpr std::int32_t kCalmMax = 64 * kVelocityOne;

/// A body's velocities while the substeps run, Q11.20 m/s; angular ones times the gyration radius.
/// Rows of four, so that a body is one vector register.
struct alignas(64) SolverBody {
    std::int32_t linear[4]; // and at kWildEntry 1 of a wild body, 0 of any other
    std::int32_t angular[4];
    std::int32_t linear_moved[4]; // velocities of the last position step
    std::int32_t angular_moved[4];
};

/// What prepare reads of a body, in one row, so that lanes can gather it four by four.
inline constexpr int kBodyTermCount = 16;
struct BodyTerms {
    std::int32_t entry[kBodyTermCount];

    std::int32_t* rotation() { return entry; } // 9, Q2.30
    std::int32_t* inverse_inertia() {
        return entry + 9;
    } // xx xy xz yy yz zz, world, Q5.26;
      // 0 unless dynamic
    const std::int32_t* inverse_inertia() const { return entry + 9; }
    std::int32_t& inverse_gyration_radius() { return entry[15]; } // Q7.24; 0 of a fixed body
};

/// Eight contacts, one a lane, of which no two share a dynamic body (but in the overflow colour).
///
/// Rows are normalised by K0 = 1/m_a + 1/m_b: an impulse is stored as lambda_hat = lambda K0, in
/// velocity units, and masses appear only as the shares 1/m / K0. A body's angular velocity and its
/// inertia are scaled by its gyration radius, so that every coefficient is of order one.
struct alignas(64) ContactBlock {
    template <class T>
    using Lanes = T[kBlockLanes];
    using Vector3 = std::int32_t[3][kBlockLanes];

    /// One row of a point: J = (-n, jacobian_a, n, jacobian_b), response = M^-1 J^T / K0.
    struct Row {
        Vector3 jacobian_a; // Q3.28
        Vector3 jacobian_b;
        Vector3 response_a;
        Vector3 response_b;
        Lanes<std::int32_t> mass; // K0 / K, Q3.28
    };
    struct Point {
        Row row;
        Lanes<std::int32_t> lever;      // distance from the friction centre / smaller radius, Q3.28
        Lanes<std::int32_t> separation; // / substep: Q11.20 m/s
        Lanes<std::int32_t> impulse;    // Q11.20 m/s
    };

    Lanes<BodyRow> row_a;
    Lanes<BodyRow> row_b;
    Lanes<std::uint32_t> pair;
    Lanes<std::uint32_t> manifold;
    Lanes<std::int32_t> point_count;
    int lane_count;               // lanes in use, from 0
    std::int32_t point_count_max; // of its lanes
    bool is_central;              // of all or none of its lanes: see is_central()

    Vector3 normal; // Q3.28, like all below
    Vector3 tangent[2];
    Lanes<std::int32_t> share_a;
    Lanes<std::int32_t> share_b;
    Lanes<std::int32_t> mass_scale; // see Softness
    Lanes<std::int32_t> impulse_scale;
    Lanes<std::int32_t> bias_rate;
    Lanes<std::int32_t> friction;
    Lanes<std::int32_t> impulse_max; // of a point, Q11.20 m/s: all together stay in the format
    Lanes<std::int32_t> coupling[6]; // K_ij / K0 of points 10 20 21 30 31 32
    Point point[kBlockPoints];

    Row tangent_row[2];
    Lanes<std::int32_t> surface_speed[2]; // of B's surface less A's along the tangents, Q11.20 m/s
    Lanes<std::int32_t> tangent_coupling; // between the two
    Lanes<std::int32_t> twist_lever_a;    // smaller gyration radius / that of A, negative
    Lanes<std::int32_t> twist_lever_b;
    Vector3 twist_response_a;
    Vector3 twist_response_b;
    Lanes<std::int32_t> twist_mass;
    Lanes<std::int32_t> friction_impulse[2]; // Q11.20 m/s
    Lanes<std::int32_t> twist_impulse;
};

/// What a block's rows were made from, in the order of BlockPreparation::is_known(): all that they
/// depend on. A block that comes to hold the same contacts again, made from the same, has its rows.
struct alignas(64) RowInputs {
    std::int32_t entry[36 + 4 * kBlockPoints][kBlockLanes];
};

/// Index into `coupling` of points (row, column), column < row.
constexpr int coupling_index(int row, int column) {
    return row * (row - 1) / 2 + column;
}

} // namespace lockwind
