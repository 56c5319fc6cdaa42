#pragma once

#include "base/table.h"
#include "dynamics/body.h"

#include <algorithm>
#include <cstdint>

namespace lockwind {

/// What each body is, by row: the properties of its kind. Most bodies share theirs with many
/// others, so that the kinds stay in the cache where a copy for each body would not.
class BodyPropertiesView {
public:
    BodyPropertiesView(const Table<BodyProperties>& kinds, const Table<BodyLife>& lives)
        : kinds_(kinds), lives_(lives) {}

    std::uint32_t count() const { return lives_.count(); }
    const BodyProperties& operator[](BodyRow row) const {
        // Damaged rows must not lead outside.
        return kinds_[std::min(lives_[row].body_kind, kinds_.capacity() - 1)];
    }

private:
    Table<BodyProperties> kinds_;
    Table<BodyLife> lives_;
};

} // namespace lockwind
