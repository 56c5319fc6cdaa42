#pragma once

#include "session/messages.h"

#include "lockwind/simulation.h"
#include "lockwind/types.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace lockwind {

/// How a message is to travel; the transport's Channel of the same name.
enum class Delivery : std::uint8_t { best_effort = 0, reliable = 1 };

/// The way that messages.h states for each message.
Delivery delivery_of(const Message& message);

/// In an event: no slot in particular.
inline constexpr Slot kNoSlot = 0xffffffffU;

enum class SessionEventKind : std::uint8_t {
    synchronizing = 0,    // server: a peer was given a slot; client: it asks for one
    synchronized = 1,     // that peer has the world, with the hash that the server has
    started = 2,          // tick 0 of the clock: tick T is due T periods later
    joined = 3,           // a slot's inputs count from this tick on (first time)
    reconnected = 4,      // the same for a player who was there before
    interrupted = 5,      // nothing heard for interrupted_timeout_ms
    resumed = 6,          // heard again
    dropped = 7,          // the slot's inputs are `disconnected` from the next tick on
    left = 8,             // the same, by its own wish
    stalled = 9,          // a due tick waited stall_timeout_ms for this slot's input
    paused = 10,          // server: the clock stands still (stall policy pause)
    unpaused = 11,        // server: the clock runs again, re-based by the pause's length
    desync_detected = 12, // this slot's hash of this tick differs; the tick before agreed
    ended = 13,           // nothing follows but the last acknowledgements
};

std::string_view to_string(SessionEventKind kind);
std::string_view to_string(EndReason reason);
std::string_view to_string(RefuseReason reason);

/// Something to log and to show. Events come in order with the ticks, so a log that holds both
/// repeats the match.
struct SessionEvent {
    SessionEventKind kind = SessionEventKind::synchronizing;
    Slot slot = kNoSlot;
    Tick tick = 0;                 // the last confirmed tick, unless the kind says otherwise
    std::string text;              // for a person; "" where the kind says all
    std::uint64_t duration_us = 0; // unpaused: how long the clock stood still
};

/// A slot's hash of `bad_tick` differs from the server's. `agreed_tick` is the last one on which
/// they agreed.
struct HashMismatch {
    Slot slot = 0;
    Tick agreed_tick = 0;
    Tick bad_tick = 0;
    std::uint64_t server_hash = 0; // of state(bad_tick)
    std::uint64_t client_hash = 0;
};

/// Encode and send.
struct SendRequest {
    PeerId to = kServerPeer;
    Delivery delivery = Delivery::best_effort;
    Message message;
};

/// server: write the record of `tick`, and the hash that the AdvanceRequest before it found where
/// that was due, by one write, before any later request is executed.
struct PersistRequest {
    Tick tick = 0;
    std::vector<SlotInput> inputs;
};

/// Call simulation.advance(inputs), which leads to `tick`. If `hash_due`, hash the state and keep
/// it in the StateHistory. Then call session.advanced(...); on an Error call session.fail(message).
struct AdvanceRequest {
    Tick tick = 0;
    std::vector<SlotInput> inputs;
    bool hash_due = true;
};

/// client: build the simulation of `config`, put state(0) into an empty StateHistory, call
/// session.created(hash) or session.fail(message). Comes again on each reconnect.
struct CreateRequest {
    MatchConfig config;
    Slot slot = 0;
};

/// server: the simulation stands at `tick`; save it, call session.snapshot_saved(slot, tick, hash,
/// bytes).
struct SnapshotRequest {
    Slot slot = 0;
    Tick tick = 0;
};

/// client: load `bytes`, the state of `tick`, into the simulation, keep it in the StateHistory,
/// call session.restored(hash) or, where they are no valid state, session.fail(message).
struct RestoreRequest {
    Tick tick = 0;
    std::vector<std::byte> bytes;
};

/// client: re-simulate agreed_tick .. bad_tick in trace mode, from the kept states and
/// session.confirmed_inputs(tick), and call session.send_blob(BlobKind::desync_report, bytes).
struct DesyncReportRequest {
    HashMismatch desync;
};

/// server: write the bundle of a desync. `report` is what the client sent; empty where nothing came
/// in time. The server's own state of agreed_tick is in the StateHistory, its inputs in
/// session.confirmed_inputs(tick).
struct BundleRequest {
    HashMismatch desync;
    std::vector<std::byte> report;
};

/// Log and show.
struct NotifyRequest {
    SessionEvent event;
};

/// What a session wants done. The driver executes a list strictly in its order; what a session is
/// told on the way (advanced, created ...) may lead to requests of the next list.
using Request = std::variant<SendRequest,
                             PersistRequest,
                             AdvanceRequest,
                             CreateRequest,
                             SnapshotRequest,
                             RestoreRequest,
                             DesyncReportRequest,
                             BundleRequest,
                             NotifyRequest>;

} // namespace lockwind
