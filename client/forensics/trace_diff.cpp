#include "forensics/diff.h"
#include "forensics/diff_fields.h"
#include "log/state_pack.h"

#include <utility>

namespace lockwind {

namespace {

/// One side of a comparison: its entry and, where it is recorded, its state.
class Side {
public:
    explicit Side(TraceSource& source) : source_(source) {}

    /// False at the end.
    Result<bool> step() {
        Result<std::optional<TraceEntry>> next = source_.next();
        if (!next) {
            return next.error();
        }
        if (!next.value()) {
            return false;
        }
        entry_ = *std::move(next).value();
        has_state_ = !entry_.packed_state.empty();
        if (has_state_) {
            Result<std::span<const std::byte>> state = unpacker_.unpack(entry_.packed_state);
            if (!state) {
                return Error{"trace: tick " + std::to_string(entry_.tick) + ": " +
                             state.error().message};
            }
            state_ = state.value();
        }
        return true;
    }

    /// The start of a trace is the state after the last phase of its tick.
    std::pair<Tick, std::size_t> place() const {
        return {entry_.tick, at_start() ? source_.header().phases.size() - 1 : entry_.phase};
    }
    bool at_start() const { return entry_.phase == kTraceStart; }
    const TraceHeader& header() const { return source_.header(); }
    const TraceEntry& entry() const { return entry_; }
    bool has_state() const { return has_state_; }
    std::span<const std::byte> state() const { return state_; }

private:
    TraceSource& source_;
    StateChainUnpacker unpacker_;
    TraceEntry entry_;
    bool has_state_ = false;
    std::span<const std::byte> state_; // the unpacker's
};

/// Steps the side that is behind, both where they are level. False when one has ended.
Result<bool> step(Side& a, Side& b, bool first) {
    const bool step_a = first || a.place() <= b.place();
    const bool step_b = first || b.place() <= a.place();
    Result<bool> more_a = step_a ? a.step() : Result<bool>(true);
    if (!more_a) {
        return more_a;
    }
    Result<bool> more_b = step_b ? b.step() : Result<bool>(true);
    if (!more_b) {
        return more_b;
    }
    return more_a.value() && more_b.value();
}

void locate_section(const Side& a, const Side& b, DiffResult& result) {
    const std::vector<std::string> names = state_section_names(a.header().schema.view());
    for (std::size_t section = 0; section < names.size(); ++section) {
        if (a.entry().sections[section] != b.entry().sections[section]) {
            // Section 0 counts the rows of the others: the next ones say more.
            result.section = names[section];
            if (section > 0) {
                return;
            }
        }
    }
}

bool shows_its_hash(const Side& side) {
    const Result<std::uint64_t> hash = hash_state(side.header().schema.view(), side.state());
    return hash && hash.value() == side.entry().hash;
}

DiffResult describe(const Side& a, const Side& b) {
    DiffResult result;
    result.same = false;
    result.first_tick = b.entry().tick;
    result.phase = a.at_start() || b.at_start() ? std::string(kOutsideStep)
                                                : a.header().phases[a.entry().phase];
    if (!a.has_state() || !b.has_state()) {
        locate_section(a, b, result);
        result.reason = "the traces hold hashes only; record them with --trace-states to see the "
                        "field";
        return result;
    }
    if (!shows_its_hash(a) || !shows_its_hash(b)) {
        result.reason = "a trace's state does not have the hash that stands beside it";
    }
    if (Result<StateDiff> diff = diff_states(a.header().schema.view(), a.state(), b.state())) {
        set_fields(result, std::move(diff).value());
    } else {
        locate_section(a, b, result);
        result.reason = diff.error().message;
    }
    return result;
}

} // namespace

Result<DiffResult> diff_traces(TraceSource& source_a, TraceSource& source_b) {
    DiffResult result;
    if (source_a.header().phases != source_b.header().phases ||
        !(source_a.header().schema == source_b.header().schema)) {
        result.same = false;
        result.verdict = Verdict::build_differs;
        result.reason = "the traces are of programs with other phases or another state schema";
        return result;
    }
    Side a(source_a);
    Side b(source_b);
    bool compared = false;
    for (bool first = true;; first = false) {
        const Result<bool> more = step(a, b, first);
        if (!more) {
            return more.error();
        }
        if (!more.value()) {
            break;
        }
        if (a.place() != b.place()) {
            continue;
        }
        compared = true;
        if (a.entry().hash != b.entry().hash) {
            return describe(a, b);
        }
    }
    if (!compared) {
        return Error{"the traces have no tick in common"};
    }
    return result;
}

} // namespace lockwind
