#pragma once

#include "lockwind/result.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lockwind {

/// How a payload travels. best_effort: may be lost, doubled, reordered. reliable: in order to a
/// live peer, but may be lost with the connection, so the application acknowledges it.
enum class Channel : std::uint8_t { best_effort = 0, reliable = 1 };

/// Addresses, the same numbers as session's PeerId.
inline constexpr std::uint32_t kServerAddress = 0;
inline constexpr std::uint32_t kEveryAddress = 0xffffffffU; // as a receiver only

/// One payload as it arrived.
struct Packet {
    std::uint32_t from = 0;
    Channel channel = Channel::best_effort;
    std::vector<std::byte> bytes;
};

enum class SendResult : std::uint8_t {
    sent = 0,
    full = 1, // not written: the writer's queue is full; retry or give up on the laggard
};

/// Payload bytes and payloads: given to send() and sent, delivered by receive(); and those that
/// arrived but are not delivered.
struct TransportStats {
    std::uint64_t bytes_out = 0;
    std::uint64_t bytes_in = 0;
    std::uint64_t packets_out = 0;
    std::uint64_t packets_in = 0;
    std::uint64_t packets_malformed = 0; // another match's, an impossible sender, too long
    std::uint64_t packets_spoofed = 0;   // a sender that belongs to another writer or process
};

/// One endpoint of a match: moves opaque bytes between peers. A star: the server speaks to any
/// client or to all, a client to the server alone. Addressed to somebody else: never delivered.
/// Knows nothing of messages. Not thread-safe.
class Transport {
public:
    virtual ~Transport() = default;

    /// At most kPayloadSizeBytesMax bytes. A receiver that is not there is no error.
    virtual SendResult
    send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) = 0;
    /// Appends what has arrived.
    virtual void receive(std::vector<Packet>& out) = 0;
    /// Returns when something has arrived or at `deadline_us` (clock_us()), whichever is first; may
    /// return earlier. A transport on a virtual clock returns at once and advances nothing.
    virtual void wait_until(std::uint64_t deadline_us) = 0;
    /// The transport's monotonic clock, us; virtual in a simulated network.
    virtual std::uint64_t clock_us() const = 0;
    /// How many peers are matched now: a client waits for 1 before its first message.
    virtual std::uint32_t peer_count() const = 0;
    virtual TransportStats stats() const = 0;
};

/// Largest payload that send() takes.
inline constexpr std::size_t kPayloadSizeBytesMax = 64'000;

} // namespace lockwind
