#pragma once

#include "forensics/trace.h"
#include "session/messages.h"

#include "lockwind/result.h"
#include "lockwind/simulation.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lockwind {

/// The ticks between the last agreed hash and the first bad one. inputs[i] are those of tick
/// agreed_tick + 1 + i; the last are those of the bad tick.
struct DesyncInterval {
    Tick agreed_tick = 0;
    std::span<const std::byte> agreed_state; // as Simulation::save gave it
    std::span<const std::vector<SlotInput>> inputs;

    Tick bad_tick() const { return agreed_tick + inputs.size(); }
};

/// What one party knows of itself.
struct DesyncParty {
    std::string sim_version;
    std::string build_info;
    MatchConfig config;
};

/// What a client claims of the bad tick.
struct DesyncClaim {
    Slot slot = 0;
    std::uint64_t hash = 0;           // as reported
    std::span<const std::byte> state; // as kept when that hash was taken
};

/// Largest interval that is traced.
inline constexpr std::size_t kDesyncTicksMax = 1024;
/// Once a trace's packed states pass this, the rest of it holds hashes only.
inline constexpr std::size_t kTraceStateBytesMax = 24U << 20U;

/// Re-simulates the interval in trace mode and packs what the server asks for with a DesyncQuery
/// into one blob (BlobKind::desync_report). `simulation` is left as it was, observed by `observer`,
/// which is also called in every traced phase (a fault injected there then shows where it is). An
/// Error where the agreed state cannot be loaded or a step fails.
Result<std::vector<std::byte>> build_desync_report(Simulation& simulation,
                                                   const DesyncInterval& interval,
                                                   const DesyncParty& client,
                                                   const DesyncClaim& claim,
                                                   PhaseObserver* observer = nullptr);

/// The same as the server reads it. Nothing in it is to be believed but what was recomputed.
struct DesyncReport {
    DesyncParty client;
    Slot slot = 0;
    Tick agreed_tick = 0;
    std::vector<std::byte> agreed_state;
    std::vector<std::vector<SlotInput>> inputs;
    std::uint64_t reported_hash = 0;
    std::vector<std::byte> reported_state;
    Trace trace;
    std::uint64_t recomputed_hash = 0; // after the trace's last phase
};

Result<DesyncReport> decode_desync_report(std::span<const std::byte> bytes);

/// Loads interval.agreed_state, advances over the inputs and traces them with states; then restores
/// the state that `simulation` had, and leaves `observer` observing.
Result<Trace> trace_interval(Simulation& simulation,
                             const DesyncInterval& interval,
                             const DesyncParty& party,
                             PhaseObserver* observer = nullptr);

} // namespace lockwind
