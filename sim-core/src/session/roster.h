#pragma once

#include "session/messages.h"
#include "session/request.h"

#include "lockwind/types.h"

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace lockwind {

enum class SlotState : std::uint8_t {
    empty = 0,
    joining = 1,     // has its Welcome, builds or loads the world
    catching_up = 2, // has the world; its inputs count from the first tick they are in time for
    playing = 3,     // its inputs count
    dropped = 4,     // kept for its token
    left = 5,        // free for anybody
};

/// Who sits in a slot, and since when something was heard of him.
struct Seat {
    SlotState state = SlotState::empty;
    PeerId peer = kAllPeers;
    std::uint64_t token = 0;
    std::uint32_t attempt = 0; // the Hello's
    std::string build_info;
    bool has_played = false;
    bool interrupted = false;
    std::uint64_t heard_us = 0;
    std::uint64_t since_us = 0; // when this peer took the seat

    /// Somebody is there (perhaps still building the world).
    bool connected() const {
        return state == SlotState::joining || state == SlotState::catching_up ||
               state == SlotState::playing;
    }
    /// He is known to have the world.
    bool attached() const { return state == SlotState::catching_up || state == SlotState::playing; }
};

struct RosterSettings {
    std::uint32_t slots = 1;
    std::string sim_version;
    std::uint64_t interrupted_timeout_us = 500'000;
    std::uint64_t drop_timeout_us = 2'000'000;
    std::uint64_t ready_timeout_us = 30'000'000;
    std::uint64_t seat_interval_us = 500'000;
};

/// What a Hello leads to.
struct Admission {
    enum class Kind : std::uint8_t {
        refused = 0,
        repeated = 1, // of the connection that holds the slot already
        replaces = 2, // the slot's holder comes back before he was missed: drop him first
        seated = 3,
        too_soon = 4, // it was given a slot a moment ago: it is to ask again
    };
    Kind kind = Kind::refused;
    Slot slot = kNoSlot;
    Refuse refuse;
};

/// A peer that sat in a slot once, and is to hear so if it still talks.
struct FormerPeer {
    PeerId peer = kAllPeers;
    std::uint32_t attempt = 0; // the Hello's of the connection that is over
    bool left = false;         // by itself: it knows
    std::uint64_t told_us = 0;
};

/// The seats of a match: who may sit where, and who has fallen silent. Decides, but sends nothing.
class Roster {
public:
    explicit Roster(const RosterSettings& settings);

    /// Decides; changes nothing.
    Admission admit(PeerId from, const Hello& hello, std::uint64_t now_us) const;
    /// Seats a player whom admit() has seated.
    void seat(Slot slot, PeerId peer, const Hello& hello, std::uint64_t now_us);
    void set_state(Slot slot, SlotState state);
    /// The token gets no seat any more. Of very many, only the last ones are remembered.
    void ban(std::uint64_t token);
    /// Nobody could be heard for so long.
    void excuse(std::uint64_t away_us);

    /// Something arrived; true where the seat was interrupted till now.
    bool hear(Slot slot, std::uint64_t now_us);

    enum class Silence : std::uint8_t { none = 0, begins = 1, too_long = 2, never_ready = 3 };
    /// `begins` is given once; the others until the seat's state changes.
    Silence check_silence(Slot slot, std::uint64_t now_us);
    /// When check_silence may next give something new; UINT64_MAX: never.
    std::uint64_t next_deadline_us() const;

    /// The connected seat of a peer; kNoSlot where there is none.
    Slot slot_of(PeerId peer) const;
    /// Of a peer whose seat was taken from it or left, whoever has it now; nullptr where there is
    /// none. Of very many, only the last ones are remembered.
    FormerPeer* former(PeerId peer);

    const Seat& at(Slot slot) const { return seats_[slot]; }
    Slot size() const { return static_cast<Slot>(seats_.size()); }
    std::uint32_t count(SlotState state) const;
    std::uint32_t connected_count() const;

private:
    Slot slot_of_token(std::uint64_t token) const;
    Slot free_slot() const;
    bool is_fresh(const Seat& seat, std::uint64_t now_us) const;

    RosterSettings settings_;
    std::vector<Seat> seats_;
    std::deque<std::uint64_t> banned_;
    std::deque<FormerPeer> former_;
};

} // namespace lockwind
