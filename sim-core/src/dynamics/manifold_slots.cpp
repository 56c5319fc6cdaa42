#include "dynamics/manifold_slots.h"

#include "lockwind/types.h"

#include <algorithm>
#include <bit>

namespace lockwind {

ManifoldSlots::ManifoldSlots(std::uint32_t capacity)
    : capacity_(capacity), taken_(capacity / 64 + 1) {
    freed_.reserve(2 * std::size_t{capacity}); // by two phases
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

std::uint32_t ManifoldSlots::take(const Table<Manifold>& manifolds) {
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
    if (slot >= manifolds.count()) {
        manifolds.set_count(slot + 1);
    }
    return slot;
}

void ManifoldSlots::free(const Table<Manifold>& manifolds, std::uint32_t slot) {
    manifolds[slot] = Manifold{};
    freed_.push_back(slot);
    taken_[slot / 64] &= ~(std::uint64_t{1} << (slot % 64));
    first_word_ = std::min(first_word_, static_cast<std::size_t>(slot / 64));
}

void ManifoldSlots::trim(const Table<Manifold>& manifolds) const {
    std::uint32_t count = manifolds.count();
    while (count > 0 && (taken_[(count - 1) / 64] >> ((count - 1) % 64) & 1U) == 0) {
        --count;
    }
    manifolds.set_count(count);
}

} // namespace lockwind
