#pragma once

#include "dynamics/dynamics.h"
#include "dynamics/solver_bodies.h"
#include "dynamics/step_constants.h"

#include <cstdint>
#include <vector>

namespace lockwind {

/// A body of a joint while the substeps run. Unlike for contacts its place and turn are followed
/// substep by substep, so that joints of fast spinners stay exact.
struct JointBody {
    BodyRow row;
    bool dynamic;
    std::uint32_t joint_count;
    std::int64_t inverse_mass;            // Q24.40 1/kg
    std::int64_t inverse_gyration_radius; // Q7.24 1/m; 0 of a fixed body
    std::int64_t turn_per_velocity;       // Q.32: radians a substep per m/s
    std::int32_t principal[3];            // inverse inertia, Q5.26; 0 unless dynamic
    std::int32_t gyroscopic[3];           // Q2.30: (I_j - I_k) / I_i; 0 of equal ones
    std::int64_t start[3];                // Q31.32 m at the tick's start
    std::int64_t moved[3];                // Q31.32 m since then
    std::int32_t orientation[4];          // Q2.30
    std::int32_t rotation[9];             // Q2.30
    std::int64_t inverse_inertia[6];      // xx xy xz yy yz zz, world, Q5.26
};

/// Bodies that have joints, by row. Scratch of one tick.
class JointBodies {
public:
    JointBodies(std::uint32_t body_capacity, std::uint32_t joint_capacity);

    void clear() { bodies_.clear(); }
    /// Adds the row's body where it is new, and counts its joint.
    void add(const StepConstants& constants, const DynamicsTables& tables, BodyRow row);
    std::uint32_t index_of(BodyRow row) const { return index_of_row_[row]; }
    /// Whether a dynamic body has several joints.
    bool is_shared(std::uint32_t index) const {
        return bodies_[index].dynamic && bodies_[index].joint_count > 1;
    }
    /// A body that is nowhere but at `place`.
    std::uint32_t add_place(const std::int64_t place[3]);
    std::uint32_t size() const { return static_cast<std::uint32_t>(bodies_.size()); }
    const JointBody& operator[](std::uint32_t index) const { return bodies_[index]; }

    /// Before the velocities' step. Euler's equations by the implicit midpoint rule: energy and
    /// momentum keep their size. (A free body's turn of a whole tick, see FreeTurn, would leave the
    /// axis that a joint holds.)
    void turn_velocities(SolverBodies& bodies) const;
    /// After the positions' step.
    void follow(const StepConstants& constants, const SolverBodies& bodies);
    /// Lets SolverBodies::write take these turns for the bodies that are dynamic.
    void hand_over(SolverBodies& bodies) const;

private:
    std::vector<JointBody> bodies_;
    std::vector<std::uint32_t> index_of_row_; // valid where bodies_[it].row == row
};

/// Turn of a substep by `angular` (Q11.20 m/s x gyration radius), Q.30 rad, each within +-4.
void substep_turn(const JointBody& body, const std::int32_t angular[3], std::int64_t turn[3]);

} // namespace lockwind
