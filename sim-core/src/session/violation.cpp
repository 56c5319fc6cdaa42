#include "session/violation.h"

#include <numeric>

namespace lockwind {

std::string_view to_string(Violation violation) {
    static constexpr std::array<std::string_view, kViolationCount> kNames = {
        "unknown_peer",
        "unexpected_message",
        "wrong_slot",
        "bad_hello",
        "bad_state_hash",
        "input_too_old",
        "input_too_new",
        "input_changed",
        "input_malformed",
        "ack_unconfirmed",
        "hash_unconfirmed",
        "hash_malformed",
        "chunk_unsolicited",
        "chunk_malformed",
        "confirmation_malformed",
        "confirmation_changed",
        "hello_flood",
        "message_flood",
        "undecodable",
    };
    return kNames[static_cast<std::size_t>(violation)];
}

std::uint64_t ViolationCounts::total() const {
    return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

} // namespace lockwind
