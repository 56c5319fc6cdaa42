#pragma once

#include "base/arena.h"
#include "base/page_versions.h"

#include "lockwind/kept_state.h"

#include <memory>

namespace lockwind {

/// Copies of an arena's live rows, derived ones too, in this machine's order, that know which pages
/// have changed since.
class Keeper {
public:
    Keeper();
    /// `kept` may hold what this keeper kept before: it is brought up to date. Allocates only where
    /// it is too small.
    void keep(const StateArena& arena, PageVersions& versions, KeptState& kept) const;
    /// Asserts that `kept` is of this keeper, and of an arena of the same schema and capacities.
    void restore(StateArena& arena, PageVersions& versions, const KeptState& kept) const;

private:
    std::shared_ptr<const int>
        token_; // alive as long as something that was kept: tells keepers apart
};

} // namespace lockwind
