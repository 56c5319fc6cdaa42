#pragma once

#include "dynamics/activity.h"
#include "dynamics/contact_kernels.h"
#include "dynamics/contact_solver.h"
#include "dynamics/dynamics.h"
#include "dynamics/joint_solver.h"
#include "dynamics/solver_bodies.h"
#include "dynamics/step_constants.h"
#include "dynamics/substep_classes.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// The substeps of a tick, and restitution after them: soft step, Catto, "Solver2D", 2024.
///
/// Where islands take different numbers of substeps, those of one number are a class, and all
/// members but the constants serve one class after the other. Islands do not meet, so that the
/// order of the classes changes nothing.
class Solver {
public:
    explicit Solver(const DynamicsSettings& settings,
                    const ContactKernels& kernels = kernels_of<ScalarLanes>());
    void solve(const DynamicsTables& tables, const BodyFrames& frames, const Activity& activity);
    void restitution(const DynamicsTables& tables);
    std::span<const ContactHit> hits() const { return hits_; }
    std::span<const std::uint32_t> broken_joints() const { return broken_; }

private:
    void solve_class(const StepConstants& constants,
                     const DynamicsTables& tables,
                     const BodyFrames& frames,
                     const Activity& activity);
    void
    solve_classes(const DynamicsTables& tables, const BodyFrames& frames, const Activity& activity);
    void bounce_later(const DynamicsTables& tables);
    void apply_bounces(const DynamicsTables& tables);
    void hold_back(const DynamicsTables& tables, const Activity& activity);

    StepConstants constants_;
    std::vector<StepConstants> class_constants_; // by substeps
    SubstepClasses classes_;
    Activity part_;         // of a class
    bool is_split_ = false; // this tick has classes
    std::vector<SolverBodies::Bounce> bounces_;
    std::vector<ContactHit> hits_;
    std::vector<std::uint32_t> broken_;
    SolverBodies bodies_;
    JointSolver joints_;
    ContactSolver contacts_;
};

} // namespace lockwind
