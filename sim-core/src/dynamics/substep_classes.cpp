#include "dynamics/substep_classes.h"

#include "dynamics/pairing.h"

#include "lockwind/world_definition.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);

} // namespace

SubstepClasses::SubstepClasses(const DynamicsSettings& settings)
    : usual_(make_step_constants(settings).substeps),
      simplified_(settings.level_of_detail.simplified_substeps), islands_(settings.body_capacity),
      substeps_(settings.body_capacity) {}

std::uint32_t SubstepClasses::asked_by(const DynamicsTables& tables, BodyRow row) const {
    // Damaged rows must not ask for more than there are constants for.
    const std::uint32_t own =
        std::min<std::uint32_t>(tables.properties[row].substeps, kSubstepsMax);
    const std::uint32_t asked = own == 0 ? usual_ : own;
    return level_of(tables.sleep[row]) == BodyLevel::simplified ? std::min(asked, simplified_)
                                                                : asked;
}

void SubstepClasses::join(const DynamicsTables& tables, const Activity& activity) {
    const auto joins = [&](BodyRow row) {
        return row != kNoIndex && activity.is_awake(row) && tables.properties[row].mode == kDynamic;
    };
    for (const std::uint32_t index : activity.pairs()) {
        const Pair& pair = tables.pairs[index];
        if (pair.point_count != 0 && joins(pair.row_a) && joins(pair.row_b) &&
            !is_sensing(tables.properties[pair.row_a], tables.properties[pair.row_b])) {
            islands_.join(pair.row_a, pair.row_b);
        }
    }
    for (const std::uint32_t index : activity.joints()) {
        const Joint& joint = tables.joints[index];
        if (joins(joint.row_a) && joins(joint.row_b)) {
            islands_.join(joint.row_a, joint.row_b);
        }
    }
}

bool SubstepClasses::read(const DynamicsTables& tables, const Activity& activity) {
    const std::span<const BodyRow> rows = activity.rows();
    const auto is_usual = [&](BodyRow row) {
        return asked_by(tables, row) == usual_ || tables.properties[row].mode != kDynamic;
    };
    if (std::all_of(rows.begin(), rows.end(), is_usual)) {
        return false;
    }
    for (const BodyRow row : rows) {
        islands_.begin(row);
        substeps_[row] = static_cast<std::uint8_t>(asked_by(tables, row));
    }
    join(tables, activity);
    // First each island's root has the most, then all of its bodies have.
    for (const BodyRow row : rows) {
        const BodyRow root = islands_.find(row);
        substeps_[root] = std::max(substeps_[root], substeps_[row]);
    }
    std::array<bool, kSubstepsMax + 1> has{};
    for (const BodyRow row : rows) {
        if (tables.properties[row].mode == kDynamic) {
            substeps_[row] = substeps_[islands_.find(row)];
            has[substeps_[row]] = true;
        }
    }
    count_ = 0;
    for (std::uint32_t substeps = 1; substeps <= kSubstepsMax; ++substeps) {
        if (has[substeps]) {
            counts_[count_++] = substeps;
        }
    }
    return true;
}

} // namespace lockwind
