#pragma once

#include "forensics.pb.h"
#include "forensics/bundle.h"
#include "forensics/desync_report.h"
#include "forensics/snapshot_file.h"
#include "forensics/trace.h"

#include "lockwind/result.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lockwind {

/// Structs <-> forensics.proto. Decoders check every limit; what they give is consistent in itself.

std::vector<std::byte> to_bytes(std::string_view text);
std::string to_string(std::span<const std::byte> bytes);

void encode_party(const Party& party, forensics_format::Party& out);
Result<Party> decode_party(const forensics_format::Party& message);

void encode_trace_header(const TraceHeader& header, forensics_format::TraceHeader& out);
Result<TraceHeader> decode_trace_header(const forensics_format::TraceHeader& message);

void encode_trace_entry(const TraceEntry& entry, forensics_format::TraceEntry& out);
/// `phases` and `sections`: how many the trace has.
Result<TraceEntry> decode_trace_entry(const forensics_format::TraceEntry& message,
                                      std::size_t phases,
                                      std::size_t sections);

void encode_trace(const Trace& trace, forensics_format::Trace& out);
/// Of an interval: refuses a trace that is not whole, from `agreed_tick` over `ticks` ticks.
Result<Trace>
decode_trace(const forensics_format::Trace& message, Tick agreed_tick, std::size_t ticks);

using TickInputsList = google::protobuf::RepeatedPtrField<forensics_format::TickInputs>;
void encode_inputs(std::span<const std::vector<SlotInput>> inputs, TickInputsList& out);
Result<std::vector<std::vector<SlotInput>>> decode_inputs(const TickInputsList& message,
                                                          std::uint32_t players);

void encode_report(const DesyncReport& report, forensics_format::DesyncReport& out);
Result<DesyncReport> decode_report(const forensics_format::DesyncReport& message);

void encode_bundle(const Bundle& bundle, forensics_format::Bundle& out);
void encode_snapshot(const Snapshot& snapshot, forensics_format::Snapshot& out);

/// Number of hashes in a hash tree's `sections` for states of this schema.
std::size_t state_section_count(StateSchema schema);

} // namespace lockwind
