#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "lockwind/result.h"
#include "lockwind/schema.h"
#include "lockwind/types.h"

namespace lockwind {

inline constexpr std::size_t kInputSizeBytesMax = 32;

/// Where a slot's input of a tick came from.
enum class InputStatus : std::uint8_t {
    confirmed = 0,    // the player sent it
    substituted = 1,  // the server repeated the last one
    disconnected = 2, // nobody holds the slot: all bytes are zero
    predicted = 3,    // a client's guess; never in a log
};

/// One slot's input of one tick, opaque to sessions; bytes behind the simulation's size are zero.
struct SlotInput {
    InputStatus status = InputStatus::disconnected;
    std::array<std::uint8_t, kInputSizeBytesMax> bytes{};

    bool operator==(const SlotInput&) const = default;
};

/// Hash tree of a state: world -> section -> page of kHashPageBytes (XXH3-64 throughout).
struct HashTree {
    std::uint64_t root = 0;
    std::vector<std::uint64_t> sections;           // one per `state` section, in schema order
    std::vector<std::vector<std::uint64_t>> pages; // pages[section][page]
};

inline constexpr std::size_t kHashPageBytes = 4096;

/// Called during an advance after each named phase; the simulation may be saved and hashed there.
class PhaseObserver {
public:
    virtual ~PhaseObserver() = default;
    virtual void after_phase(std::uint32_t phase) = 0;
};

/// What sessions, logs and forensics need of a deterministic game. World is one (world_simulation.h);
/// a test's counter or a user's own game is another.
class Simulation {
public:
    virtual ~Simulation() = default;

    virtual std::uint32_t slot_count() const = 0;
    virtual std::uint32_t input_size_bytes() const = 0; // 1 .. kInputSizeBytesMax, the same all match
    virtual Tick tick() const = 0;

    /// Applies inputs(tick() + 1), one per slot, and steps. An Error (a capacity ran out) is final.
    virtual Status advance(std::span<const SlotInput> inputs) = 0;

    /// XXH3-64 root over all `state` sections. Equal to hash_tree().root.
    virtual std::uint64_t state_hash() const = 0;
    virtual HashTree hash_tree() const = 0;

    /// Canonical bytes of the state: little-endian, the same on every architecture. Replaces `out`.
    virtual void save(std::vector<std::byte>& out) const = 0;
    /// Restores what save() gave. Bytes may come from a peer: anything invalid is an Error and leaves
    /// the simulation as it was.
    virtual Status load(std::span<const std::byte> bytes) = 0;

    virtual StateSchema schema() const = 0;
    /// Names of the phases of advance, in order; after_phase's number indexes them.
    virtual std::span<const std::string_view> phases() const = 0;
    /// Observer of the following advances; nullptr for none. Not owned.
    virtual void observe(PhaseObserver* observer) = 0;
    /// Test tool: adds one to the raw value of `field` ("section.field", "" for a default) of the first
    /// entity that has it. False where there is none.
    virtual bool corrupt(std::string_view field) = 0;
};

} // namespace lockwind
