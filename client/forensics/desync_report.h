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
/// into one blob (BlobKind::desync_report). `simulation` is left as trace_interval leaves it. An
/// Error where the agreed state cannot be loaded, a step fails, or the blob would be larger than
/// kBlobSizeBytesMax.
Result<std::vector<std::byte>> build_desync_report(Simulation& simulation,
                                                   const DesyncInterval& interval,
                                                   const Party& client,
                                                   const DesyncClaim& claim,
                                                   PhaseObserver* observer = nullptr);

/// The same as the server reads it. Nothing in it is to be believed but what was recomputed.
struct DesyncReport {
    Party client;
    Slot slot = 0;
    Tick agreed_tick = 0;
    std::vector<std::byte> agreed_state;
    std::vector<std::vector<SlotInput>> inputs;
    std::uint64_t reported_hash = 0;
    std::vector<std::byte> reported_state;
    Trace trace; // whole: a start and every phase of every tick of the interval

    /// After the trace's last phase.
    std::uint64_t recomputed_hash() const { return trace.entries.back().hash; }
};

Result<DesyncReport> decode_desync_report(std::span<const std::byte> bytes);

/// Loads interval.agreed_state, advances over the inputs and traces them with states. `observer` is
/// called in every traced phase, before the state is looked at: a fault injected there shows where
/// it is. Then `simulation` gets back the state that it had, and `observer` observes it. A state
/// that was corrupted so far that load() refuses it cannot be given back: the simulation then keeps
/// the re-simulated one of the bad tick.
Result<Trace> trace_interval(Simulation& simulation,
                             const DesyncInterval& interval,
                             const Party& party,
                             PhaseObserver* observer = nullptr);

} // namespace lockwind
