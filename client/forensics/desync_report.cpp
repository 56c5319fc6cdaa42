#include "forensics/desync_report.h"

#include "forensics/forensics_codec.h"
#include "log/quiet_parse.h"

#include <utility>

namespace lockwind {

namespace {

/// Gives a simulation back its state and its observer.
class Restorer {
public:
    Restorer(Simulation& simulation, PhaseObserver* observer)
        : simulation_(simulation), observer_(observer) {
        simulation_.save(state_);
    }
    Restorer(const Restorer&) = delete;
    Restorer& operator=(const Restorer&) = delete;
    ~Restorer() {
        simulation_.observe(observer_);
        // Refused where the state itself was corrupted: the re-simulated one stays.
        static_cast<void>(simulation_.load(state_));
    }

private:
    Simulation& simulation_;
    PhaseObserver* observer_;
    std::vector<std::byte> state_;
};

Status check_interval(const Simulation& simulation, const DesyncInterval& interval) {
    if (interval.inputs.empty() || interval.inputs.size() > kDesyncTicksMax) {
        return Error{"desync: an interval of " + std::to_string(interval.inputs.size()) +
                     " ticks, not 1 to " + std::to_string(kDesyncTicksMax)};
    }
    for (const std::vector<SlotInput>& inputs : interval.inputs) {
        if (inputs.size() != simulation.slot_count()) {
            return Error{"desync: inputs of " + std::to_string(inputs.size()) + " slots for " +
                         std::to_string(simulation.slot_count())};
        }
    }
    return Success{};
}

} // namespace

Result<Trace> trace_interval(Simulation& simulation,
                             const DesyncInterval& interval,
                             const Party& party,
                             PhaseObserver* observer) {
    if (Status status = check_interval(simulation, interval); !status) {
        return status.error();
    }
    const Restorer restorer(simulation, observer);
    if (Status status = simulation.load(interval.agreed_state); !status) {
        return Error{"desync: the agreed state of tick " + std::to_string(interval.agreed_tick) +
                     " cannot be loaded: " + status.error().message};
    }
    if (simulation.tick() != interval.agreed_tick) {
        return Error{"desync: the agreed state is of tick " + std::to_string(simulation.tick()) +
                     ", not " + std::to_string(interval.agreed_tick)};
    }
    Trace trace;
    trace.header = trace_header(simulation, party, true);
    TraceRecorder recorder(simulation, trace, {true, kTraceStateBytesMax, observer});
    recorder.start();
    simulation.observe(&recorder);
    for (const std::vector<SlotInput>& inputs : interval.inputs) {
        if (Status status = simulation.advance(inputs); !status) {
            return Error{"desync: re-simulation of tick " + std::to_string(simulation.tick() + 1) +
                         ": " + status.error().message};
        }
    }
    return trace;
}

Result<std::vector<std::byte>> build_desync_report(Simulation& simulation,
                                                   const DesyncInterval& interval,
                                                   const Party& client,
                                                   const DesyncClaim& claim,
                                                   PhaseObserver* observer) {
    Result<Trace> trace = trace_interval(simulation, interval, client, observer);
    if (!trace) {
        return trace.error();
    }
    DesyncReport report;
    report.client = client;
    report.slot = claim.slot;
    report.agreed_tick = interval.agreed_tick;
    report.agreed_state.assign(interval.agreed_state.begin(), interval.agreed_state.end());
    report.inputs.assign(interval.inputs.begin(), interval.inputs.end());
    report.reported_hash = claim.hash;
    report.reported_state.assign(claim.state.begin(), claim.state.end());
    report.trace = std::move(trace).value();
    forensics_format::DesyncReport message;
    encode_report(report, message);
    if (message.ByteSizeLong() > kBlobSizeBytesMax) {
        return Error{"desync: a report of " + std::to_string(message.ByteSizeLong()) +
                     " bytes is larger than the protocol's " + std::to_string(kBlobSizeBytesMax)};
    }
    return to_bytes(message.SerializeAsString());
}

Result<DesyncReport> decode_desync_report(std::span<const std::byte> bytes) {
    if (bytes.size() > kBlobSizeBytesMax) {
        return Error{"desync report: " + std::to_string(bytes.size()) + " bytes"};
    }
    forensics_format::DesyncReport message;
    if (!parse_quietly({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, message)) {
        return Error{"desync report: does not parse"};
    }
    return decode_report(message);
}

} // namespace lockwind
