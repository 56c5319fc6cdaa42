#pragma once

#include "lockwind/simulation.h"
#include "lockwind/types.h"

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace lockwind {

/// Address of a party on a match's transport. The server is 0; clients draw theirs at random.
using PeerId = std::uint32_t;
inline constexpr PeerId kServerPeer = 0;
inline constexpr PeerId kAllPeers = 0xffffffffU; // as a receiver only

inline constexpr std::uint32_t kProtocolVersion = 1;

/// Limits of what a message may carry, checked by the decoder before anything is allocated and by
/// the sessions again.
inline constexpr std::uint32_t kPlayersMax = 64;
inline constexpr std::size_t kInputBatchTicksMax = 128;
inline constexpr std::size_t kConfirmationTicksMax = 1024;
inline constexpr std::size_t kHashReportEntriesMax = 256;

/// What must be the same on both ends; compared field by field, a refusal names the field.
struct MatchConfig {
    std::string match;
    std::string mode; // "lockstep"
    std::string scene_name;
    std::string scene_text; // whole scene, so that a client needs no file
    std::uint64_t seed = 1;
    std::uint32_t tick_rate_hz = 60;
    std::uint32_t players = 1;
    std::uint32_t input_delay_ticks = 2;
    std::uint32_t hash_interval_ticks = 1;
    Tick ticks = 0; // of the match; 0: until all have left

    bool operator==(const MatchConfig&) const = default;
};

/// client -> server, RELIABLE. First message, repeated until answered.
struct Hello {
    std::uint32_t protocol_version = kProtocolVersion;
    std::string sim_version;
    std::string build_info;
    std::uint64_t token = 0;   // names the player: the same token gets its slot back; never 0
    std::uint32_t attempt = 1; // number of the connection of this peer, from 1
};

/// server -> client, RELIABLE. A seat in the match.
struct Welcome {
    Slot slot = 0;
    MatchConfig config;
    std::string sim_version;
    std::string build_info;
    Tick resume_tick = 0; // > 0: a snapshot of this tick follows as a blob (reconnect, late join)
    std::uint32_t transfer = 0; // number of that blob's transfer; 0: none follows
    std::uint32_t attempt = 1;  // the Hello's
};

enum class RefuseReason : std::uint8_t {
    protocol_version = 0,
    sim_version = 1,
    config = 2,
    match_full = 3,
    token_in_use = 4,
    match_over = 5,
    misconduct = 6,
};

/// server -> client, RELIABLE.
struct Refuse {
    RefuseReason reason = RefuseReason::match_full;
    std::string field;   // what differs, "" where nothing does
    std::string message; // both values, for a person
};

/// client -> server, RELIABLE. The world is built (or loaded); repeated until a Confirmation whose
/// own SlotAck is `attached`.
struct Ready {
    Tick tick = 0;
    std::uint64_t state_hash = 0; // of state(tick)
};

/// client -> server, BEST_EFFORT. All inputs that the server has not acknowledged.
struct InputBatch {
    Slot slot = 0;
    Tick first_tick = 0;
    std::vector<SlotInput> inputs; // status ignored
    Tick confirmed_tick = 0;       // acknowledges every confirmation up to here
    std::uint64_t sent_us = 0;     // sender's clock, echoed for the round trip
};

/// One confirmed tick: inputs in slot order.
struct ConfirmedTick {
    std::vector<SlotInput> inputs;
};

/// What the server tells each slot with every confirmation.
struct SlotAck {
    Tick input_tick = 0;            // inputs up to here have arrived
    Tick hash_tick = 0;             // hash reports up to here have arrived and agree
    std::uint64_t echo_us = 0;      // sent_us of the newest InputBatch; 0 before the first
    std::uint32_t echo_hold_us = 0; // from that InputBatch's arrival to this message
    bool attached = false; // the slot's holder is known to have the world (its Ready arrived)
};

/// server -> all (or to one that is far behind), BEST_EFFORT. Every tick that some client has not
/// acknowledged. No ticks: only the acknowledgements, to be heard of.
struct Confirmation {
    Tick first_tick = 0;
    Tick confirmed_tick = 0; // the newest of the server; ticks up to here exist
    std::vector<ConfirmedTick> ticks;
    std::vector<SlotAck> acks; // one per slot
};

/// client -> server, RELIABLE. Hashes of confirmed ticks, repeated until acknowledged (SlotAck).
struct HashReport {
    struct Entry {
        Tick tick = 0;
        std::uint64_t hash = 0;
    };
    Slot slot = 0;
    std::vector<Entry> entries;
};

enum class BlobKind : std::uint8_t { snapshot = 0, desync_report = 1 };

/// Either way, RELIABLE. A piece of a blob, at most kChunkSizeBytesMax; a window of 2 is in flight.
struct Chunk {
    BlobKind kind = BlobKind::snapshot;
    std::uint32_t transfer = 0; // number of the transfer, from 1, per sender
    std::uint32_t index = 0;
    std::uint32_t count = 0;
    std::uint32_t blob_size_bytes = 0;
    std::vector<std::byte> bytes;
};
inline constexpr std::size_t kChunkSizeBytesMax = 60'000;
inline constexpr std::size_t kBlobSizeBytesMax = 64U << 20U;

/// Either way, RELIABLE.
struct ChunkAck {
    std::uint32_t transfer = 0;
    std::uint32_t index = 0;
};

/// server -> client, RELIABLE. Asks for a desync report: re-simulate agreed_tick .. bad_tick in
/// trace mode.
struct DesyncQuery {
    Tick agreed_tick = 0;
    Tick bad_tick = 0;
    std::uint64_t server_hash = 0; // of state(bad_tick)
    std::uint64_t client_hash = 0; // as reported
};

enum class EndReason : std::uint8_t {
    complete = 0,
    desync = 1,
    stopped = 2,
    left = 3,
    failed = 4,
    dropped = 5, // to one client: its slot was dropped; the same token may come back with a Hello
};

/// server -> all or one, or client -> server (left), RELIABLE. The sender is done; last_tick is the
/// last confirmed. The server repeats it until each client has answered with its own End (left).
struct End {
    EndReason reason = EndReason::complete;
    Tick last_tick = 0;
    std::uint32_t attempt = 0; // of the connection that ends; 0: of all
    std::string message;
};

using Message = std::variant<Hello,
                             Welcome,
                             Refuse,
                             Ready,
                             InputBatch,
                             Confirmation,
                             HashReport,
                             Chunk,
                             ChunkAck,
                             DesyncQuery,
                             End>;

} // namespace lockwind
