#pragma once

#include "base/table.h"
#include "dynamics/contact.h"
#include "dynamics/dynamics.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Which slots of the manifold table are free: scratch, read anew from the table by each phase that
/// takes or frees slots. The lowest free slot is taken first, so that the table's layout follows
/// from the state alone.
class ManifoldSlots {
public:
    explicit ManifoldSlots(std::uint32_t capacity);
    void read(const Table<Manifold>& manifolds);
    /// kNoIndex where all are taken. Makes the slot a live row.
    std::uint32_t take(const DynamicsTables& tables);
    void free(const DynamicsTables& tables, std::uint32_t slot);
    /// The slot's manifold is about to be written.
    void note_change(std::uint32_t slot) { changes_.push_back(slot); }
    /// What was written or freed since forget_changes().
    std::span<const std::uint32_t> changes() const { return changes_; }
    void forget_changes() { changes_.clear(); }
    /// The table then ends with its highest live slot.
    void trim(const DynamicsTables& tables) const;

private:
    std::uint32_t capacity_;
    std::vector<std::uint64_t> taken_; // bits
    std::vector<std::uint32_t> changes_;
    std::size_t first_word_ = 0; // no word before it has a free slot
};

/// Of both tables that manifolds have.
void clear_manifold(const DynamicsTables& tables, std::uint32_t slot);
void set_manifold_count(const DynamicsTables& tables, std::uint32_t count);

} // namespace lockwind
