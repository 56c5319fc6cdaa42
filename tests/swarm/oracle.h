#pragma once

#include "session/messages.h"

#include "lockwind/simulation.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lockwind::swarm {

/// Who says something about a tick.
using Party = std::uint32_t;
inline constexpr Party kServerParty = 0;
inline constexpr Party kLogParty = 1;
inline constexpr Party kReplayParty = 2;
inline constexpr Party kFirstClientParty = 3; // + the client's index

std::string party_name(Party party);

/// What the log's replay came to.
struct LogFindings {
    std::uint64_t contacts = 0; // contact points, summed over all ticks
    std::uint64_t last_hash = 0;
};

/// Holds what anybody said about a tick against what anybody else said. A tick has one set of
/// inputs and one state, whoever is asked, and whenever.
class Oracle {
public:
    /// `who` holds these inputs for confirmed.
    void confirmed(Party who, Tick tick, std::span<const SlotInput> inputs);
    /// `who` has this state after the tick.
    void hashed(Party who, Tick tick, std::uint64_t hash);
    /// The server tells everybody of ticks: none of them may be newer than the log's last.
    void told(const Confirmation& confirmation, Tick logged_tick);
    /// A client reports hashes; `confirmed_tick` is what it was told.
    void reported(Party who, const HashReport& report, Tick confirmed_tick);
    /// The finished log: whole, verified by the shipped replay, the same inputs and the same hashes
    /// as everybody had, at due and at other ticks.
    LogFindings check_log(const std::string& path, const MatchConfig& config);

    void fail(std::string what);
    bool failed() const { return failures_ > 0; }
    /// The first few.
    const std::vector<std::string>& failures() const { return first_failures_; }
    std::optional<std::uint64_t> hash_of(Tick tick) const;

private:
    template <class Value>
    struct Claim {
        Party who = kServerParty;
        Value value{};
    };

    void read_log(const std::string& path);

    std::vector<std::optional<Claim<std::vector<SlotInput>>>> inputs_; // by tick
    std::vector<std::optional<Claim<std::uint64_t>>> hashes_;          // by tick
    std::vector<std::string> first_failures_;
    std::uint64_t failures_ = 0;
};

} // namespace lockwind::swarm
