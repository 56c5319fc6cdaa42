#include "forensics/diff.h"
#include "forensics/diff_fields.h"

#include <utility>

namespace lockwind {

namespace {

/// The last state of a trace; nothing where it is not recorded or damaged.
std::optional<std::vector<std::byte>> last_state(const Trace& trace) {
    StateChainUnpacker unpacker;
    std::optional<std::vector<std::byte>> last;
    for (const TraceEntry& entry : trace.entries) {
        last.reset();
        if (entry.packed_state.empty()) {
            continue;
        }
        const Result<std::span<const std::byte>> state = unpacker.unpack(entry.packed_state);
        if (!state) {
            return std::nullopt;
        }
        last.emplace(state.value().begin(), state.value().end());
    }
    return last;
}

void compare_states(std::span<const std::byte> a,
                    std::span<const std::byte> b,
                    StateSchema schema,
                    DiffResult& result) {
    if (Result<StateDiff> diff = diff_states(schema, a, b)) {
        set_fields(result, std::move(diff).value());
    } else {
        result.reason += "; " + diff.error().message;
    }
}

void fill_inputs(const Bundle& bundle, DiffResult& result) {
    DiffResult inputs = diff_inputs(bundle.agreed_tick + 1, bundle.inputs, bundle.client->inputs);
    result.first_tick = inputs.first_tick;
    result.section = inputs.section;
    result.fields = std::move(inputs.fields);
    result.field_count = inputs.field_count;
}

void fill_settings(const Bundle& bundle, StateSchema schema, DiffResult& result) {
    const std::vector<ConfigDiff> settings =
        diff_configs(bundle.server.config, bundle.client->client.config);
    if (!settings.empty()) {
        set_settings(result, settings);
        return;
    }
    result.first_tick = bundle.agreed_tick;
    compare_states(bundle.agreed_state, bundle.client->agreed_state, schema, result);
}

void fill_traces(const Bundle& bundle, DiffResult& result) {
    TraceView server(bundle.server_trace);
    TraceView client(bundle.client->trace);
    Result<DiffResult> diff = diff_traces(server, client);
    if (!diff) {
        result.reason += "; " + diff.error().message;
        return;
    }
    DiffResult& found = diff.value();
    result.first_tick = found.first_tick ? found.first_tick : result.first_tick;
    result.phase = found.phase;
    result.section = found.section;
    result.fields = std::move(found.fields);
    result.field_count = found.field_count;
    result.reason += found.reason.empty() ? "" : "; " + found.reason;
}

/// What was kept against what re-simulation gives.
void fill_corruption(const Bundle& bundle, StateSchema schema, DiffResult& result) {
    const std::optional<std::vector<std::byte>> recomputed = last_state(bundle.server_trace);
    if (bundle.server_at_fault) {
        result.name_a = "server";
        result.name_b = "re-simulated";
        if (recomputed) {
            compare_states(bundle.server_state, *recomputed, schema, result);
        }
        return;
    }
    if (bundle.client->agreed_state != bundle.agreed_state) {
        result.first_tick = bundle.agreed_tick;
        compare_states(bundle.agreed_state, bundle.client->agreed_state, schema, result);
        return;
    }
    compare_states(recomputed ? *recomputed : bundle.server_state,
                   bundle.client->reported_state,
                   schema,
                   result);
}

/// The hash that was reported against the one of the state that is shown for it.
void fill_false_hash(const Bundle& bundle, StateSchema schema, DiffResult& result) {
    set_hashes(result, bundle.server_hash, bundle.client_hash);
    if (!bundle.client) {
        return;
    }
    const Result<std::uint64_t> shown = hash_state(schema, bundle.client->reported_state);
    if (shown) {
        set_hashes(result, shown.value(), bundle.client_hash);
        result.name_a = result.name_b + ", state shown";
        result.name_b += ", as reported";
    }
}

void fill(const Bundle& bundle, DiffResult& result) {
    const StateSchema schema = bundle.server_trace.header.schema.view();
    const bool needs_client = !bundle.server_at_fault && bundle.verdict != Verdict::false_hash;
    if (needs_client && !bundle.client) {
        result.reason += "; the client's report is missing";
        return;
    }
    switch (bundle.verdict) {
    case Verdict::inputs_differ:
        return fill_inputs(bundle, result);
    case Verdict::settings_differ:
        return fill_settings(bundle, schema, result);
    case Verdict::false_hash:
        return fill_false_hash(bundle, schema, result);
    case Verdict::build_differs:
    case Verdict::nondeterminism:
        return fill_traces(bundle, result);
    case Verdict::corrupted_state:
        return fill_corruption(bundle, schema, result);
    }
}

} // namespace

DiffResult diff_bundle(const Bundle& bundle) {
    DiffResult result;
    result.same = false;
    result.first_tick = bundle.bad_tick;
    result.phase = kOutsideStep;
    result.verdict = bundle.verdict;
    result.reason = bundle.reason;
    result.slot = bundle.slot;
    result.name_a = "server";
    result.name_b = "slot " + std::to_string(bundle.slot);
    fill(bundle, result);
    return result;
}

} // namespace lockwind
