#pragma once

#include "dynamics/contact_block.h"
#include "dynamics/lanes.h"
#include "dynamics/prepare_contacts.h"
#include "dynamics/solve_contacts.h"

#include <cstdint>
#include <span>

namespace lockwind {

/// The solver's inner loops for one kind of lanes; every kind gives the same bits.
struct ContactKernels {
    using Pass = void (*)(std::span<ContactBlock> blocks, SolverBody* bodies, Halves halves);
    struct Passes {
        void (*read_speeds)(ContactBlock& block, SolverBody* bodies, PointSpeeds& out);
        Pass warm_start;
        Pass solve;
        Pass relax;
    };

    void (*prepare)(const PairTerms& terms,
                    std::int32_t substep_rate,
                    std::int32_t separation_max,
                    RowInputs& inputs,
                    ContactBlock& block);
    Passes calm; // where no body is wild
    Passes wild; // the same for all contacts that have no wild body
};

/// Calls visit(solver) for the lanes from `first`, with the solver of their number of points.
template <class L, bool kHolds, class Visit>
void visit_lanes(ContactBlock& block, SolverBody* bodies, int first, Halves halves, Visit&& visit) {
    if (block.is_central) {
        BlockSolver<L, 1, kHolds, true> solver(block, bodies, first, halves);
        visit(solver);
        return;
    }
    switch (L::kWidth == 1 ? block.point_count[first] : block.point_count_max) {
    case 1: {
        BlockSolver<L, 1, kHolds> solver(block, bodies, first, halves);
        visit(solver);
        break;
    }
    case 2: {
        BlockSolver<L, 2, kHolds> solver(block, bodies, first, halves);
        visit(solver);
        break;
    }
    case 3: {
        BlockSolver<L, 3, kHolds> solver(block, bodies, first, halves);
        visit(solver);
        break;
    }
    default: {
        BlockSolver<L, 4, kHolds> solver(block, bodies, first, halves);
        visit(solver);
        break;
    }
    }
}

template <class L, bool kHolds, class Visit>
void visit_block(ContactBlock& block, SolverBody* bodies, Halves halves, Visit&& visit) {
    for (int first = 0; first < block.lane_count; first += L::kWidth) {
        visit_lanes<L, kHolds>(block, bodies, first, halves, visit);
    }
}

template <class L, bool kHolds>
ContactKernels::Passes passes_of() {
    return {
        [](ContactBlock& block, SolverBody* bodies, PointSpeeds& out) {
            visit_block<L, kHolds>(
                block, bodies, Halves::up, [&](auto& solver) { solver.read_speeds(out); });
        },
        [](std::span<ContactBlock> blocks, SolverBody* bodies, Halves halves) {
            for (ContactBlock& block : blocks) {
                visit_block<L, kHolds>(
                    block, bodies, halves, [](auto& solver) { solver.warm_start(); });
            }
        },
        [](std::span<ContactBlock> blocks, SolverBody* bodies, Halves halves) {
            for (ContactBlock& block : blocks) {
                visit_block<L, kHolds>(block, bodies, halves, [](auto& solver) { solver.solve(); });
            }
        },
        [](std::span<ContactBlock> blocks, SolverBody* bodies, Halves halves) {
            for (ContactBlock& block : blocks) {
                visit_block<L, kHolds>(block, bodies, halves, [](auto& solver) { solver.relax(); });
            }
        }};
}

template <class L>
ContactKernels kernels_of() {
    return {
        [](const PairTerms& terms,
           std::int32_t substep_rate,
           std::int32_t separation_max,
           RowInputs& inputs,
           ContactBlock& block) {
            for (int first = 0; first < block.lane_count; first += L::kWidth) {
                BlockPreparation<L>(terms, inputs, block, first).run(substep_rate, separation_max);
            }
        },
        passes_of<L, false>(),
        passes_of<L, true>()};
}

} // namespace lockwind
