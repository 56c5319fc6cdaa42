#pragma once

#include "session/match_config.h"
#include "session/messages.h"

#include "lockwind/result.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace lockwind {

/// Which way the receiver expects a message to travel. A kind that only travels the other way is
/// refused.
enum class Direction : std::uint8_t { either = 0, to_server = 1, to_client = 2 };

/// What a receiver accepts beyond the ranges of messages.h and match_config.h. Every bound is
/// inclusive.
struct MessageLimits {
    Direction direction = Direction::either;
    Tick tick_max = Tick{1} << 40U;          // 580 years at 60 Hz: sums of ticks cannot overflow
    std::uint32_t players_max = kPlayersMax; // slots are below it
    std::uint64_t query_ticks_max = 65'536;  // bad_tick - agreed_tick of a DesyncQuery
    std::size_t blob_size_bytes_max = kBlobSizeBytesMax;
};

inline constexpr std::size_t kMessageSizeBytesMax = 64'000; // of any encoded message
inline constexpr std::size_t kNameSizeBytesMax = 64; // match, mode, sim_version, Refuse::field
inline constexpr std::size_t kSceneNameSizeBytesMax = 256;
inline constexpr std::size_t kTextSizeBytesMax = 1'024; // build_info; Refuse and End::message
inline constexpr std::size_t kConfigSceneTextSizeBytesMax = 60'000;

/// Name of the message's kind, as in messages.proto.
std::string_view kind_name(const Message& message);

/// True for the kinds that travel on the reliable channel.
bool is_reliable(const Message& message);

/// Which rule of `limits` the message breaks, if any. What it accepts, encode() takes, and decode()
/// with the same limits gives back.
Status check(const Message& message, const MessageLimits& limits = {});

/// Replaces `out` by the message's bytes: the same on every architecture and compiler. The message
/// passes check(), save that Refuse::message and End::message may be anything: what is no UTF-8
/// becomes '?' and what is too long is cut. The status of an InputBatch's inputs is not sent.
void encode(const Message& message, std::vector<std::byte>& out);
std::vector<std::byte> encode(const Message& message);

/// Reads a peer's bytes. Never asserts, and allocates no more than a small multiple of their size;
/// the Error names the message, the field and the rule that was broken. Fields of newer versions
/// are ignored. Inputs of an InputBatch come out with status confirmed.
Result<Message> decode(std::span<const std::byte> bytes, const MessageLimits& limits = {});

} // namespace lockwind
