#pragma once

#include "session/messages.h"
#include "session/violation.h"

#include "lockwind/types.h"

#include <cstdint>
#include <deque>
#include <optional>

namespace lockwind {

/// The server's own hashes of the ticks whose hash is due, and the comparison with what clients
/// report.
class HashLedger {
public:
    explicit HashLedger(const MatchConfig& config) : config_(config) {}

    /// Ticks come in ascending order.
    void record(Tick tick, std::uint64_t hash);
    void discard_before(Tick tick);

    std::optional<std::uint64_t> find(Tick tick) const;

    struct Verdict {
        Tick agreed_tick = 0;           // as far as the report takes it
        std::uint64_t agreed_count = 0; // hashes found equal
        struct Mismatch {
            Tick tick = 0;
            std::uint64_t own_hash = 0;
            std::uint64_t reported_hash = 0;
        };
        std::optional<Mismatch> mismatch; // the first tick that differs
    };
    /// Compares in tick order from the first due tick after `agreed_tick`, up to the first mismatch
    /// or gap. Ticks that this end has not stepped yet wait for the report's repetition; ticks
    /// above `confirmed_tick` do not exist for anybody and break the protocol.
    Verdict verify(const HashReport& report,
                   Tick agreed_tick,
                   Tick confirmed_tick,
                   ViolationCounts& violations) const;

private:
    struct Entry {
        Tick tick = 0;
        std::uint64_t hash = 0;
    };

    std::optional<Violation> check(const HashReport& report, Tick confirmed_tick) const;

    MatchConfig config_;
    std::deque<Entry> entries_;
};

} // namespace lockwind
