#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace lockwind {

/// A state that a simulation keeps to go back to. Keeping into the same one again, and going back
/// to it, may then copy no more than what has changed meanwhile.
struct KeptState {
    std::vector<std::byte> bytes;      // in whatever form the simulation likes
    std::shared_ptr<const void> owner; // whose bytes they are; null where they are complete
    std::uint64_t version = 0;         // of the owner's, when they were kept
};

} // namespace lockwind
