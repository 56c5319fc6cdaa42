#pragma once

#include "dynamics/joint.h"
#include "dynamics/joint_block.h"
#include "dynamics/joint_bodies.h"
#include "dynamics/joint_rows.h"
#include "dynamics/solver_bodies.h"
#include "dynamics/step_constants.h"

#include <cstdint>

namespace lockwind {

/// A soft constraint as in Softness, with a1, a2, a3 as there. Joints' springs may be far slower
/// than contacts.
struct JointSoftness {
    std::int64_t mass_scale; // a2 a3, Q.40
    std::int64_t bias_rate;  // x / a1, Q.40: x h, so that it multiplies s / h
    std::int64_t compliance; // 1 / a2, Q.36, of rows whose K is 1
};
/// `hertz` Q15.16, taken as at most a quarter of the substep rate; `damping_ratio` Q11.20.
JointSoftness
make_joint_softness(std::int32_t substep_rate, std::int32_t hertz, std::int32_t damping_ratio);

/// A joint while the substeps run.
///
/// The held rows are solved together and exactly, not one by one: a long lever couples a hinge's
/// angle to its place almost fully, and rows one by one would need as many rounds as the lever is
/// gyration radii long. A free axis is solved with the response it has while the held rows hold.
///
/// Where a body has several joints, held rows are soft in a substep's first pass, stiff in its
/// second: joint by joint a chain under a heavy load does not converge, and gains energy unless it
/// yields. The compliance is that of the two masses, the same in all directions: K is large along a
/// long lever, and softness in its measure (Box2D's) lengthens a pendulum's period. A joint alone
/// is solved exactly and stays stiff: softness brakes what spins about a point off its centre.
///
/// Where anchors would be after the substep is extrapolated to second order, so that positions end
/// with the anchors together and relaxing ends with their speeds together, as in RATTLE
/// (H. C. Andersen, J. Comput. Phys. 52, 1983).
class JointConstraint {
public:
    JointConstraint(const StepConstants& constants,
                    const Joint& joint,
                    std::uint32_t table_row,
                    const JointBodies& bodies,
                    std::uint32_t index_a,
                    std::uint32_t index_b);

    /// Rows where the bodies are now.
    void refresh(const Joint& joint, const JointBodies& bodies);
    /// When a substep begins: how far its rows will bend. (Once impulses are given anew the bodies
    /// may spin wildly until all are solved.)
    void look_ahead(const SolverBodies& bodies);
    /// The impulses of the substep before, in two parts: forces of springs and motors, and what
    /// holds, which keep() then scales by the factor that JointSolver finds.
    void push(SolverBodies& bodies) const;
    void hold(SolverBodies& bodies) const;
    /// Work of what holds, at the bodies' present speeds: in some unit of energy, one for all
    /// joints.
    Int128 work_of_holding(const SolverBodies& bodies) const;
    /// Q.30, of what hold() gave.
    void keep(SolverBodies& bodies, std::int64_t factor);
    std::uint32_t index_a() const { return index_a_; }
    std::uint32_t index_b() const { return index_b_; }
    void solve(SolverBodies& bodies);
    void relax(SolverBodies& bodies);
    /// After a substep.
    void note_load();

    std::uint32_t table_row() const { return table_row_; }
    void write(Joint& joint) const;
    /// Whether the mean force or torque of the tick was above the joint's.
    bool is_broken(const StepConstants& constants, const Joint& joint) const;

private:
    struct Spring {
        bool exists;
        JointSoftness softness;
        std::int64_t rest;    // Q.32 m
        std::int64_t stretch; // Q.32 m, at the substep's start
    };
    struct Motor {
        bool exists;
        std::int64_t speed;       // Q.32 m/s
        std::int64_t impulse_max; // Q.32 m/s in a substep
    };
    struct Limit {
        bool exists;
        std::int64_t low; // Q.32 m
        std::int64_t high;
        std::int64_t swing; // of a cone
    };

    void read_axis(const StepConstants& constants, const Joint& joint);
    std::int64_t impulse_of(std::int64_t force, bool is_torque) const;
    std::int64_t compliance(bool of_angle, bool biased) const;
    void find_lacking(const SolverBodies& bodies,
                      bool biased,
                      std::int64_t lacking[kJointRowsMax]) const;
    void pass(SolverBodies& bodies, bool biased);
    void limit_pull();
    std::int64_t solve_axis(int axis, std::int64_t speed, bool biased);
    std::int64_t press(std::int64_t room,
                       std::int64_t opening,
                       std::int64_t response,
                       bool biased,
                       std::int64_t& impulse) const;
    void apply(SolverBodies& bodies, const std::int64_t impulses[kJointRowsMax]) const;
    void find_forces(std::int64_t forces[kJointRowsMax]) const;
    void find_holding(std::int64_t holding[kJointRowsMax]) const;
    void find_sum(std::int64_t sum[kJointRowsMax]) const;

    std::uint32_t table_row_;
    std::uint32_t index_a_;
    std::uint32_t index_b_;
    BodyRow row_a_; // kNoIndex of a grab's place
    BodyRow row_b_;
    std::int64_t substep_rate_;
    std::int64_t turn_a_; // JointBody::turn_per_velocity
    std::int64_t turn_b_;
    JointConstants constants_;
    JointSoftness rigid_; // of held rows and limits
    bool held_is_soft_;
    bool is_shared_; // one of the bodies has other joints
    bool can_break_;
    Spring spring_;
    Motor motor_;
    Limit limit_;
    std::int64_t row_impulse_[kJointRowsMax];
    std::int64_t axis_impulse_[4];
    std::int64_t swing_impulse_;
    std::int64_t reduced_mass_;                // 2^80 / (1/m_a + 1/m_b)
    std::int64_t beyond_[kJointRowsMax];       // Q.32 m/s: second order of the rows' motion
    std::int64_t held_stretch_[kJointRowsMax]; // of soft rows, at the substep's start

    JointRows rows_;
    JointBlock block_;
    std::int64_t force_sum_[3]; // Q.32 m/s, over the substeps
    std::int64_t torque_sum_[3];
};

} // namespace lockwind
