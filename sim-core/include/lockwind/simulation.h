#pragma once

#include "lockwind/assert.h"
#include "lockwind/hash_tree.h"
#include "lockwind/kept_state.h"
#include "lockwind/phase_observer.h"
#include "lockwind/result.h"
#include "lockwind/schema.h"
#include "lockwind/slot_input.h"
#include "lockwind/types.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace lockwind {

/// What sessions, logs and forensics need of a deterministic game. World is one
/// (world_simulation.h); a test's counter or a user's own game is another.
class Simulation {
public:
    virtual ~Simulation() = default;

    virtual std::uint32_t slot_count() const = 0;
    virtual std::uint32_t
    input_size_bytes() const = 0; // 1 .. kInputSizeBytesMax, the same all match
    virtual Tick tick() const = 0;

    /// Applies inputs(tick() + 1), one per slot, and steps. An Error (a capacity ran out) is final.
    virtual Status advance(std::span<const SlotInput> inputs) = 0;

    /// XXH3-64 root over all `state` sections. Equal to hash_tree().root.
    virtual std::uint64_t state_hash() const = 0;
    virtual HashTree hash_tree() const = 0;

    /// Canonical bytes of the state: little-endian, the same on every architecture. Replaces `out`.
    virtual void save(std::vector<std::byte>& out) const = 0;
    /// Restores what save() gave. Bytes may come from a peer: anything invalid is an Error and
    /// leaves the simulation as it was.
    virtual Status load(std::span<const std::byte> bytes) = 0;

    /// The state for this very simulation to go back to, so that rolling back costs a copy: with
    /// what it derives from the state, in whatever form. `kept` may hold an earlier one.
    virtual void keep(KeptState& kept) const { save(kept.bytes); }
    /// Goes back to what keep() gave. Any other is the caller's mistake.
    virtual void restore(const KeptState& kept) {
        const Status loaded = load(kept.bytes);
        LOCKWIND_ASSERT(loaded.ok());
    }

    virtual StateSchema schema() const = 0;
    /// Names of the phases of advance, in order; after_phase's number indexes them.
    virtual std::span<const std::string_view> phases() const = 0;
    /// Observer of the following advances; nullptr for none. Not owned.
    virtual void observe(PhaseObserver* observer) = 0;
    /// Test tool: adds one to the raw value of `field` ("section.field", "" for a default) of the
    /// first entity that has it. False where there is none.
    virtual bool corrupt(std::string_view field) = 0;
};

} // namespace lockwind
