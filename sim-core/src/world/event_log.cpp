#include "world/event_log.h"

#include "base/state_hash.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace lockwind {

void EventLog::add(EventType type, BodyId a, BodyId b, std::int64_t value) {
    LOCKWIND_ASSERT(events_.size() < events_.capacity());
    events_.push_back({type, a, b, value});
}

void EventLog::sort() {
    std::sort(events_.begin(), events_.end(), [](const Event& left, const Event& right) {
        return std::tie(left.type, left.a, left.b, left.value) <
               std::tie(right.type, right.a, right.b, right.value);
    });
}

std::uint64_t chain_event(std::uint64_t chain, const Event& event) {
    const std::uint64_t words[] = {chain,
                                   static_cast<std::uint64_t>(event.type),
                                   event.a,
                                   event.b,
                                   static_cast<std::uint64_t>(event.value)};
    std::array<std::byte, sizeof(words)> bytes;
    std::size_t index = 0;
    for (const std::uint64_t word : words) {
        for (unsigned shift = 0; shift < 64; shift += 8) {
            bytes[index] = static_cast<std::byte>((word >> shift) & 0xffU);
            ++index;
        }
    }
    return hash_bytes(bytes);
}

} // namespace lockwind
