#pragma once

#include "dynamics/activity.h"
#include "dynamics/body_frame.h"
#include "dynamics/dynamics.h"
#include "dynamics/foresight.h"
#include "dynamics/joined_pairs.h"
#include "dynamics/manifold_slots.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Looks at the pairs whose bodies moved: makes, renews and frees their manifolds.
class NarrowPhase {
public:
    explicit NarrowPhase(const DynamicsSettings& settings);

    /// Appends what began and ceased to touch to `changes`, in pair order. Where the manifolds run
    /// out, the pairs that find none do not touch. Nor do those that a joint keeps from it.
    StepFault run(const DynamicsTables& tables,
                  const BodyFrames& frames,
                  const Activity& activity,
                  ManifoldSlots& slots,
                  std::vector<ContactChange>& changes);
    /// Indices of the pairs that the last run changed.
    std::span<const std::uint32_t> changed_pairs() const { return changed_; }
    /// Frees the manifolds of pairs that do not touch, but might have in this tick.
    void forget_foreseen(const DynamicsTables& tables, ManifoldSlots& slots);

private:
    /// What decides about a look, close together for the pairs that need none.
    struct Gate {
        std::uint8_t moved; // BodySleep::moved
        bool flat;
        std::int32_t reach; // see Foresight
    };
    void read_gates(const DynamicsTables& tables,
                    const BodyFrames& frames,
                    std::span<const BodyRow> rows);
    bool needs_look(const Pair& pair) const;
    std::int32_t reach_of(const Pair& pair) const;

    Foresight foresight_;
    std::vector<Gate> gates_;
    std::vector<std::uint32_t> foreseen_; // pairs with a manifold for this tick alone
    std::vector<std::uint32_t> changed_;
    JoinedPairs joined_;
};

/// A unit vector perpendicular to `normal`, a function of it alone.
void tangent_of(const std::int32_t normal[3], std::int32_t tangent[3]);

} // namespace lockwind
