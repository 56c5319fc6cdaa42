#include "forensics/bundle.h"

#include "forensics/config_diff.h"
#include "forensics/state_diff.h"
#include "log/log_format.h"

#include <algorithm>
#include <utility>

namespace lockwind {

namespace {

struct Judgement {
    Verdict verdict;
    std::string reason;
};

std::string tick_text(Tick tick) {
    return "tick " + std::to_string(tick);
}

/// The hash that a state has in this simulation; nothing where the bytes are no state at all.
std::optional<std::uint64_t> hash_of(const Simulation& simulation,
                                     std::span<const std::byte> state) {
    const Result<std::uint64_t> hash = hash_state(simulation.schema(), state);
    return hash ? std::optional(hash.value()) : std::nullopt;
}

std::string differing_setting(const MatchConfig& a, const MatchConfig& b) {
    const std::vector<ConfigDiff> differing = diff_configs(a, b);
    return differing.empty() ? "" : differing.front().field;
}

/// Is the report an answer to the question, and does it still claim what was claimed?
std::string check_answer(const DesyncEvidence& evidence, const DesyncReport& report) {
    if (report.slot != evidence.slot) {
        return "speaks for slot " + std::to_string(report.slot);
    }
    if (report.agreed_tick != evidence.interval.agreed_tick ||
        report.inputs.size() != evidence.interval.inputs.size()) {
        return "is of another interval";
    }
    if (report.reported_hash != evidence.client_hash) {
        return "claims hash " + hash_text(report.reported_hash) + ", but " +
               hash_text(evidence.client_hash) + " was reported";
    }
    return "";
}

Judgement judge_agreed_state(const DesyncEvidence& evidence) {
    const Tick tick = evidence.interval.agreed_tick;
    if (tick == 0) {
        return {Verdict::settings_differ, "the client started from another state than the server"};
    }
    return {Verdict::corrupted_state,
            "the state that the client kept of " + tick_text(tick) +
                " is no longer the one that both agreed on"};
}

/// Inputs, settings and start are the same: what the traces say.
Judgement judge_traces(const Bundle& bundle, const DesyncReport& report) {
    const bool reproduced = report.recomputed_hash() == report.reported_hash;
    const std::vector<TraceEntry>& server = bundle.server_trace.entries;
    const std::vector<TraceEntry>& client = report.trace.entries;
    const bool comparable = bundle.server_trace.header.phases == report.trace.header.phases &&
                            bundle.server_trace.header.schema == report.trace.header.schema;
    if (!comparable) {
        return {Verdict::build_differs, "the client's program has other phases or state"};
    }
    const auto [at_server, at_client] =
        std::mismatch(server.begin(),
                      server.end(),
                      client.begin(),
                      client.end(),
                      [](const TraceEntry& a, const TraceEntry& b) { return a.hash == b.hash; });
    if (at_client == client.end()) {
        return {Verdict::corrupted_state,
                "re-simulation agrees with the server: the client's state was changed outside the "
                "step"};
    }
    const std::string where =
        tick_text(at_client->tick) + ", phase " +
        (at_client->phase == kTraceStart ? std::string(kOutsideStep)
                                         : report.trace.header.phases[at_client->phase]);
    const std::string again = reproduced ? " and gives the reported hash again"
                                         : ", to yet another hash than the reported one";
    if (bundle.server.build_info != report.client.build_info) {
        return {Verdict::build_differs,
                "two different builds part at " + where + "; re-simulation repeats it" + again};
    }
    return {Verdict::nondeterminism,
            "equal builds part at " + where + "; re-simulation repeats it" + again};
}

Judgement judge_report(const Simulation& simulation,
                       const Bundle& bundle,
                       const DesyncEvidence& evidence,
                       const DesyncReport& report) {
    if (!std::equal(report.inputs.begin(),
                    report.inputs.end(),
                    evidence.interval.inputs.begin(),
                    evidence.interval.inputs.end())) {
        return {Verdict::inputs_differ, "the client stepped other inputs than were confirmed"};
    }
    const std::string setting = differing_setting(evidence.server.config, report.client.config);
    if (!setting.empty()) {
        return {Verdict::settings_differ, "the setting " + setting + " differs"};
    }
    if (!std::equal(report.agreed_state.begin(),
                    report.agreed_state.end(),
                    evidence.interval.agreed_state.begin(),
                    evidence.interval.agreed_state.end())) {
        return judge_agreed_state(evidence);
    }
    const std::optional<std::uint64_t> shown = hash_of(simulation, report.reported_state);
    if (shown != report.reported_hash) {
        return {Verdict::false_hash,
                shown ? "the state that the client shows has the hash " + hash_text(*shown) +
                            ", not the reported one"
                      : "the client shows no state of this simulation"};
    }
    return judge_traces(bundle, report);
}

/// Moves `report` into the bundle where it is an answer.
Judgement judge(const Simulation& simulation,
                const DesyncEvidence& evidence,
                std::span<const std::byte> report_bytes,
                Bundle& bundle) {
    Result<DesyncReport> report = decode_desync_report(report_bytes);
    const std::string wrong =
        report ? check_answer(evidence, report.value()) : report.error().message;
    if (wrong.empty()) {
        bundle.client = std::move(report).value();
    }
    if (bundle.server_trace.entries.back().hash != evidence.server_hash) {
        bundle.server_at_fault = true;
        return {Verdict::corrupted_state,
                "re-simulation does not give the server's own hash again: the server's state was "
                "changed outside the step"};
    }
    if (report_bytes.empty()) {
        return {Verdict::false_hash, "the client showed nothing for the hash that it reported"};
    }
    if (!wrong.empty()) {
        return {Verdict::false_hash, "the client's report " + wrong};
    }
    return judge_report(simulation, bundle, evidence, *bundle.client);
}

} // namespace

Result<Bundle> make_bundle(Simulation& simulation,
                           const DesyncEvidence& evidence,
                           std::span<const std::byte> report,
                           PhaseObserver* observer) {
    Result<Trace> trace = trace_interval(simulation, evidence.interval, evidence.server, observer);
    if (!trace) {
        return trace.error();
    }
    Bundle bundle;
    bundle.slot = evidence.slot;
    bundle.agreed_tick = evidence.interval.agreed_tick;
    bundle.bad_tick = evidence.interval.bad_tick();
    bundle.server_hash = evidence.server_hash;
    bundle.client_hash = evidence.client_hash;
    bundle.server = evidence.server;
    bundle.inputs.assign(evidence.interval.inputs.begin(), evidence.interval.inputs.end());
    bundle.agreed_state.assign(evidence.interval.agreed_state.begin(),
                               evidence.interval.agreed_state.end());
    bundle.server_state.assign(evidence.server_state.begin(), evidence.server_state.end());
    bundle.server_trace = std::move(trace).value();
    Judgement judgement = judge(simulation, evidence, report, bundle);
    bundle.verdict = judgement.verdict;
    bundle.reason = std::move(judgement.reason);
    return bundle;
}

std::string bundle_path(const std::string& log_path, Slot slot, Tick tick) {
    constexpr std::string_view kSuffix = ".log";
    std::string stem = log_path;
    if (stem.ends_with(kSuffix)) {
        stem.resize(stem.size() - kSuffix.size());
    }
    return stem + "-desync-slot" + std::to_string(slot) + "-tick" + std::to_string(tick) +
           ".bundle";
}

} // namespace lockwind
