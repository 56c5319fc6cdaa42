#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lockwind {

/// A rule of the protocol that a received message broke. The message, or the entry in it, is
/// ignored.
enum class Violation : std::uint8_t {
    unknown_peer = 0,       // not a holder of a slot, and not a Hello
    unexpected_message = 1, // a kind that this party never receives, or not in this phase
    wrong_slot = 2,         // speaks for a slot that is not its own
    bad_hello = 3,          // refused: version, token
    bad_state_hash = 4,     // a Ready whose world differs
    input_too_old = 5,      // older than the input window
    input_too_new = 6,      // ahead of the input window
    input_changed = 7,      // another input for a tick that already has one
    input_malformed = 8,    // bytes behind the input's size are not zero, or the batch is too long
    ack_unconfirmed = 9,    // acknowledges a tick that is not confirmed
    hash_unconfirmed = 10,  // reports a tick that is not confirmed
    hash_malformed = 11,    // too many entries, not ascending, or a tick without a due hash
    chunk_unsolicited = 12, // nobody asked for this blob
    chunk_malformed = 13,   // sizes, count or index contradict each other or a limit
    confirmation_malformed = 14, // wrong number of slots, or ticks out of range
    confirmation_changed = 15,   // other inputs for a tick that was already confirmed
    hello_flood = 16,            // asks for a slot that changed hands a moment ago
    message_flood = 17,          // more messages than any player sends
    undecodable = 18,            // bytes that are no message, or of one that travels the other way
};
inline constexpr std::size_t kViolationCount = 19;

std::string_view to_string(Violation violation);
/// Whether no link can make an honest player break this rule, however it loses, doubles and delays.
bool is_offence(Violation violation);

class ViolationCounts {
public:
    void add(Violation violation) { ++counts_[static_cast<std::size_t>(violation)]; }
    std::uint64_t of(Violation violation) const {
        return counts_[static_cast<std::size_t>(violation)];
    }
    std::uint64_t total() const;
    /// Of those that are offences.
    std::uint64_t offences() const;

private:
    std::array<std::uint64_t, kViolationCount> counts_{};
};

} // namespace lockwind
