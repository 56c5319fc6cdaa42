#pragma once

#include "lockwind/event.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Events of one tick. Allocates on construction only.
class EventLog {
public:
    explicit EventLog(std::size_t capacity) { events_.reserve(capacity); }

    void clear() { events_.clear(); }
    void add(EventType type, BodyId a, BodyId b, std::int64_t value);
    /// By (type, a, b, value).
    void sort();
    std::span<const Event> events() const { return events_; }

private:
    std::vector<Event> events_;
};

/// The chain of event hashes: XXH3-64 of (chain so far, type, a, b, value), five u64 little-endian.
std::uint64_t chain_event(std::uint64_t chain, const Event& event);

} // namespace lockwind
