#pragma once

#include "forensics/bundle.h"
#include "forensics/snapshot_file.h"
#include "forensics/state_diff.h"
#include "forensics/trace.h"
#include "forensics/verdict.h"
#include "log/log_reader.h"

#include "lockwind/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lockwind {

/// The first divergence of two things that should be the same. What is not known is empty.
struct DiffResult {
    bool same = true;
    std::optional<Tick> first_tick;
    std::string phase;             // a step's phase, or kOutsideStep
    std::vector<FieldDiff> fields; // the first is the divergence; up to 20
    std::size_t field_count = 0;   // of all fields that differ at first_tick and phase
    std::string section;           // fields[0]'s, or the section whose hash differs
    std::optional<Verdict> verdict;
    std::optional<Slot> slot; // of a desync
    std::string name_a;       // what side a is: "server", or a file
    std::string name_b;
    std::string reason; // one or two sentences for a person
};

DiffResult diff_inputs(Tick first_tick,
                       std::span<const std::vector<SlotInput>> a,
                       std::span<const std::vector<SlotInput>> b);
/// The first schema's fields; snapshots of other schemas differ as a whole.
Result<DiffResult> diff_snapshots(const Snapshot& a, const Snapshot& b);
/// The traces may hold hashes only; then the divergence is known down to the section. Compared
/// where they overlap; an Error where they nowhere do, or one is damaged.
Result<DiffResult> diff_traces(TraceSource& a, TraceSource& b);
/// Settings, inputs and hashes, tick by tick. That one log ends earlier is no divergence.
DiffResult diff_logs(LogReader& a, LogReader& b);
/// What the bundle's verdict rests on.
DiffResult diff_bundle(const Bundle& bundle);

} // namespace lockwind
