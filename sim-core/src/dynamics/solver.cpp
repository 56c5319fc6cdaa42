#include "dynamics/solver.h"

namespace lockwind {

Solver::Solver(const DynamicsSettings& settings, const ContactKernels& kernels)
    : constants_(make_step_constants(settings)), bodies_(settings.body_capacity), joints_(settings),
      contacts_(settings, kernels) {}

void Solver::solve(const DynamicsTables& tables,
                   const BodyFrames& frames,
                   const Activity& activity) {
    bodies_.read(constants_, tables, frames, activity);
    hold_back(tables, activity);
    joints_.prepare(constants_, tables, activity, bodies_);
    contacts_.prepare(constants_, tables, frames, activity, bodies_);
    for (std::uint32_t substep = 0; substep < constants_.substeps; ++substep) {
        joints_.begin_substep(bodies_);
        bodies_.integrate_velocities(constants_, substep);
        joints_.warm_start(bodies_);
        if (substep == 0) {
            contacts_.warm_start(bodies_);
        }
        joints_.solve(bodies_);
        contacts_.solve(bodies_);
        bodies_.integrate_positions();
        joints_.follow(constants_, tables, bodies_);
        joints_.relax(bodies_);
        contacts_.relax(bodies_);
    }
    joints_.write(constants_, tables);
    contacts_.write(tables);
    bodies_.write(constants_, tables);
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

void Solver::restitution(const DynamicsTables& tables) {
    if (!contacts_.has_impacts()) {
        return;
    }
    // The arena's velocities count, not what the solver left in its own.
    bodies_.read_velocities(tables);
    contacts_.bounce(tables, bodies_);
    bodies_.write_velocities(constants_, tables);
    contacts_.list_hits(tables);
}

} // namespace lockwind
