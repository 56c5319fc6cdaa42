#pragma once

#include "session/blob_transfer.h"
#include "session/confirmed_history.h"
#include "session/hash_ledger.h"
#include "session/input_buffer.h"
#include "session/lockstep_server.h"
#include "session/roster.h"
#include "session/tick_clock.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lockwind {

/// The state machine behind LockstepServer. By concern: lockstep_server_admission.cpp (who is
/// there), lockstep_server_ticks.cpp (inputs, confirmations, stalls), lockstep_server_agreement.cpp
/// (hashes, desyncs, the end); lockstep_server.cpp ties them together.
class LockstepServer::Match {
public:
    explicit Match(const LockstepServerSettings& settings);

    void receive(PeerId from, const Message& message, std::uint64_t now_us);
    void receive_undecodable(PeerId from, std::uint64_t now_us);
    void update(std::uint64_t now_us);
    std::uint64_t next_deadline_us() const;
    void advanced(Tick tick, std::uint64_t hash, std::uint64_t step_began_us);
    void snapshot_saved(Slot slot, Tick tick, std::uint64_t hash, std::vector<std::byte> bytes);
    void stop(const std::string& reason);
    void fail(const std::string& message, Tick recorded_tick);
    void end(EndReason reason, const std::string& message);
    Tick oldest_needed_tick() const;
    SlotStatus slot_status(Slot slot) const;

    const LockstepServerSettings settings;
    std::vector<Request> requests;
    MatchPhase phase = MatchPhase::gathering;
    EndReason end_reason = EndReason::complete;
    std::string end_message;
    LockstepServerCounters counters;
    ConfirmedHistory confirmed;
    Tick advanced_tick = 0;
    std::uint64_t state_hash = 0;
    Tick state_hash_tick = 0;
    std::vector<HashMismatch> desyncs;

private:
    /// What is known of a seat's connection beside the roster's Seat.
    struct Line {
        Line(std::uint32_t input_size_bytes, const ConductSettings& conduct_settings)
            : inputs(input_size_bytes), conduct(conduct_settings) {}

        InputBuffer inputs;
        Tick confirmed_tick = 0; // acknowledged
        Tick hash_tick = 0;      // agreed on
        Tick resume_tick = 0;
        std::uint64_t resume_hash = 0;
        bool welcomed = false;
        std::uint64_t welcome_us = 0; // when it is next repeated, if asked for
        bool lagging = false;         // substituted till its input is in time again
        std::uint64_t echo_us = 0;
        std::uint64_t echo_arrived_us = 0;
        Tick piece_tick = 0; // confirmed_tick when the last catch-up piece was sent
        std::uint64_t piece_us = 0;
        BlobSender snapshot;
        BlobReceiver report;
        Conduct conduct; // of the slot's player, through all his connections
        bool end_answered = false;
    };
    /// A desync whose report is awaited.
    struct Inquiry {
        HashMismatch desync;
        std::uint64_t query_us = 0; // when the query is next sent
        bool resolved = false;
    };

    // Admission.
    void on_hello(PeerId from, const Hello& hello);
    void on_ready(Slot slot, const Ready& ready);
    void seat(Slot slot, PeerId from, const Hello& hello);
    void welcome(Slot slot, std::uint32_t transfer);
    void drop(Slot slot, const std::string& why);
    void leave(Slot slot, const End& end);
    void rebuke(PeerId from);
    void vacate(Slot slot, SlotState state);
    void check_silence();
    static ConductSettings conduct_of(const LockstepServerSettings& settings);
    void check_conduct(Slot slot, std::uint64_t offences_before);
    void gather();
    void start();

    // Ticks.
    void on_input_batch(Slot slot, const InputBatch& batch);
    void start_playing(Slot slot);
    void run();
    bool waits_for(Slot slot, Tick tick) const;
    bool inputs_complete(Tick tick) const;
    void stall(Tick tick);
    void apply_stall_policy(Tick tick);
    void finish_stall(Tick tick);
    void confirm(Tick tick);
    SlotInput confirmed_input(Slot slot, Tick tick);
    void drop_laggards();
    void check_abandoned();
    void send_confirmations();
    void send_status(PeerId to);
    void send_piece(Slot slot);
    Confirmation acknowledgements() const;
    std::size_t ticks_per_message(std::size_t size_bytes) const;
    void poll_snapshots();

    // Agreement.
    void on_hash_report(Slot slot, const HashReport& report);
    void on_chunk(Slot slot, const Chunk& chunk);
    void begin_inquiry(const HashMismatch& desync);
    void inquire();
    void resolve(Inquiry& inquiry, std::vector<std::byte> report);
    bool hashes_awaited(Tick tick) const;
    void settle(EndReason reason, const std::string& message);
    void check_settled();
    void close();
    void on_message_while_closing(PeerId from, const Message& message);

    // Shared by all.
    void hear(Slot slot, const Message& message);
    void dispatch(Slot slot, const Message& message);
    void send(PeerId to, Message message);
    void pass_time(std::uint64_t now_us);
    void notify_unpaused(Tick tick, std::uint64_t duration_us, const std::string& why);
    void notify(SessionEventKind kind, Slot slot, Tick tick, std::string text);
    void discard_history();
    bool advancing() const { return advanced_tick != confirmed.newest_tick(); }
    bool speaks_for(Slot slot, Slot claimed);

    std::uint64_t now_us_ = 0;
    std::uint64_t gather_deadline_us_ = 0; // 0: no update yet
    Roster roster_;
    std::vector<Line> lines_;
    TickClock clock_;
    HashLedger ledger_;
    std::uint32_t snapshots_ = 0; // transfers begun, whatever the slot: a player may change his
    std::uint64_t status_us_ = 0; // when clients are next sent something, ticks or not

    /// What a tick that is taken back leaves.
    std::uint64_t previous_hash_ = 0;
    Tick previous_hash_tick_ = 0;

    bool stalled_ = false;
    bool stall_policy_applied_ = false;
    bool behind_ = false; // ticks wait only because an earlier one did
    bool paused_ = false;
    std::uint64_t stall_began_us_ = 0;
    std::uint64_t nobody_since_us_ = 0; // 0: somebody is there

    std::vector<Inquiry> inquiries_;
    std::uint64_t phase_deadline_us_ = 0;  // of settling, halted and closing
    std::uint64_t others_deadline_us_ = 0; // halted: for the other clients' hashes of the bad tick
    EndReason pending_reason_ = EndReason::complete; // of settling
    std::string pending_message_;
};

} // namespace lockwind
