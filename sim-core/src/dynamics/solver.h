#pragma once

#include "dynamics/activity.h"
#include "dynamics/contact_kernels.h"
#include "dynamics/contact_solver.h"
#include "dynamics/dynamics.h"
#include "dynamics/joint_solver.h"
#include "dynamics/solver_bodies.h"
#include "dynamics/step_constants.h"

#include <cstdint>
#include <span>

namespace lockwind {

/// The substeps of a tick, and restitution after them: soft step, Catto, "Solver2D", 2024.
class Solver {
public:
    explicit Solver(const DynamicsSettings& settings,
                    const ContactKernels& kernels = kernels_of<ScalarLanes>());
    void solve(const DynamicsTables& tables, const BodyFrames& frames, const Activity& activity);
    void restitution(const DynamicsTables& tables);
    std::span<const ContactHit> hits() const { return contacts_.hits(); }
    std::span<const std::uint32_t> broken_joints() const { return joints_.broken(); }

private:
    void hold_back(const DynamicsTables& tables, const Activity& activity);

    StepConstants constants_;
    SolverBodies bodies_;
    JointSolver joints_;
    ContactSolver contacts_;
};

} // namespace lockwind
