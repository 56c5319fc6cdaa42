#pragma once

#include "session/histogram.h"
#include "session/match_config.h"
#include "session/messages.h"
#include "session/request.h"
#include "session/violation.h"

#include "lockwind/simulation.h"
#include "lockwind/types.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lockwind {

struct LockstepClientSettings {
    std::uint64_t token = 1; // never 0
    std::string sim_version;
    std::string build_info;

    std::uint32_t hello_interval_ms = 250;
    std::uint32_t connect_timeout_ms = 30'000; // of each attempt: from its first Hello to the match
    std::uint32_t interrupted_timeout_ms = 500;
    std::uint32_t drop_timeout_ms = 2000; // of silence: then it asks for its slot again
    bool reconnect = true;                // false: being dropped ends the session
    std::uint32_t advance_ticks_max = 8;  // handed out at once, so that catching up does not block
    std::uint32_t stall_after_ticks = 3;  // without a new confirmed tick
    std::size_t snapshot_size_bytes_max = kBlobSizeBytesMax;
};

enum class ClientPhase : std::uint8_t {
    greeting = 0,  // Hello until answered
    creating = 1,  // the driver builds the world
    receiving = 2, // a snapshot is under way (reconnect, late join)
    restoring = 3, // the driver loads it
    ready = 4,     // Ready until the server knows
    playing = 5,
    ended = 6,
};

struct LockstepClientCounters {
    std::uint64_t ticks_confirmed = 0; // received and advanced
    std::uint64_t stalls = 0; // more than stall_after_ticks periods without a new confirmed tick
    std::uint64_t stall_ms_max = 0; // from one confirmed tick to the next
    std::uint64_t reconnects = 0;
    std::uint64_t desyncs = 0;               // reported to this client
    std::uint64_t confirmations_doubled = 0; // ticks that had already arrived
    ViolationCounts violations;
    Histogram rtt_us; // without the time that the server held the message
};

/// A player in a lock-step match: steps confirmed ticks only; its own inputs are for ticks
/// input_delay_ticks and the measured round trip ahead, so that the match is not gated on the round
/// trip.
///
/// A driver's loop: receive() all that arrived; while (wants_input())
/// add_local_input(next_input_tick(), ...); update(now); take_requests() and execute them in order,
/// until there are none; wait until next_deadline_us() or a message.
class LockstepClient {
public:
    explicit LockstepClient(const LockstepClientSettings& settings);
    ~LockstepClient();
    LockstepClient(LockstepClient&&) noexcept;
    LockstepClient& operator=(LockstepClient&&) noexcept;

    /// Any message from anybody; what breaks a rule is counted and ignored.
    void receive(PeerId from, const Message& message, std::uint64_t now_us);
    void update(std::uint64_t now_us);
    std::vector<Request> take_requests();
    /// When update() is next needed if nothing arrives; may be in the past. UINT64_MAX: never.
    std::uint64_t next_deadline_us() const;

    /// A CreateRequest is done: the hash of state(0), and Simulation::input_size_bytes.
    void created(std::uint64_t state_hash, std::uint32_t input_size_bytes);
    /// A RestoreRequest is done: the hash of the state that was loaded.
    void restored(std::uint64_t state_hash);
    /// An AdvanceRequest is done: its state's hash (any value where not hash_due).
    void advanced(Tick tick, std::uint64_t hash);
    /// A DesyncReportRequest is done.
    void send_blob(BlobKind kind, std::vector<std::byte> bytes);
    /// The player leaves; the slot is free.
    void leave();
    /// The simulation failed: leaves, telling the server why.
    void fail(const std::string& message);

    /// Is a local input wanted now, and of which tick?
    bool wants_input() const;
    Tick next_input_tick() const;
    /// \pre wants_input() and tick == next_input_tick(); bytes behind the input's size are zero
    void add_local_input(Tick tick, const SlotInput& input);

    ClientPhase phase() const;
    bool ended() const { return phase() == ClientPhase::ended; }
    /// Once ended: why, and the server's or the session's own words.
    EndReason end_reason() const;
    const std::string& end_message() const;
    /// The server's Refuse ended the session (end_reason() is then failed).
    bool refused() const;
    /// kNoSlot before the first Welcome.
    Slot slot() const;
    const MatchConfig& config() const;
    /// Newest tick received without a gap, and stepped.
    Tick confirmed_tick() const;
    Tick advanced_tick() const;
    /// Newest hash of this client's own, and its tick.
    std::uint64_t state_hash() const;
    Tick state_hash_tick() const;
    const LockstepClientCounters& counters() const;
    /// States and inputs from this tick on may still be asked for; older ones can be dropped.
    Tick oldest_needed_tick() const;
    /// Inputs of a confirmed tick, in slot order; empty where not received or no longer kept.
    std::span<const SlotInput> confirmed_inputs(Tick tick) const;

private:
    class Player;
    std::unique_ptr<Player> player_;
};

} // namespace lockwind
