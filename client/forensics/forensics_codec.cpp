#include "forensics/forensics_codec.h"

#include "log/log_codec.h"
#include "session/match_config.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr int kPhasesMax = 256;
constexpr std::size_t kPhaseNameBytesMax = 128;

Status unpack_into(const std::string& packed, std::string_view what, std::vector<std::byte>& out) {
    Result<std::vector<std::byte>> state = unpack_state(to_bytes(packed));
    if (!state) {
        return Error{std::string(what) + ": " + state.error().message};
    }
    out = std::move(state).value();
    return Success{};
}

/// The place that entry `index` of a trace from `agreed_tick` must have.
bool in_place(const TraceEntry& entry, std::size_t index, Tick agreed_tick, std::size_t phases) {
    if (index == 0) {
        return entry.tick == agreed_tick && entry.phase == kTraceStart;
    }
    return entry.tick == agreed_tick + 1 + (index - 1) / phases &&
           entry.phase == (index - 1) % phases;
}

} // namespace

std::vector<std::byte> to_bytes(std::string_view text) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(text.data(), text.size()));
    return {bytes.begin(), bytes.end()};
}

std::string to_string(std::span<const std::byte> bytes) {
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

std::size_t state_section_count(StateSchema schema) {
    return static_cast<std::size_t>(
        std::count_if(schema.begin(), schema.end(), [](const SectionDescriptor& section) {
            return !section.derived;
        }));
}

void encode_party(const Party& party, forensics_format::Party& out) {
    out.set_sim_version(party.sim_version);
    out.set_build_info(party.build_info);
    encode_config(party.config, *out.mutable_config());
}

Result<Party> decode_party(const forensics_format::Party& message) {
    Party party{message.sim_version(), message.build_info(), decode_config(message.config())};
    if (Status status = check_readable(party.config); !status) {
        return status.error();
    }
    return party;
}

void encode_trace_header(const TraceHeader& header, forensics_format::TraceHeader& out) {
    encode_party(header.party, *out.mutable_party());
    for (const std::string& phase : header.phases) {
        out.add_phases(phase);
    }
    header.schema.encode(*out.mutable_schema());
    out.set_states(header.states);
}

Result<TraceHeader> decode_trace_header(const forensics_format::TraceHeader& message) {
    Result<Party> party = decode_party(message.party());
    if (!party) {
        return party.error();
    }
    Result<OwnedSchema> schema = OwnedSchema::decode(message.schema());
    if (!schema) {
        return schema.error();
    }
    if (message.phases_size() < 1 || message.phases_size() > kPhasesMax) {
        return Error{"trace: " + std::to_string(message.phases_size()) + " phases, not 1 to " +
                     std::to_string(kPhasesMax)};
    }
    for (const std::string& phase : message.phases()) {
        if (phase.size() > kPhaseNameBytesMax) {
            return Error{"trace: a phase's name is longer than " +
                         std::to_string(kPhaseNameBytesMax)};
        }
    }
    TraceHeader header;
    header.party = std::move(party).value();
    header.phases.assign(message.phases().begin(), message.phases().end());
    header.schema = std::move(schema).value();
    header.states = message.states();
    return header;
}

void encode_trace_entry(const TraceEntry& entry, forensics_format::TraceEntry& out) {
    out.set_tick(entry.tick);
    out.set_phase(entry.phase == kTraceStart ? 0 : entry.phase + 1);
    out.set_hash(entry.hash);
    out.mutable_sections()->Add(entry.sections.begin(), entry.sections.end());
    out.set_packed_state(to_string(entry.packed_state));
}

Result<TraceEntry> decode_trace_entry(const forensics_format::TraceEntry& message,
                                      std::size_t phases,
                                      std::size_t sections) {
    if (message.phase() > phases) {
        return Error{"trace: phase " + std::to_string(message.phase()) + " of " +
                     std::to_string(phases)};
    }
    if (static_cast<std::size_t>(message.sections_size()) != sections) {
        return Error{"trace: " + std::to_string(message.sections_size()) + " section hashes for " +
                     std::to_string(sections) + " sections"};
    }
    TraceEntry entry;
    entry.tick = message.tick();
    entry.phase = message.phase() == 0 ? kTraceStart : message.phase() - 1;
    entry.hash = message.hash();
    entry.sections.assign(message.sections().begin(), message.sections().end());
    entry.packed_state = to_bytes(message.packed_state());
    return entry;
}

void encode_trace(const Trace& trace, forensics_format::Trace& out) {
    encode_trace_header(trace.header, *out.mutable_header());
    for (const TraceEntry& entry : trace.entries) {
        encode_trace_entry(entry, *out.add_entries());
    }
}

Result<Trace>
decode_trace(const forensics_format::Trace& message, Tick agreed_tick, std::size_t ticks) {
    Result<TraceHeader> header = decode_trace_header(message.header());
    if (!header) {
        return header.error();
    }
    Trace trace;
    trace.header = std::move(header).value();
    const std::size_t phases = trace.header.phases.size();
    const std::size_t sections = state_section_count(trace.header.schema.view());
    const std::size_t wanted = 1 + ticks * phases;
    if (static_cast<std::size_t>(message.entries_size()) != wanted) {
        return Error{"trace: " + std::to_string(message.entries_size()) + " entries, not " +
                     std::to_string(wanted)};
    }
    for (const forensics_format::TraceEntry& entry : message.entries()) {
        Result<TraceEntry> decoded = decode_trace_entry(entry, phases, sections);
        if (!decoded) {
            return decoded.error();
        }
        if (!in_place(decoded.value(), trace.entries.size(), agreed_tick, phases)) {
            return Error{"trace: entry " + std::to_string(trace.entries.size()) +
                         " is out of order"};
        }
        trace.entries.push_back(std::move(decoded).value());
    }
    return trace;
}

void encode_inputs(std::span<const std::vector<SlotInput>> inputs, TickInputsList& out) {
    for (const std::vector<SlotInput>& tick : inputs) {
        forensics_format::TickInputs& added = *out.Add();
        for (const SlotInput& input : tick) {
            added.mutable_statuses()->push_back(static_cast<char>(input.status));
            added.mutable_inputs()->append(reinterpret_cast<const char*>(input.bytes.data()),
                                           input.bytes.size());
        }
    }
}

Result<std::vector<std::vector<SlotInput>>> decode_inputs(const TickInputsList& message,
                                                          std::uint32_t players) {
    if (message.empty() || static_cast<std::size_t>(message.size()) > kDesyncTicksMax) {
        return Error{"inputs of " + std::to_string(message.size()) + " ticks, not 1 to " +
                     std::to_string(kDesyncTicksMax)};
    }
    std::vector<std::vector<SlotInput>> inputs;
    for (const forensics_format::TickInputs& tick : message) {
        if (tick.statuses().size() != players ||
            tick.inputs().size() != players * kInputSizeBytesMax) {
            return Error{"inputs of a tick that are not " + std::to_string(players) + " slots'"};
        }
        std::vector<SlotInput>& slots = inputs.emplace_back(players);
        for (std::size_t slot = 0; slot < players; ++slot) {
            const auto status = static_cast<std::uint8_t>(tick.statuses()[slot]);
            if (status > static_cast<std::uint8_t>(InputStatus::predicted)) {
                return Error{"unknown input status " + std::to_string(status)};
            }
            slots[slot].status = static_cast<InputStatus>(status);
            std::copy_n(reinterpret_cast<const std::uint8_t*>(tick.inputs().data()) +
                            slot * kInputSizeBytesMax,
                        kInputSizeBytesMax,
                        slots[slot].bytes.begin());
        }
    }
    return inputs;
}

void encode_report(const DesyncReport& report, forensics_format::DesyncReport& out) {
    encode_party(report.client, *out.mutable_client());
    out.set_slot(report.slot);
    out.set_agreed_tick(report.agreed_tick);
    out.set_packed_agreed_state(to_string(pack_state(report.agreed_state)));
    encode_inputs(report.inputs, *out.mutable_inputs());
    out.set_reported_hash(report.reported_hash);
    out.set_packed_reported_state(to_string(pack_state(report.reported_state)));
    encode_trace(report.trace, *out.mutable_trace());
}

Result<DesyncReport> decode_report(const forensics_format::DesyncReport& message) {
    Result<Party> party = decode_party(message.client());
    if (!party) {
        return party.error();
    }
    DesyncReport report;
    report.client = std::move(party).value();
    report.slot = message.slot();
    report.agreed_tick = message.agreed_tick();
    report.reported_hash = message.reported_hash();
    if (report.agreed_tick > kMatchTicksMax) {
        return Error{"agreed_tick " + std::to_string(report.agreed_tick) + " is out of range"};
    }
    Status status = unpack_into(message.packed_agreed_state(), "agreed state", report.agreed_state);
    if (status) {
        status =
            unpack_into(message.packed_reported_state(), "reported state", report.reported_state);
    }
    if (!status) {
        return status.error();
    }
    Result<std::vector<std::vector<SlotInput>>> inputs =
        decode_inputs(message.inputs(), report.client.config.players);
    if (!inputs) {
        return inputs.error();
    }
    report.inputs = std::move(inputs).value();
    Result<Trace> trace = decode_trace(message.trace(), report.agreed_tick, report.inputs.size());
    if (!trace) {
        return trace.error();
    }
    report.trace = std::move(trace).value();
    return report;
}

} // namespace lockwind
