#pragma once

#include "dynamics/activity.h"
#include "dynamics/body_frame.h"
#include "dynamics/dynamics.h"
#include "dynamics/joined_pairs.h"
#include "dynamics/manifold_slots.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Index of the motion sum and stamp that decide when a pair is looked at again: a touching pair of
/// flat shapes bears more motion than others.
inline constexpr int kMotionTouching = 0;
inline constexpr int kMotionOther = 1;
/// Motion, Q9.22 m, after which a body's stamp is renewed: 25 mm and 10 mm.
inline constexpr std::int32_t kMotionBound[2] = {104858, 41943};

/// Looks at the pairs whose bodies moved: makes, renews and frees their manifolds.
class NarrowPhase {
public:
    NarrowPhase(std::uint32_t body_capacity, std::uint32_t joint_capacity);

    /// Appends what began and ceased to touch to `changes`, in pair order. Where the manifolds run
    /// out, the pairs that find none do not touch. Nor do those that a joint keeps from it.
    StepFault run(const DynamicsTables& tables,
                  std::uint32_t tick,
                  const BodyFrames& frames,
                  const Activity& activity,
                  ManifoldSlots& slots,
                  std::vector<ContactChange>& changes);

private:
    /// A body's motion stamps, close together for the pairs that need no look.
    struct Gate {
        std::uint32_t stamp[2];
        bool flat;
    };
    void read_gates(const DynamicsTables& tables,
                    const BodyFrames& frames,
                    std::span<const BodyRow> rows);
    bool needs_look(const Pair& pair) const;

    std::vector<Gate> gates_;
    JoinedPairs joined_;
};

/// A unit vector perpendicular to `normal`, a function of it alone.
void tangent_of(const std::int32_t normal[3], std::int32_t tangent[3]);

} // namespace lockwind
