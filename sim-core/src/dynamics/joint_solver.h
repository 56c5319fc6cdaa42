#pragma once

#include "dynamics/activity.h"
#include "dynamics/dynamics.h"
#include "dynamics/islands.h"
#include "dynamics/joint_block.h"
#include "dynamics/joint_bodies.h"
#include "dynamics/joint_constraint.h"
#include "dynamics/solver_bodies.h"
#include "dynamics/step_constants.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// The joints of a tick. Solved in id order and relaxed in the opposite one, so that a chain's load
/// crosses it in every substep whichever way it is numbered. All members are scratch of one tick.
class JointSolver {
public:
    explicit JointSolver(const DynamicsSettings& settings);

    void prepare(const StepConstants& constants,
                 const DynamicsTables& tables,
                 const Activity& activity,
                 SolverBodies& bodies);
    /// Before the velocities' step.
    void begin_substep(SolverBodies& bodies);
    void warm_start(SolverBodies& bodies);
    void solve(SolverBodies& bodies);
    /// After the positions' step.
    void follow(const StepConstants& constants,
                const DynamicsTables& tables,
                const SolverBodies& bodies);
    void relax(SolverBodies& bodies);
    /// Impulses into the table, and which joints bore too much.
    void write(const StepConstants& constants, const DynamicsTables& tables);

    /// Rows of the joints that break in this tick, ascending.
    std::span<const std::uint32_t> broken() const { return broken_; }

private:
    /// Of the impulses that hold a group together, at the speeds before them and after.
    struct Work {
        Int128 needed = 0;
        Int128 left = 0;
        /// Q.30 of them that leaves the least energy, at most all.
        std::int64_t factor() const;
    };
    void find_groups();
    std::uint32_t group_of(const JointConstraint& constraint);

    JointBodies bodies_;
    std::vector<JointConstraint> constraints_;
    Islands groups_;          // of indices of bodies_: dynamic ones that joints connect
    std::vector<Work> works_; // by group
    std::vector<std::uint32_t> broken_;
};

} // namespace lockwind
