#include "session/hash_ledger.h"

#include "session/match_config.h"

#include "lockwind/assert.h"

#include <algorithm>

namespace lockwind {

void HashLedger::record(Tick tick, std::uint64_t hash) {
    LOCKWIND_ASSERT(entries_.empty() || tick > entries_.back().tick);
    entries_.push_back(Entry{tick, hash});
}

void HashLedger::discard_before(Tick tick) {
    while (!entries_.empty() && entries_.front().tick < tick) {
        entries_.pop_front();
    }
}

std::optional<std::uint64_t> HashLedger::find(Tick tick) const {
    const auto entry = std::lower_bound(
        entries_.begin(), entries_.end(), tick, [](const Entry& e, Tick t) { return e.tick < t; });
    if (entry == entries_.end() || entry->tick != tick) {
        return std::nullopt;
    }
    return entry->hash;
}

std::optional<Violation> HashLedger::check(const HashReport& report, Tick confirmed_tick) const {
    if (report.entries.size() > kHashReportEntriesMax) {
        return Violation::hash_malformed;
    }
    Tick previous_tick = 0;
    for (const HashReport::Entry& entry : report.entries) {
        if (entry.tick <= previous_tick || !hash_due(config_, entry.tick)) {
            return Violation::hash_malformed;
        }
        if (entry.tick > confirmed_tick) {
            return Violation::hash_unconfirmed;
        }
        previous_tick = entry.tick;
    }
    return std::nullopt;
}

HashLedger::Verdict HashLedger::verify(const HashReport& report,
                                       Tick agreed_tick,
                                       Tick confirmed_tick,
                                       ViolationCounts& violations) const {
    Verdict verdict;
    verdict.agreed_tick = agreed_tick;
    if (const auto violation = check(report, confirmed_tick)) {
        violations.add(*violation);
        return verdict;
    }
    for (const HashReport::Entry& entry : report.entries) {
        if (entry.tick <= verdict.agreed_tick) {
            continue;
        }
        const std::optional<std::uint64_t> own_hash = find(entry.tick);
        if (entry.tick != next_hash_tick(config_, verdict.agreed_tick) || !own_hash) {
            return verdict;
        }
        if (*own_hash != entry.hash) {
            verdict.mismatch = Verdict::Mismatch{entry.tick, *own_hash, entry.hash};
            return verdict;
        }
        verdict.agreed_tick = entry.tick;
        ++verdict.agreed_count;
    }
    return verdict;
}

} // namespace lockwind
