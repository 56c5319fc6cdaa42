#include "session/roster.h"

#include <algorithm>
#include <limits>

namespace lockwind {
namespace {

Admission refusal(RefuseReason reason, std::string field, std::string message) {
    Admission admission;
    admission.refuse = Refuse{reason, std::move(field), std::move(message)};
    return admission;
}

Admission seat_in(Slot slot, Admission::Kind kind) {
    Admission admission;
    admission.kind = kind;
    admission.slot = slot;
    return admission;
}

/// Adds `item`, and forgets the oldest ones beyond a bound.
template <class T>
void remember(std::deque<T>& items, const T& item) {
    constexpr std::size_t kRememberedMax = 256;
    items.push_back(item);
    if (items.size() > kRememberedMax) {
        items.pop_front();
    }
}

} // namespace

Roster::Roster(const RosterSettings& settings) : settings_(settings), seats_(settings.slots) {}

Slot Roster::slot_of_token(std::uint64_t token) const {
    for (Slot slot = 0; slot < size(); ++slot) {
        if (seats_[slot].state != SlotState::empty && seats_[slot].token == token) {
            return slot;
        }
    }
    return kNoSlot;
}

/// Never held ones before those that were left, so that who left may come back to his own.
Slot Roster::free_slot() const {
    for (const SlotState state : {SlotState::empty, SlotState::left}) {
        for (Slot slot = 0; slot < size(); ++slot) {
            if (seats_[slot].state == state) {
                return slot;
            }
        }
    }
    return kNoSlot;
}

/// Every change of hands costs a snapshot, a message to all and a line of the log.
bool Roster::is_fresh(const Seat& seat, std::uint64_t now_us) const {
    return seat.since_us != 0 && now_us - seat.since_us < settings_.seat_interval_us;
}

void Roster::ban(std::uint64_t token) {
    remember(banned_, token);
}

void Roster::excuse(std::uint64_t away_us) {
    for (Seat& seat : seats_) {
        seat.heard_us += away_us;
        seat.since_us += seat.since_us == 0 ? 0 : away_us;
    }
}

Admission Roster::admit(PeerId from, const Hello& hello, std::uint64_t now_us) const {
    if (hello.protocol_version != kProtocolVersion) {
        return refusal(RefuseReason::protocol_version,
                       "protocol_version",
                       "the server speaks protocol version " + std::to_string(kProtocolVersion) +
                           ", the client " + std::to_string(hello.protocol_version));
    }
    if (hello.sim_version != settings_.sim_version) {
        return refusal(RefuseReason::sim_version,
                       "sim_version",
                       "the server simulates with version " + settings_.sim_version +
                           ", the client with " + hello.sim_version);
    }
    if (hello.token == 0) {
        return refusal(RefuseReason::config, "token", "the token is 0; any other value is valid");
    }
    if (std::find(banned_.begin(), banned_.end(), hello.token) != banned_.end()) {
        return refusal(RefuseReason::misconduct,
                       "token",
                       "this player broke the protocol again and again and has no place any more");
    }
    const Slot held = slot_of_token(hello.token);
    if (held == kNoSlot) {
        const bool had_one = std::any_of(seats_.begin(), seats_.end(), [&](const Seat& seat) {
            return seat.peer == from && is_fresh(seat, now_us);
        });
        const Slot slot = slot_of(from) == kNoSlot ? free_slot() : kNoSlot;
        return slot == kNoSlot
                   ? refusal(RefuseReason::match_full,
                             "",
                             "all " + std::to_string(size()) + " slots of the match are taken")
                   : seat_in(slot, had_one ? Admission::Kind::too_soon : Admission::Kind::seated);
    }
    const Seat& seat = seats_[held];
    const bool is_free = !seat.connected();
    if (is_free || (seat.peer == from && hello.attempt > seat.attempt)) {
        const Admission::Kind kind = is_free ? Admission::Kind::seated : Admission::Kind::replaces;
        return seat_in(held, is_fresh(seat, now_us) ? Admission::Kind::too_soon : kind);
    }
    if (seat.peer == from) {
        return seat_in(held, Admission::Kind::repeated);
    }
    if (now_us - seat.heard_us < settings_.interrupted_timeout_us) {
        return refusal(RefuseReason::token_in_use,
                       "token",
                       "slot " + std::to_string(held) + " has a live player with this token");
    }
    return seat_in(held, Admission::Kind::replaces);
}

void Roster::seat(Slot slot, PeerId peer, const Hello& hello, std::uint64_t now_us) {
    Seat& seat = seats_[slot];
    const bool same_player = seat.token == hello.token;
    std::erase_if(former_, [peer](const FormerPeer& past) { return past.peer == peer; });
    seat.has_played = seat.has_played && same_player;
    seat.state = SlotState::joining;
    seat.peer = peer;
    seat.token = hello.token;
    seat.attempt = hello.attempt;
    seat.build_info = hello.build_info;
    seat.interrupted = false;
    seat.heard_us = now_us;
    seat.since_us = now_us;
}

void Roster::set_state(Slot slot, SlotState state) {
    Seat& seat = seats_[slot];
    const bool was_connected = seat.connected();
    seat.state = state;
    seat.has_played = seat.has_played || state == SlotState::playing;
    if (was_connected && !seat.connected()) {
        remember(former_, FormerPeer{seat.peer, seat.attempt, state == SlotState::left, 0});
    }
}

bool Roster::hear(Slot slot, std::uint64_t now_us) {
    Seat& seat = seats_[slot];
    const bool was_interrupted = seat.interrupted;
    seat.interrupted = false;
    seat.heard_us = now_us;
    return was_interrupted;
}

// Somebody who builds or loads the world says nothing meanwhile: only ready_timeout binds him.
Roster::Silence Roster::check_silence(Slot slot, std::uint64_t now_us) {
    Seat& seat = seats_[slot];
    if (!seat.connected()) {
        return Silence::none;
    }
    if (seat.state != SlotState::playing && now_us - seat.since_us >= settings_.ready_timeout_us) {
        return Silence::never_ready;
    }
    const std::uint64_t silent_us = now_us - seat.heard_us;
    if (seat.state == SlotState::joining || silent_us < settings_.interrupted_timeout_us) {
        return Silence::none;
    }
    if (silent_us >= settings_.drop_timeout_us) {
        return Silence::too_long;
    }
    const bool begins = !seat.interrupted;
    seat.interrupted = true;
    return begins ? Silence::begins : Silence::none;
}

std::uint64_t Roster::next_deadline_us() const {
    std::uint64_t deadline = std::numeric_limits<std::uint64_t>::max();
    for (const Seat& seat : seats_) {
        if (seat.state == SlotState::joining || seat.state == SlotState::catching_up) {
            deadline = std::min(deadline, seat.since_us + settings_.ready_timeout_us);
        }
        if (seat.attached()) {
            const std::uint64_t timeout_us =
                seat.interrupted ? settings_.drop_timeout_us : settings_.interrupted_timeout_us;
            deadline = std::min(deadline, seat.heard_us + timeout_us);
        }
    }
    return deadline;
}

Slot Roster::slot_of(PeerId peer) const {
    for (Slot slot = 0; slot < size(); ++slot) {
        if (seats_[slot].connected() && seats_[slot].peer == peer) {
            return slot;
        }
    }
    return kNoSlot;
}

FormerPeer* Roster::former(PeerId peer) {
    const auto found = std::find_if(former_.begin(), former_.end(), [peer](const FormerPeer& past) {
        return past.peer == peer;
    });
    return found == former_.end() ? nullptr : &*found;
}

std::uint32_t Roster::count(SlotState state) const {
    const auto count = std::count_if(
        seats_.begin(), seats_.end(), [state](const Seat& seat) { return seat.state == state; });
    return static_cast<std::uint32_t>(count);
}

std::uint32_t Roster::connected_count() const {
    const auto count = std::count_if(
        seats_.begin(), seats_.end(), [](const Seat& seat) { return seat.connected(); });
    return static_cast<std::uint32_t>(count);
}

} // namespace lockwind
