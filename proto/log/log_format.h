#pragma once

#include "session/messages.h"

#include "lockwind/event.h"
#include "lockwind/simulation.h"
#include "lockwind/types.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lockwind {

/// Number of the log format; a reader reads every version up to its own.
inline constexpr std::uint32_t kLogFormatVersion = 1;

inline constexpr Tick kKeyframeIntervalTicks = 600;

/// First record of a log: everything that the match was started with.
struct LogHeader {
    std::uint32_t format_version = kLogFormatVersion;
    std::string sim_version;
    std::string build_info;            // of the server; free to differ between equal matches
    std::uint64_t started_unix_us = 0; // wall clock, UTC; free to differ between equal matches
    MatchConfig config;                // with the whole scene text
    std::uint32_t input_size_bytes = 0;

    bool operator==(const LogHeader&) const = default;
};

/// Confirmed inputs of a tick, one per slot.
struct TickRecord {
    Tick tick = 0;
    std::vector<SlotInput> inputs;

    bool operator==(const TickRecord&) const = default;
};

/// Hash of state(tick).
struct HashRecord {
    Tick tick = 0;
    std::uint64_t hash = 0;

    bool operator==(const HashRecord&) const = default;
};

/// state(tick), from which a replay may start. `packed_state`: see pack_state in state_pack.h.
struct KeyframeRecord {
    Tick tick = 0;
    std::uint64_t hash = 0;
    std::vector<std::byte> packed_state;

    bool operator==(const KeyframeRecord&) const = default;
};

/// A player took (or took back) a slot; its inputs count from `tick` on.
struct JoinRecord {
    Tick tick = 0;
    Slot slot = 0;
    bool reconnect = false;
    std::string build_info; // of the client; free to differ between equal matches

    bool operator==(const JoinRecord&) const = default;
};

enum class LeaveReason : std::uint8_t { left = 0, dropped = 1, desync = 2, kicked = 3 };

/// Nobody holds the slot from `tick` on.
struct LeaveRecord {
    Tick tick = 0;
    Slot slot = 0;
    LeaveReason reason = LeaveReason::left;

    bool operator==(const LeaveRecord&) const = default;
};

/// The match stood still before `tick` was confirmed; lateness is re-based by it.
struct PauseRecord {
    Tick tick = 0;
    std::uint64_t paused_us = 0; // wall clock; free to differ between equal matches
    std::string reason;

    bool operator==(const PauseRecord&) const = default;
};

/// A setting that changed during the match, from `tick` on.
struct SettingRecord {
    Tick tick = 0;
    std::string name;
    std::string value;

    bool operator==(const SettingRecord&) const = default;
};

struct EventsRecord {
    Tick tick = 0;
    std::vector<Event> events;

    bool operator==(const EventsRecord&) const = default;
};

/// Contacts come and go by the hundred a tick and follow from the inputs; the log keeps what a
/// person looks for.
bool is_logged(const Event& event);

/// A client reported another hash than the server's for a confirmed tick.
struct DesyncRecord {
    Tick tick = 0;
    Slot slot = 0;
    std::uint64_t server_hash = 0;
    std::uint64_t client_hash = 0;

    bool operator==(const DesyncRecord&) const = default;
};

/// Last record of a match that ended cleanly.
struct LogSummary {
    Tick ticks = 0; // confirmed
    Tick state_hash_tick = 0;
    std::uint64_t state_hash = 0;
    std::uint32_t desyncs = 0;
    EndReason reason = EndReason::complete;
    std::string message;
    std::uint64_t ended_unix_us = 0; // wall clock, UTC; free to differ between equal matches

    bool operator==(const LogSummary&) const = default;
};

/// How a log ends. `interrupted`: at a record boundary, without a summary (a kill). `damaged`: a
/// record is torn or wrong; all before it is good.
enum class LogEnd : std::uint8_t { summary = 0, interrupted = 1, damaged = 2 };

/// "summary", "interrupted" or "damaged".
std::string_view to_text(LogEnd end);

/// A state hash as all programs print it: 16 lower-case hexadecimal digits.
std::string hash_text(std::uint64_t hash);

} // namespace lockwind
