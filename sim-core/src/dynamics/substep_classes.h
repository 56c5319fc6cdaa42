#pragma once

#include "dynamics/activity.h"
#include "dynamics/dynamics.h"
#include "dynamics/islands.h"
#include "dynamics/step_constants.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// How many substeps each island takes: the most that one of its bodies asks for; a simplified one
/// asks for no more than level_of_detail.simplified_substeps. An island is what touching pairs and
/// joints hold together in this tick. Scratch of one tick.
class SubstepClasses {
public:
    explicit SubstepClasses(const DynamicsSettings& settings);

    /// False where all bodies that are awake take the settings' substeps; then nothing else is set.
    bool read(const DynamicsTables& tables, const Activity& activity);
    /// The classes that there are, ascending.
    std::span<const std::uint32_t> counts() const { return {counts_.data(), count_}; }
    /// Of a dynamic body that is awake.
    std::uint32_t of(BodyRow row) const { return substeps_[row]; }

private:
    std::uint32_t asked_by(const DynamicsTables& tables, BodyRow row) const;
    void join(const DynamicsTables& tables, const Activity& activity);

    std::uint32_t usual_;
    std::uint32_t simplified_; // at most
    Islands islands_;
    std::vector<std::uint8_t> substeps_; // by row
    std::array<std::uint32_t, kSubstepsMax> counts_{};
    std::size_t count_ = 0;
};

} // namespace lockwind
