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

bool is_offence(Violation violation) {
    switch (violation) {
    // Of messages that come late, or in the name of an earlier connection.
    case Violation::unknown_peer:
    case Violation::bad_hello:
    case Violation::bad_state_hash:
    case Violation::input_too_old:
    case Violation::input_changed:
    case Violation::chunk_unsolicited:
    case Violation::hello_flood:
        return false;
    case Violation::unexpected_message:
    case Violation::wrong_slot:
    case Violation::input_too_new:
    case Violation::input_malformed:
    case Violation::ack_unconfirmed:
    case Violation::hash_unconfirmed:
    case Violation::hash_malformed:
    case Violation::chunk_malformed:
    case Violation::confirmation_malformed:
    case Violation::confirmation_changed:
    case Violation::message_flood:
    case Violation::undecodable:
        return true;
    }
    return false;
}

std::uint64_t ViolationCounts::offences() const {
    std::uint64_t sum = 0;
    for (std::size_t index = 0; index < kViolationCount; ++index) {
        sum += is_offence(static_cast<Violation>(index)) ? counts_[index] : 0;
    }
    return sum;
}

std::uint64_t ViolationCounts::total() const {
    return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

} // namespace lockwind
