#pragma once

#include "session/blob_transfer.h"
#include "session/confirmed_history.h"
#include "session/lockstep_client.h"
#include "session/round_trip.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lockwind {

/// The state machine behind LockstepClient. By concern: lockstep_client_connection.cpp (from Hello
/// to End), lockstep_client_ticks.cpp (inputs, confirmations, hashes); lockstep_client.cpp ties
/// them together.
class LockstepClient::Player {
public:
    explicit Player(const LockstepClientSettings& settings);

    void receive(PeerId from, const Message& message, std::uint64_t now_us);
    void update(std::uint64_t now_us);
    std::uint64_t next_deadline_us() const;
    void created(std::uint64_t hash, std::uint32_t input_size_bytes);
    void restored(std::uint64_t hash);
    void advanced(Tick tick, std::uint64_t hash);
    void send_blob(BlobKind kind, std::vector<std::byte> bytes);
    void leave(EndReason reason, const std::string& message);
    bool wants_input() const;
    Tick next_input_tick() const;
    void add_local_input(Tick tick, const SlotInput& input);

    const LockstepClientSettings settings;
    std::vector<Request> requests;
    ClientPhase phase = ClientPhase::greeting;
    EndReason end_reason = EndReason::complete;
    std::string end_message;
    bool refused = false;
    Slot slot = kNoSlot;
    MatchConfig config;
    ConfirmedHistory received; // without a gap
    Tick advanced_tick = 0;
    std::uint64_t state_hash = 0;
    Tick state_hash_tick = 0;
    Tick agreed_tick = 0; // the server has this hash and those before, and agrees
    LockstepClientCounters counters;

private:
    // Connection.
    void on_welcome(const Welcome& welcome);
    void on_refuse(const Refuse& refuse);
    void on_chunk(const Chunk& chunk);
    void on_end(const End& end);
    void greet();
    void say_ready();
    void take_snapshot();
    void begin(Tick tick, std::uint64_t hash);
    void connect_anew(const std::string& why);
    void check_silence();
    void finish(EndReason reason, const std::string& message);

    // Ticks.
    void on_confirmation(const Confirmation& confirmation);
    bool well_formed(const Confirmation& confirmation) const;
    void take_tick(Tick tick, const std::vector<SlotInput>& inputs);
    void take_ack(const SlotAck& ack);
    void append_received();
    void on_desync_query(const DesyncQuery& query);
    void advance();
    void send_inputs();
    void send_hashes();
    Tick lead_ticks() const;
    Tick input_horizon() const;

    void send(Message message);
    void notify(SessionEventKind kind, Tick tick, std::string text);

    std::uint64_t now_us_ = 0;
    std::uint32_t attempt_ = 0;
    std::uint64_t connect_deadline_us_ = 0;
    std::uint64_t greeting_us_ = 0; // when Hello or Ready is next sent
    std::uint64_t heard_us_ = 0;
    bool interrupted_ = false;
    bool attached_ = false; // the server said so last

    std::uint32_t input_size_bytes_ = kInputSizeBytesMax;
    Tick resume_tick_ = 0;
    std::uint64_t ready_hash_ = 0;
    bool created_ = false;
    std::optional<Blob> snapshot_;
    BlobReceiver snapshot_receiver_;
    BlobSender blob_;

    std::map<Tick, std::vector<SlotInput>> ahead_; // confirmed ticks behind a gap
    Tick server_tick_ = 0;                         // newest one that the server has confirmed
    Tick handed_tick_ = 0;                         // newest AdvanceRequest
    std::uint64_t confirmed_us_ = 0;               // when the newest tick without a gap arrived

    std::deque<SlotInput> inputs_; // own ones, unacknowledged; the first is of inputs_tick_
    Tick inputs_tick_ = 1;
    bool inputs_added_ = false;
    bool ticks_received_ = false; // not acknowledged yet
    std::uint64_t inputs_sent_us_ = 0;

    std::deque<HashReport::Entry> hashes_; // not agreed on yet
    Tick hashes_sent_tick_ = 0;
    std::uint64_t hashes_resend_us_ = 0;
    Tick queried_tick_ = 0;

    RoundTrip round_trip_;
    std::uint64_t echo_us_ = 0;
};

} // namespace lockwind
