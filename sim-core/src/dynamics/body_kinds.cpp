#include "dynamics/body_kinds.h"

#include "base/state_hash.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace lockwind {

namespace {

bool same(const BodyProperties& a, const BodyProperties& b) {
    return std::memcmp(&a, &b, sizeof(BodyProperties)) == 0;
}

} // namespace

BodyKinds::BodyKinds(std::uint32_t body_capacity)
    : uses_(body_capacity), buckets_(std::bit_ceil(std::max(body_capacity, 1U))),
      next_(body_capacity) {}

std::uint32_t& BodyKinds::bucket_of(const BodyProperties& properties) {
    const std::uint64_t hash = hash_bytes(std::as_bytes(std::span(&properties, 1)));
    return buckets_[static_cast<std::size_t>(hash) & (buckets_.size() - 1)];
}

std::uint32_t BodyKinds::find(const Table<BodyProperties>& kinds,
                              const BodyProperties& properties) {
    std::uint32_t kind = bucket_of(properties);
    while (kind != kNoIndex && !same(kinds[kind], properties)) {
        kind = next_[kind];
    }
    return kind;
}

void BodyKinds::begin() {
    std::fill(uses_.begin(), uses_.end(), 0U);
    std::fill(buckets_.begin(), buckets_.end(), kNoIndex);
    first_free_ = 0;
    known_ = true;
}

bool BodyKinds::read(const Table<BodyProperties>& kinds, const Table<BodyLife>& lives) {
    begin();
    known_ = false;
    for (const BodyLife& life : lives.rows()) {
        if (life.body_kind >= kinds.count()) {
            return false;
        }
        ++uses_[life.body_kind];
    }
    constexpr BodyProperties kFree{};
    for (std::uint32_t kind = 0; kind < kinds.count(); ++kind) {
        if (uses_[kind] == 0) {
            if (!same(kinds[kind], kFree)) {
                return false;
            }
            continue;
        }
        if (find(kinds, kinds[kind]) != kNoIndex) {
            return false;
        }
        std::uint32_t& bucket = bucket_of(kinds[kind]);
        next_[kind] = bucket;
        bucket = kind;
    }
    known_ = true;
    return true;
}

void BodyKinds::know(const Table<BodyProperties>& kinds, const Table<BodyLife>& lives) {
    if (!known_) {
        const bool sound = read(kinds, lives);
        LOCKWIND_ASSERT(sound);
    }
}

std::uint32_t BodyKinds::take(const Table<BodyProperties>& kinds,
                              const BodyProperties& properties) {
    std::uint32_t kind = find(kinds, properties);
    if (kind == kNoIndex) {
        while (uses_[first_free_] != 0) {
            ++first_free_;
        }
        kind = first_free_;
        kinds.set_count(std::max(kinds.count(), kind + 1));
        kinds[kind] = properties;
        std::uint32_t& bucket = bucket_of(properties);
        next_[kind] = bucket;
        bucket = kind;
    }
    ++uses_[kind];
    return kind;
}

void BodyKinds::release(const Table<BodyProperties>& kinds, std::uint32_t kind) {
    if (--uses_[kind] != 0) {
        return;
    }
    std::uint32_t* link = &bucket_of(kinds[kind]);
    while (*link != kind) {
        link = &next_[*link];
    }
    *link = next_[kind];
    kinds[kind] = BodyProperties{};
    first_free_ = std::min(first_free_, kind);
    std::uint32_t count = kinds.count();
    while (count > 0 && uses_[count - 1] == 0) {
        --count;
    }
    kinds.set_count(count);
}

} // namespace lockwind
