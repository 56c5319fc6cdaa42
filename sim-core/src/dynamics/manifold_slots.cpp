#include "dynamics/manifold_slots.h"

#include "lockwind/types.h"

#include <algorithm>
#include <bit>

namespace lockwind {

ManifoldSlots::ManifoldSlots(std::uint32_t capacity)
    : capacity_(capacity), taken_(capacity / 64 + 1) {
    changes_.reserve(4 * std::size_t{capacity}); // freed by three phases, written by one
}

void ManifoldSlots::read(const Table<Manifold>& manifolds) {
    std::fill(taken_.begin(), taken_.end(), 0U);
    first_word_ = 0;
    const std::uint32_t count = manifolds.count();
    for (std::uint32_t slot = 0; slot < count; ++slot) {
        if (manifolds[slot].point_count != 0) {
            taken_[slot / 64] |= std::uint64_t{1} << (slot % 64);
        }
    }
}

std::uint32_t ManifoldSlots::take(const DynamicsTables& tables) {
    while (first_word_ < taken_.size() && ~taken_[first_word_] == 0) {
        ++first_word_;
    }
    if (first_word_ == taken_.size()) {
        return kNoIndex;
    }
    const auto bit = static_cast<std::uint32_t>(std::countr_one(taken_[first_word_]));
    const std::uint32_t slot = static_cast<std::uint32_t>(first_word_) * 64 + bit;
    if (slot >= capacity_) {
        return kNoIndex;
    }
    taken_[first_word_] |= std::uint64_t{1} << bit;
    if (slot >= tables.manifolds.count()) {
        set_manifold_count(tables, slot + 1);
    }
    return slot;
}

void ManifoldSlots::free(const DynamicsTables& tables, std::uint32_t slot) {
    clear_manifold(tables, slot);
    note_change(slot);
    taken_[slot / 64] &= ~(std::uint64_t{1} << (slot % 64));
    first_word_ = std::min(first_word_, static_cast<std::size_t>(slot / 64));
}

void ManifoldSlots::trim(const DynamicsTables& tables) const {
    std::uint32_t count = tables.manifolds.count();
    while (count > 0 && (taken_[(count - 1) / 64] >> ((count - 1) % 64) & 1U) == 0) {
        --count;
    }
    set_manifold_count(tables, count);
}

void clear_manifold(const DynamicsTables& tables, std::uint32_t slot) {
    tables.manifolds[slot] = Manifold{};
    tables.impulses[slot] = ContactImpulse{};
}

void set_manifold_count(const DynamicsTables& tables, std::uint32_t count) {
    tables.manifolds.set_count(count);
    tables.impulses.set_count(count);
}

} // namespace lockwind
