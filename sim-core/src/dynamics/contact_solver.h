#pragma once

#include "dynamics/block_layout.h"
#include "dynamics/body_frame.h"
#include "dynamics/contact_block.h"
#include "dynamics/contact_kernels.h"
#include "dynamics/dynamics.h"
#include "dynamics/solver_bodies.h"
#include "dynamics/step_constants.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// The contacts of a tick: laid out in blocks, passed over in each substep, written back. All
/// members are scratch of one tick.
class ContactSolver {
public:
    ContactSolver(const DynamicsSettings& settings, const ContactKernels& kernels);

    void prepare(const StepConstants& constants,
                 const DynamicsTables& tables,
                 const BodyFrames& frames,
                 const Activity& activity,
                 SolverBodies& bodies);
    void warm_start(SolverBodies& bodies) {
        run(&ContactKernels::Passes::warm_start, Halves::up, bodies);
    }
    void solve(Halves halves, SolverBodies& bodies) {
        run(&ContactKernels::Passes::solve, halves, bodies);
    }
    void relax(Halves halves, SolverBodies& bodies);
    void write(const DynamicsTables& tables);

    /// Contacts that approached fast: they may bounce, and are hits.
    bool has_impacts() const { return !impacts_.empty(); }
    void bounce(const DynamicsTables& tables, SolverBodies& bodies);
    /// Appends them in pair order.
    void list_hits(const DynamicsTables& tables, std::vector<ContactHit>& hits);

private:
    struct Impact {
        std::uint32_t pair;
        std::uint32_t block;
        int lane;
        std::int32_t approach[kBlockPoints]; // Q11.20 m/s before the solve, negative
        std::int32_t impulse_max[kBlockPoints];
        std::int32_t load_max; // largest sum of the points' impulses
    };

    void fill_blocks(const StepConstants& constants,
                     const DynamicsTables& tables,
                     const BodyFrames& frames,
                     SolverBodies& bodies);
    void find_impacts(std::uint32_t index, SolverBodies& bodies);
    void note_impacts();
    void bounce(const DynamicsTables& tables, SolverBodies& bodies, Impact& impact);

    void
    run(ContactKernels::Pass ContactKernels::Passes::*pass, Halves halves, SolverBodies& bodies);

    ContactKernels kernels_;
    ContactKernels overflow_kernels_; // scalar: bodies may meet twice in a block
    Colouring colouring_;
    BlockLayout layout_;
    std::vector<Impact> impacts_; // in solving order
};

} // namespace lockwind
