#include "dynamics/levels.h"

#include "dynamics/pairing.h"
#include "dynamics/solver_format.h"
#include "geometry/fixed_geometry.h"

#include "lockwind/overflow.h"
#include "lockwind/world_definition.h"

#include <algorithm>
#include <limits>

namespace lockwind {

namespace {

/// Distances are Q51.12 m: 0.25 mm, and the squares of 18 km, which no border exceeds, add up in 55
/// bits.
constexpr int kDistanceFraction = 12;
constexpr std::int64_t kBeyond = std::numeric_limits<std::int64_t>::max();

/// kBeyond where it is more than `most` along an axis, which is all that most pairs are looked at
/// for. Of the difference alone, so that nothing depends on where the origin lies.
std::int64_t squared_distance(const BodyMotion& a, const BodyMotion& b, std::int64_t most) {
    std::int64_t square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t apart =
            magnitude(raw_subtract(a.position[axis], b.position[axis])) >> (32 - kDistanceFraction);
        if (apart > most) {
            return kBeyond;
        }
        square += apart * apart;
    }
    return square;
}

bool is_frozen(const DynamicsTables& tables, BodyRow row) {
    return level_of(tables.sleep[row]) == BodyLevel::frozen;
}

} // namespace

Levels::Levels(const DynamicsSettings& settings)
    : enabled_(settings.level_of_detail.enabled),
      full_(border_at(settings.level_of_detail.full_within)),
      simplified_(border_at(settings.level_of_detail.simplified_within)),
      islands_(settings.body_capacity), wishes_(settings.body_capacity) {
    rows_.reserve(settings.body_capacity);
}

/// A tenth between the two, so that an island at the border does not change level each tick.
Levels::Border Levels::border_at(Real distance) {
    const std::int64_t up = distance.raw() >> (32 - kDistanceFraction);
    return {up, up + up / 10};
}

BodyLevel
Levels::wish_of(const DynamicsTables& tables, BodyRow row, std::span<const BodyRow> viewers) const {
    const BodyLevel level = level_of(tables.sleep[row]);
    const std::int64_t radius =
        tables.properties[row].bounding_radius >> (kLengthFraction - kDistanceFraction);
    const std::int64_t full = radius + (level == BodyLevel::full ? full_.down : full_.up);
    const std::int64_t simplified =
        radius + (level == BodyLevel::frozen ? simplified_.up : simplified_.down);
    BodyLevel wish = viewers.empty() ? BodyLevel::full : BodyLevel::frozen;
    for (const BodyRow viewer : viewers) {
        const std::int64_t square =
            squared_distance(tables.motion[row], tables.motion[viewer], simplified);
        if (square <= full * full) {
            return BodyLevel::full;
        }
        if (square <= simplified * simplified) {
            wish = BodyLevel::simplified;
        }
    }
    return wish;
}

void Levels::read_wishes(const DynamicsTables& tables, std::span<const BodyRow> viewers) {
    rows_.clear();
    is_lowered_ = false;
    is_thawing_ = false;
    for (BodyRow row = 0; row < tables.sleep.count(); ++row) {
        const BodyLevel level = level_of(tables.sleep[row]);
        if (level == BodyLevel::asleep) {
            continue;
        }
        const BodyLevel wish = wish_of(tables, row, viewers);
        rows_.push_back(row);
        wishes_[row] = wish;
        islands_.begin(row);
        if (level == BodyLevel::frozen) {
            is_thawing_ = is_thawing_ || wish != BodyLevel::frozen;
        } else {
            is_lowered_ = is_lowered_ || wish != BodyLevel::full || level != BodyLevel::full;
        }
    }
}

/// Frozen bodies with frozen ones, awake ones with awake ones: wake() has left no others in touch.
void Levels::join(const DynamicsTables& tables, BodyRow a, BodyRow b) {
    const auto has_part = [&](BodyRow row) {
        return level_of(tables.sleep[row]) != BodyLevel::asleep;
    };
    if (has_part(a) && has_part(b) && is_frozen(tables, a) == is_frozen(tables, b)) {
        islands_.join(a, b);
    }
}

void Levels::join_awake(const DynamicsTables& tables, const Activity& activity) {
    for (const std::uint32_t index : activity.pairs()) {
        const Pair& pair = tables.pairs[index];
        if (is_pressing(pair, tables)) {
            join(tables, pair.row_a, pair.row_b);
        }
    }
    for (const std::uint32_t index : activity.joints()) {
        const Joint& joint = tables.joints[index];
        if (joint.row_a != kNoIndex) {
            join(tables, joint.row_a, joint.row_b);
        }
    }
}

/// Activity knows none of them. Damaged rows must not lead outside.
void Levels::join_frozen(const DynamicsTables& tables) {
    const std::uint32_t count = tables.sleep.count();
    const auto join_if_frozen = [&](BodyRow a, BodyRow b) {
        if (a < count && b < count && is_frozen(tables, a)) {
            join(tables, a, b);
        }
    };
    for (const Pair& pair : tables.pairs.rows()) {
        if (pair.row_a < count && pair.row_b < count && is_pressing(pair, tables)) {
            join_if_frozen(pair.row_a, pair.row_b);
        }
    }
    for (const Joint& joint : tables.joints.rows()) {
        join_if_frozen(joint.row_a, joint.row_b);
    }
}

void Levels::choose(const DynamicsTables& tables,
                    const Activity& activity,
                    std::span<const BodyRow> viewers) {
    if (!enabled_) {
        return;
    }
    read_wishes(tables, viewers);
    if (is_lowered_) {
        join_awake(tables, activity);
    }
    if (is_thawing_) {
        join_frozen(tables);
    }
    if (!is_lowered_ && !is_thawing_) {
        return;
    }
    // First each island's first row has the nearest one's wish, then all of its bodies do.
    for (const BodyRow row : rows_) {
        BodyLevel& nearest = wishes_[islands_.find(row)];
        nearest = std::min(nearest, wishes_[row]);
    }
    for (const BodyRow row : rows_) {
        set_level(tables.sleep[row], wishes_[islands_.find(row)]);
    }
}

} // namespace lockwind
