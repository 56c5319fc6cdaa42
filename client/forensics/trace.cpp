#include "forensics/trace.h"

#include <utility>

namespace lockwind {

TraceHeader trace_header(const Simulation& simulation, Party party, bool states) {
    TraceHeader header;
    header.party = std::move(party);
    header.phases.assign(simulation.phases().begin(), simulation.phases().end());
    header.schema = OwnedSchema(simulation.schema());
    header.states = states;
    return header;
}

Status Trace::add(TraceEntry entry) {
    entries.push_back(std::move(entry));
    return Success{};
}

TraceRecorder::TraceRecorder(const Simulation& simulation,
                             TraceSink& sink,
                             const TraceOptions& options)
    : simulation_(simulation), sink_(sink), options_(options) {}

void TraceRecorder::start() {
    tick_ = simulation_.tick();
    record(kTraceStart);
}

void TraceRecorder::after_phase(std::uint32_t phase) {
    if (options_.first != nullptr) {
        options_.first->after_phase(phase);
    }
    // Phase 0 ends first in every tick; the simulation's own tick moves in one of the last.
    tick_ += phase == 0 ? 1U : 0U;
    record(phase);
}

void TraceRecorder::record(std::uint32_t phase) {
    if (!status_) {
        return;
    }
    HashTree tree = simulation_.hash_tree();
    TraceEntry entry{tick_, phase, tree.root, std::move(tree.sections), {}};
    if (options_.states && packed_bytes_ <= options_.state_bytes_max) {
        simulation_.save(state_);
        entry.packed_state = packer_.pack(state_);
        packed_bytes_ += entry.packed_state.size();
    }
    status_ = sink_.add(std::move(entry));
}

Result<std::optional<TraceEntry>> TraceView::next() {
    if (next_ == trace_.entries.size()) {
        return std::optional<TraceEntry>();
    }
    return std::optional<TraceEntry>(trace_.entries[next_++]);
}

} // namespace lockwind
