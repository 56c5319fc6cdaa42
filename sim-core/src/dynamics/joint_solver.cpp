#include "dynamics/joint_solver.h"

#include <algorithm>

namespace lockwind {

/// Of the energy along the impulses' direction, a parabola, where its lowest point is.
std::int64_t JointSolver::Work::factor() const {
    constexpr std::int64_t kWhole = std::int64_t{1} << 30;
    constexpr std::int64_t kMost = std::int64_t{1} << 61;
    Int128 part = needed;
    Int128 whole = raw_add(needed, left);
    if (left <= 0) {
        return kWhole;
    }
    if (needed <= 0) {
        return 0;
    }
    while (whole >= Int128(kMost)) {
        part = round_shift(part, 1);
        whole = round_shift(whole, 1);
    }
    return multiply_divide(raw_narrow<std::int64_t>(part), kWhole, raw_narrow<std::int64_t>(whole));
}

JointSolver::JointSolver(const DynamicsSettings& settings)
    : bodies_(settings.body_capacity, settings.joint_capacity),
      groups_(2 * settings.joint_capacity), works_(2 * settings.joint_capacity) {
    constraints_.reserve(settings.joint_capacity);
    broken_.reserve(settings.joint_capacity);
}

void JointSolver::prepare(const StepConstants& constants,
                          const DynamicsTables& tables,
                          const Activity& activity,
                          SolverBodies& bodies) {
    bodies_.clear();
    constraints_.clear();
    broken_.clear();
    for (const std::uint32_t row : activity.joints()) {
        const Joint& joint = tables.joints[row];
        bodies_.add(constants, tables, joint.row_b);
        if (joint.row_a != kNoIndex) {
            bodies_.add(constants, tables, joint.row_a);
        }
    }
    for (const std::uint32_t row : activity.joints()) {
        const Joint& joint = tables.joints[row];
        const std::uint32_t index_a = joint.row_a == kNoIndex ? bodies_.add_place(joint.target)
                                                              : bodies_.index_of(joint.row_a);
        constraints_.emplace_back(
            constants, joint, row, bodies_, index_a, bodies_.index_of(joint.row_b));
    }
    bodies_.hand_over(bodies);
    find_groups();
}

void JointSolver::begin_substep(SolverBodies& bodies) {
    for (JointConstraint& constraint : constraints_) {
        constraint.look_ahead(bodies);
    }
    bodies_.turn_velocities(bodies);
}

void JointSolver::find_groups() {
    for (std::uint32_t index = 0; index < bodies_.size(); ++index) {
        groups_.begin(index);
    }
    for (const JointConstraint& constraint : constraints_) {
        if (bodies_[constraint.index_a()].dynamic && bodies_[constraint.index_b()].dynamic) {
            groups_.join(constraint.index_a(), constraint.index_b());
        }
    }
}

std::uint32_t JointSolver::group_of(const JointConstraint& constraint) {
    return groups_.find(bodies_[constraint.index_b()].dynamic ? constraint.index_b()
                                                              : constraint.index_a());
}

void JointSolver::warm_start(SolverBodies& bodies) {
    for (const JointConstraint& constraint : constraints_) {
        constraint.push(bodies);
        works_[group_of(constraint)] = {};
    }
    for (const JointConstraint& constraint : constraints_) {
        Work& work = works_[group_of(constraint)];
        work.needed = raw_subtract(work.needed, constraint.work_of_holding(bodies));
    }
    for (const JointConstraint& constraint : constraints_) {
        constraint.hold(bodies);
    }
    for (const JointConstraint& constraint : constraints_) {
        Work& work = works_[group_of(constraint)];
        work.left = raw_add(work.left, constraint.work_of_holding(bodies));
    }
    for (JointConstraint& constraint : constraints_) {
        constraint.keep(bodies, works_[group_of(constraint)].factor());
    }
}

void JointSolver::solve(SolverBodies& bodies) {
    for (JointConstraint& constraint : constraints_) {
        constraint.solve(bodies);
    }
}

void JointSolver::follow(const StepConstants& constants,
                         const DynamicsTables& tables,
                         const SolverBodies& bodies) {
    bodies_.follow(constants, bodies);
    for (JointConstraint& constraint : constraints_) {
        constraint.refresh(tables.joints[constraint.table_row()], bodies_);
    }
}

void JointSolver::relax(SolverBodies& bodies) {
    std::for_each(constraints_.rbegin(), constraints_.rend(), [&](JointConstraint& constraint) {
        constraint.relax(bodies);
    });
    for (JointConstraint& constraint : constraints_) {
        constraint.relax(bodies);
    }
    for (JointConstraint& constraint : constraints_) {
        constraint.note_load();
    }
}

void JointSolver::write(const StepConstants& constants, const DynamicsTables& tables) {
    for (const JointConstraint& constraint : constraints_) {
        Joint& joint = tables.joints[constraint.table_row()];
        constraint.write(joint);
        if (constraint.is_broken(constants, joint)) {
            broken_.push_back(constraint.table_row());
        }
    }
}

} // namespace lockwind
