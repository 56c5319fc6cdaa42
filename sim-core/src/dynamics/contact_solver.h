#pragma once

#include "dynamics/block_layout.h"
#include "dynamics/body_frame.h"
#include "dynamics/body_integration.h"
#include "dynamics/contact_block.h"
#include "dynamics/contact_kernels.h"
#include "dynamics/dynamics.h"
#include "dynamics/step_constants.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// The substeps of a tick, and restitution after them. All members are scratch of one tick.
class ContactSolver {
public:
    explicit ContactSolver(const DynamicsSettings& settings,
                           const ContactKernels& kernels = kernels_of<ScalarLanes>());
    void solve(const DynamicsTables& tables, std::uint32_t tick, const BodyFrames& frames);
    void restitution(const DynamicsTables& tables);
    std::span<const ContactHit> hits() const { return hits_; }

private:
    /// Velocities before the contacts' impulses of a substep, and the substeps' sum.
    struct Course {
        std::int32_t linear_free[4];
        std::int32_t angular_free[4];
        BodyTravel travel;
        std::int32_t angular_speed_max;
    };
    /// A contact whose bodies approached fast: it may bounce, and is a hit.
    struct Impact {
        std::uint32_t pair;
        std::uint32_t block;
        int lane;
        std::int32_t approach[kBlockPoints]; // Q11.20 m/s before the solve, negative
        std::int32_t impulse_max[kBlockPoints];
        std::int32_t load_max; // largest sum of the points' impulses
    };

    void read_bodies(const DynamicsTables& tables, const BodyFrames& frames);
    void read_terms(const BodyFrame& frame, const BodyProperties& body, BodyTerms& terms) const;
    void prepare(const DynamicsTables& tables, const BodyFrames& frames);
    void read_pair(const DynamicsTables& tables,
                   const BodyFrames& frames,
                   ContactBlock& block,
                   int lane,
                   PairTerms& terms) const;
    void fill_padding(ContactBlock& block, PairTerms& terms) const;
    void find_impacts();
    void note_impacts();
    void integrate_velocities(std::uint32_t substep);
    void integrate_positions();
    void write_manifolds(const DynamicsTables& tables);
    void write_bodies(const DynamicsTables& tables, std::uint32_t tick);
    void bounce(const DynamicsTables& tables, Impact& impact);
    void list_hits(const DynamicsTables& tables);

    void run(ContactKernels::Pass ContactKernels::*pass);

    StepConstants constants_;
    ContactKernels kernels_;
    ContactKernels overflow_kernels_; // scalar: bodies may meet twice in a block
    BodyRow padding_row_;             // of the lanes without a contact, at rest
    Colouring colouring_;
    BlockLayout layout_;
    std::vector<SolverBody> bodies_;
    std::vector<BodyTerms> terms_;
    std::vector<Course> courses_;
    std::vector<std::int32_t> speed_bound_; // Q11.20 m/s, of any point of the body
    std::vector<BodyRow> dynamic_rows_;
    std::vector<BodyRow> kinematic_rows_;
    std::vector<Impact> impacts_; // in solving order
    std::vector<ContactHit> hits_;
};

} // namespace lockwind
