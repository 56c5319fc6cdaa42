#pragma once

#include "dynamics/activity.h"
#include "dynamics/dynamics.h"
#include "dynamics/islands.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Gives bodies their levels of detail, see level_of_detail.h. Levels are state: the next tick's
/// phases read them.
///
/// An island is what touching pairs and joints hold together, here with the kinematic bodies that
/// move, so that what carries something stops and goes on together with it. Sleepers have no part
/// in it: nobody is held by one without waking it.
class Levels {
public:
    explicit Levels(const DynamicsSettings& settings);

    /// After all that a tick does to motion and sleep. `viewers` are the players' rows.
    void choose(const DynamicsTables& tables,
                const Activity& activity,
                std::span<const BodyRow> viewers);

private:
    /// Distances at which a body goes a level up or down, Q51.12 m.
    struct Border {
        std::int64_t up;
        std::int64_t down;
    };

    static Border border_at(Real distance);
    BodyLevel
    wish_of(const DynamicsTables& tables, BodyRow row, std::span<const BodyRow> viewers) const;
    void read_wishes(const DynamicsTables& tables, std::span<const BodyRow> viewers);
    void join(const DynamicsTables& tables, BodyRow a, BodyRow b);
    void join_awake(const DynamicsTables& tables, const Activity& activity);
    void join_frozen(const DynamicsTables& tables);

    bool enabled_;
    Border full_;
    Border simplified_;
    Islands islands_;
    std::vector<BodyRow> rows_;     // that move, or would if they were not frozen
    std::vector<BodyLevel> wishes_; // by row: its own, and of an island's first row its island's
    bool is_lowered_ = false;       // one that is awake is, or wishes to be, below full detail
    bool is_thawing_ = false;       // one that is frozen wishes not to be
};

} // namespace lockwind
