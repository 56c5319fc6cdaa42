#pragma once

#include "dynamics/activity.h"
#include "dynamics/body_frame.h"
#include "dynamics/dynamics.h"
#include "dynamics/foresight.h"
#include "dynamics/joined_pairs.h"
#include "dynamics/shape_sweep.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Continuous collision: bodies whose CollisionMode asks for it do not pass through others within a
/// tick. Where the way of such a body meets another, it ends there, its velocity as it is: the next
/// tick's contact stops it. It loses the rest of its tick (Box2D 3 does so too), never its speed.
///
/// Speculative bodies stop before they touch, by the solver. Where it fails to stop one, the sweep
/// of what lies deep within it does.
///
/// A way ends at its first touch alone: what another body would have met, had its own way not
/// ended, counts as if it had not ended. So the result does not depend on an order.
class Sweep {
public:
    explicit Sweep(const DynamicsSettings& settings);

    /// Before the bodies move.
    void remember(const DynamicsTables& tables, const Activity& activity);
    /// After they have moved.
    void run(const DynamicsTables& tables, BodyFrames& frames, const Activity& activity);

private:
    struct Pose {
        std::int64_t position[3];
        std::int32_t orientation[4];
        int level; // see ShapePath
    };
    struct Reach {
        std::int64_t low[3]; // Q31.32 m
        std::int64_t high[3];
    };

    bool is_fast(const DynamicsTables& tables, const BodyFrames& frames, BodyRow row) const;
    Reach reach_of(const DynamicsTables& tables, BodyRow row) const;
    ShapePath path_of(const DynamicsTables& tables, const BodyFrames& frames, BodyRow row) const;
    static Bounds bounds_of(const Reach& reach);
    void sweep(const DynamicsTables& tables, BodyFrames& frames, BodyRow row);
    SweepResult
    meet(const ShapePath& own, const ShapePath& its, const Bounds& near, std::int64_t& time) const;
    void end_ways(const DynamicsTables& tables, const BodyFrames& frames);
    void shorten(BodyRow row, std::int64_t time);

    Foresight foresight_;
    bool has_any_ = false;            // awake bodies that ask for it
    std::vector<Pose> starts_;        // by row, of bodies that moved
    std::vector<std::uint8_t> moved_; // by row
    std::vector<std::int64_t> ends_;  // by row: Q1.62 of its way
    std::vector<BodyRow> shortened_;  // rows in ends_ that are not whole
    JoinedPairs joined_;
};

} // namespace lockwind
