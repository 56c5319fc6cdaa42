#pragma once

#include "base/table.h"
#include "dynamics/body.h"

#include <cstdint>
#include <vector>

namespace lockwind {

/// Which of the kinds has given properties, and how many bodies are of it: scratch, read from the
/// tables. The lowest free row is taken first, so that the table's layout follows from the state
/// alone.
class BodyKinds {
public:
    explicit BodyKinds(std::uint32_t body_capacity);

    /// The tables are not those of before.
    void forget() { known_ = false; }
    /// Reads the tables. False where a body has no kind, two kinds are equal, or a row that no body
    /// has is not zero; nothing else may then be asked.
    bool read(const Table<BodyProperties>& kinds, const Table<BodyLife>& lives);
    /// Reads sound tables, unless they are those of before.
    void know(const Table<BodyProperties>& kinds, const Table<BodyLife>& lives);
    /// Of a world without kinds.
    void begin();
    /// Row of the kind with these properties, for one body more. There are no more kinds than
    /// bodies.
    std::uint32_t take(const Table<BodyProperties>& kinds, const BodyProperties& properties);
    /// For one body less: the kind goes with its last.
    void release(const Table<BodyProperties>& kinds, std::uint32_t kind);

private:
    std::uint32_t& bucket_of(const BodyProperties& properties);
    std::uint32_t find(const Table<BodyProperties>& kinds, const BodyProperties& properties);

    bool known_ = false;
    std::uint32_t first_free_ = 0;       // no row before it is free
    std::vector<std::uint32_t> uses_;    // by kind
    std::vector<std::uint32_t> buckets_; // first kind of those with a hash, or kNoIndex
    std::vector<std::uint32_t> next_;    // by kind: the next one in its bucket
};

} // namespace lockwind
