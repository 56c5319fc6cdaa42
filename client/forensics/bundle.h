#pragma once

#include "forensics/desync_report.h"
#include "forensics/verdict.h"

#include "lockwind/result.h"
#include "lockwind/simulation.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lockwind {

/// What the server knows of a desync.
struct DesyncEvidence {
    Slot slot = 0;
    DesyncInterval interval;
    std::uint64_t server_hash = 0;           // of state(bad_tick), when it was confirmed
    std::uint64_t client_hash = 0;           // as the client reported it
    std::span<const std::byte> server_state; // state(bad_tick), as kept
    Party server;
};

/// Everything that tells where a desync came from, in one file.
struct Bundle {
    Slot slot = 0;
    Tick agreed_tick = 0;
    Tick bad_tick = 0;
    std::uint64_t server_hash = 0;
    std::uint64_t client_hash = 0;
    Party server;
    std::vector<std::vector<SlotInput>> inputs; // the server's, of the interval
    std::vector<std::byte> agreed_state;        // the server's
    std::vector<std::byte> server_state;        // of bad_tick
    Trace server_trace;
    std::optional<DesyncReport> client; // nothing where it never came or could not be read
    Verdict verdict = Verdict::false_hash;
    std::string reason;           // one sentence for a person
    bool server_at_fault = false; // the server's own hash is what re-simulation does not reproduce
};

/// Judges a client's report: re-simulates the interval on `simulation` (left as it was, observed by
/// `observer`) and decides the verdict. `report`: what the client sent, empty where nothing came;
/// any bytes will do. An Error only where the server itself cannot re-simulate.
Result<Bundle> make_bundle(Simulation& simulation,
                           const DesyncEvidence& evidence,
                           std::span<const std::byte> report,
                           PhaseObserver* observer = nullptr);

/// Written under a temporary name, then renamed; an existing file is an Error.
Status write_bundle(const std::string& path, const Bundle& bundle);
Result<Bundle> read_bundle(const std::string& path);

/// "<log without .log>-desync-slot<S>-tick<T>.bundle", beside the log.
std::string bundle_path(const std::string& log_path, Slot slot, Tick tick);

} // namespace lockwind
