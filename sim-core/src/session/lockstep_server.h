#pragma once

#include "session/conduct.h"
#include "session/histogram.h"
#include "session/match_config.h"
#include "session/messages.h"
#include "session/request.h"
#include "session/roster.h"
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

/// What happens when a due tick has waited stall_timeout_ms for a slot's input.
enum class StallPolicy : std::uint8_t {
    pause = 0,      // the clock stands still until the input comes or the slot is dropped
    substitute = 1, // its last input is repeated, and it is waited for again once it is in time
    drop = 2,       // the slot is dropped
};

struct LockstepServerSettings {
    MatchConfig config; // check(config) holds
    std::string sim_version;
    std::string build_info;
    std::uint32_t input_size_bytes = 1;   // Simulation::input_size_bytes
    std::uint64_t initial_state_hash = 0; // of state(0)

    StallPolicy stall_policy = StallPolicy::pause;
    std::uint32_t stall_timeout_ms = 250;
    std::uint32_t interrupted_timeout_ms = 500;
    std::uint32_t drop_timeout_ms = 2000;
    std::uint32_t join_timeout_ms = 30'000;    // from the first update to the start
    std::uint32_t ready_timeout_ms = 30'000;   // from a Welcome to the slot's first input in time
    std::uint32_t start_delay_ms = 100;        // from all present to the start of the clock
    std::uint32_t settle_timeout_ms = 2000;    // after the last tick, for its hashes
    std::uint32_t report_timeout_ms = 20'000;  // after a desync, for the clients' reports
    std::uint32_t close_timeout_ms = 1000;     // after End, for the answers
    std::uint32_t seat_interval_ms = 500;      // from one player in a slot to the next
    std::uint32_t welcome_interval_ms = 100;   // from one Welcome to its repetition
    std::uint32_t abandon_timeout_ms = 10'000; // config.ticks 0: with nobody there
    std::uint32_t hash_lag_ticks_max = 128;    // withheld for longer: dropped
    std::uint32_t catch_up_ticks_max = 4096;   // further behind: dropped
    std::uint32_t confirmation_size_bytes = 1200; // to all: one datagram
    std::uint32_t catch_up_size_bytes = 50'000;   // to one that is far behind
    std::size_t report_size_bytes_max = kBlobSizeBytesMax;
    ConductSettings conduct; // messages_per_s has 8 a tick on top
};

enum class MatchPhase : std::uint8_t {
    gathering = 0, // until all are there
    running = 1,
    settling = 2, // no more ticks; the last hashes are awaited
    halted = 3,   // a desync; the clients' reports are awaited
    closing = 4,  // End is sent until answered
    ended = 5,
};

struct SlotStatus {
    SlotState state = SlotState::empty;
    PeerId peer = kAllPeers;
    std::uint64_t token = 0;
    std::string build_info;
    bool interrupted = false;
    Tick input_tick = 0;     // inputs up to here have arrived or are no longer wanted
    Tick confirmed_tick = 0; // acknowledged by the client
    Tick hash_tick = 0;      // agreed on
};

struct LockstepServerCounters {
    std::uint64_t late_inputs = 0; // arrived after their tick was confirmed without them
    std::uint64_t substituted_inputs = 0;
    std::uint64_t stalls =
        0; // times that a due tick's inputs were not there; catching up is no other
    std::uint64_t stall_ms_max = 0;
    std::uint64_t drops = 0;
    std::uint64_t reconnects = 0;
    std::uint64_t joins = 0; // first times in a slot, those before the start included
    std::uint64_t desyncs = 0;
    std::uint64_t hashes_agreed = 0;
    ViolationCounts violations;
    Histogram tick_lateness_us; // when a step began minus (start + tick * period)
};

/// The server of a lock-step match: admits players, waits for every player's input of a tick,
/// confirms it, compares hashes. Sans-IO: it is told the time and what arrived, and asks for
/// everything else.
///
/// Per tick it asks, in this order: AdvanceRequest, PersistRequest, SendRequest(Confirmation). The
/// record, with the tick's hash, is written before anybody hears of the tick. The next tick begins
/// only when this one has been reported by advanced().
///
/// A driver's loop: receive() all that arrived; update(now); take_requests() and execute them in
/// order, until there are none; wait until next_deadline_us() or a message.
class LockstepServer {
public:
    explicit LockstepServer(const LockstepServerSettings& settings);
    ~LockstepServer();
    LockstepServer(LockstepServer&&) noexcept;
    LockstepServer& operator=(LockstepServer&&) noexcept;

    /// Any message from anybody; what breaks a rule is counted and ignored.
    void receive(PeerId from, const Message& message, std::uint64_t now_us);
    /// Bytes from anybody that could not be decoded.
    void receive_undecodable(PeerId from, std::uint64_t now_us);
    void update(std::uint64_t now_us);
    std::vector<Request> take_requests();
    /// When update() is next needed if nothing arrives; may be in the past. UINT64_MAX: never.
    std::uint64_t next_deadline_us() const;

    /// An AdvanceRequest is done: its state's hash (any value where not hash_due), and when its
    /// step began.
    void advanced(Tick tick, std::uint64_t hash, std::uint64_t step_began_us);
    /// A SnapshotRequest is done.
    void snapshot_saved(Slot slot, Tick tick, std::uint64_t hash, std::vector<std::byte> bytes);
    /// No further ticks; settles the hashes and ends the match (SIGINT).
    void stop(const std::string& reason);
    /// The simulation or the log failed: ends the match at once, as it was at `recorded_tick`, the
    /// newest tick in the log (at most one less than confirmed_tick()). The driver executes nothing
    /// more of the list in which that happened, so that nobody hears of a tick that is not in it.
    void fail(const std::string& message, Tick recorded_tick);

    MatchPhase phase() const;
    bool ended() const { return phase() == MatchPhase::ended; }
    EndReason end_reason() const;           // once closing or ended
    const std::string& end_message() const; // the same
    Tick confirmed_tick() const;
    Tick advanced_tick() const;
    /// Newest hash of the server's own, and its tick.
    std::uint64_t state_hash() const;
    Tick state_hash_tick() const;
    const MatchConfig& config() const;
    SlotStatus slot_status(Slot slot) const;
    const LockstepServerCounters& counters() const;
    std::span<const HashMismatch> desyncs() const;
    /// States and inputs from this tick on may still be asked for; older ones can be dropped.
    Tick oldest_needed_tick() const;
    /// Inputs of a confirmed tick, in slot order; empty where no longer kept.
    std::span<const SlotInput> confirmed_inputs(Tick tick) const;

private:
    class Match;
    std::unique_ptr<Match> match_;
};

} // namespace lockwind
