#include "dynamics/solver.h"

#include "dynamics/body_integration.h"

#include "lockwind/overflow.h"

#include <algorithm>

namespace lockwind {

Solver::Solver(const DynamicsSettings& settings, const ContactKernels& kernels)
    : constants_(make_step_constants(settings)), classes_(settings), part_(settings),
      bodies_(settings.body_capacity), joints_(settings), contacts_(settings, kernels) {
    DynamicsSettings of_class = settings;
    for (of_class.substeps = 0; of_class.substeps <= kSubstepsMax; ++of_class.substeps) {
        class_constants_.push_back(make_step_constants(of_class));
    }
    bounces_.reserve(settings.body_capacity);
    hits_.reserve(settings.manifold_capacity);
    broken_.reserve(settings.joint_capacity);
}

void Solver::solve(const DynamicsTables& tables,
                   const BodyFrames& frames,
                   const Activity& activity) {
    hits_.clear();
    broken_.clear();
    bounces_.clear();
    is_split_ = classes_.read(tables, activity);
    if (is_split_) {
        solve_classes(tables, frames, activity);
    } else {
        solve_class(constants_, tables, frames, activity);
    }
    bodies_.write_kinematic(constants_, tables);
}

void Solver::solve_classes(const DynamicsTables& tables,
                           const BodyFrames& frames,
                           const Activity& activity) {
    for (const std::uint32_t substeps : classes_.counts()) {
        part_.read_part(
            activity, tables, [&](BodyRow row) { return classes_.of(row) == substeps; });
        solve_class(class_constants_[substeps], tables, frames, part_);
        bounce_later(tables);
    }
    std::sort(broken_.begin(), broken_.end());
    std::sort(hits_.begin(), hits_.end(), [](const ContactHit& x, const ContactHit& y) {
        return x.row_a != y.row_a ? x.row_a < y.row_a : x.row_b < y.row_b;
    });
}

void Solver::solve_class(const StepConstants& constants,
                         const DynamicsTables& tables,
                         const BodyFrames& frames,
                         const Activity& activity) {
    bodies_.read(constants, tables, frames, activity);
    hold_back(tables, activity);
    joints_.prepare(constants, tables, activity, bodies_);
    contacts_.prepare(constants, tables, frames, activity, bodies_);
    for (std::uint32_t substep = 0; substep < constants.substeps; ++substep) {
        const Halves halves = substep % 2 == 0 ? Halves::up : Halves::down;
        joints_.begin_substep(bodies_);
        bodies_.integrate_velocities(constants, substep);
        joints_.warm_start(bodies_);
        if (substep == 0) {
            contacts_.warm_start(bodies_);
        }
        joints_.solve(bodies_);
        contacts_.solve(halves, bodies_);
        bodies_.integrate_positions();
        joints_.follow(constants, tables, bodies_);
        joints_.relax(bodies_);
        contacts_.relax(halves, bodies_);
    }
    joints_.write(constants, tables);
    contacts_.write(tables);
    bodies_.write(constants, tables);
    broken_.insert(broken_.end(), joints_.broken().begin(), joints_.broken().end());
}

void Solver::hold_back(const DynamicsTables& tables, const Activity& activity) {
    if (constants_.linear_speed_max == constants_.bound_speed_max) {
        return;
    }
    for (const std::uint32_t index : activity.pairs()) {
        const Pair& pair = tables.pairs[index];
        if (pair.point_count != 0) {
            bodies_.hold_back(constants_, pair.row_a);
            bodies_.hold_back(constants_, pair.row_b);
        }
    }
    for (const std::uint32_t index : activity.joints()) {
        bodies_.hold_back(constants_, tables.joints[index].row_a);
        bodies_.hold_back(constants_, tables.joints[index].row_b);
    }
}

/// The next class takes the contacts' place, but velocities are to change in restitution().
void Solver::bounce_later(const DynamicsTables& tables) {
    if (!contacts_.has_impacts()) {
        return;
    }
    bodies_.read_velocities(tables);
    contacts_.bounce(tables, bodies_);
    bodies_.add_bounces(tables, bounces_);
    contacts_.list_hits(tables, hits_);
}

void Solver::apply_bounces(const DynamicsTables& tables) {
    for (const SolverBodies::Bounce& bounce : bounces_) {
        BodyMotion& motion = tables.motion[bounce.row];
        for (int axis = 0; axis < 3; ++axis) {
            motion.linear_velocity[axis] =
                raw_add(motion.linear_velocity[axis], bounce.linear[axis]);
            motion.angular_velocity[axis] =
                raw_add(motion.angular_velocity[axis], bounce.angular[axis]);
        }
        clamp_velocities(constants_, tables.properties[bounce.row], motion);
    }
}

void Solver::restitution(const DynamicsTables& tables) {
    if (is_split_) {
        apply_bounces(tables);
        return;
    }
    if (!contacts_.has_impacts()) {
        return;
    }
    // The arena's velocities count, not what the solver left in its own.
    bodies_.read_velocities(tables);
    contacts_.bounce(tables, bodies_);
    bodies_.write_velocities(constants_, tables);
    contacts_.list_hits(tables, hits_);
}

} // namespace lockwind
