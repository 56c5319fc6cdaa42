#pragma once

#include "session/state_history.h"

#include "lockwind/result.h"
#include "lockwind/simulation.h"
#include "lockwind/types.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lockwind {

/// Where a second run of a tick gave another state than the first.
struct SyncMismatch {
    Tick tick = 0;           // first tick that differs
    Tick rolled_back_to = 0; // the state from which the second run began
    std::uint64_t hash = 0;  // of the first run
    std::uint64_t resimulated_hash = 0;
    std::uint32_t section =
        kNoIndex; // of the schema, first one that differs; kNoIndex: shapes differ
    std::string section_name;
    std::uint32_t page = kNoIndex; // of the section; kNoIndex: their numbers of pages differ
};

/// Runs a simulation as a rollback would and compares: each tick it saves, steps, goes back
/// `check_distance_ticks`, steps again and compares every hash on the way. Finds what save()
/// forgets, what load() does not restore, and a step that depends on anything but state and inputs.
class SyncTestSession {
public:
    /// The simulation is not owned and outlives the session.
    /// \pre check_distance_ticks >= 1
    SyncTestSession(Simulation& simulation, std::uint32_t check_distance_ticks);

    /// Advances one tick, then checks the last check_distance_ticks ticks. Gives the first
    /// mismatch, which is then also in mismatch(), or nullopt; an Error is the simulation's own.
    /// The simulation is left in the second run's state, so that a difference that is not hashed
    /// yet has time to show. \pre mismatch() is empty
    Result<std::optional<SyncMismatch>> advance(std::span<const SlotInput> inputs);

    const std::optional<SyncMismatch>& mismatch() const { return mismatch_; }
    std::uint64_t ticks_advanced() const { return ticks_advanced_; }
    std::uint64_t ticks_resimulated() const { return ticks_resimulated_; }

private:
    struct Step {
        Tick tick = 0;
        std::vector<SlotInput> inputs; // that led to it
        HashTree tree;
    };

    void remember(std::span<const SlotInput> inputs);
    Status check();
    void compare(const Step& step, Tick rolled_back_to);

    Simulation& simulation_;
    StateHistory states_;
    std::vector<Step> steps_; // the first run, oldest first: one per state in states_
    std::optional<SyncMismatch> mismatch_;
    std::uint64_t ticks_advanced_ = 0;
    std::uint64_t ticks_resimulated_ = 0;
};

/// First section and page in which two hash trees differ; both kNoIndex where they are the same.
struct HashTreeDifference {
    std::uint32_t section = kNoIndex;
    std::uint32_t page = kNoIndex;
};
HashTreeDifference first_difference(const HashTree& a, const HashTree& b);

} // namespace lockwind
