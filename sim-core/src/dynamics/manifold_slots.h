#pragma once

#include "base/table.h"
#include "dynamics/contact.h"

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
    std::uint32_t take(const Table<Manifold>& manifolds);
    void free(const Table<Manifold>& manifolds, std::uint32_t slot);
    /// By free() since forget_freed().
    std::span<const std::uint32_t> freed() const { return freed_; }
    void forget_freed() { freed_.clear(); }
    /// The table then ends with its highest live slot.
    void trim(const Table<Manifold>& manifolds) const;

private:
    std::uint32_t capacity_;
    std::vector<std::uint64_t> taken_; // bits
    std::vector<std::uint32_t> freed_;
    std::size_t first_word_ = 0; // no word before it has a free slot
};

} // namespace lockwind
