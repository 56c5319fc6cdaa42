#pragma once

#include "base/arena.h"
#include "base/page_versions.h"

#include "lockwind/hash_tree.h"
#include "lockwind/schema.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// XXH3-64, seed 0 (xxHash 0.8): the same value on every architecture.
std::uint64_t hash_bytes(std::span<const std::byte> bytes);

/// Hashes the `state` sections of an arena:
///   page    = XXH3-64 of at most kHashPageBytes of the section's canonical bytes
///   section = XXH3-64 of its pages' hashes, little-endian
///   root    = XXH3-64 of the sections' hashes, little-endian, in schema order
/// Row counts are section 0's content, so an empty section and a missing one differ.
class StateHasher {
public:
    /// Sizes the scratch for any state that fits `arena`; root() then allocates nothing.
    explicit StateHasher(const StateArena& arena);

    std::uint64_t root(const StateArena& arena);
    /// The same of always the same arena, hashing only pages that have changed since the last call.
    std::uint64_t root(const StateArena& arena, PageVersions& versions);
    HashTree tree(const StateArena& arena);

private:
    /// Leaves the section's page hashes, as canonical words, in pages_.
    std::uint64_t hash_section(const StateArena& arena, std::uint32_t section);

    /// A section as root() with versions last saw it.
    struct Known {
        std::size_t size_bytes = 0;
        std::vector<std::uint64_t> pages;
    };
    std::uint64_t
    hash_known(const StateArena& arena, std::uint32_t section, const PageVersions& versions);

    std::vector<std::uint64_t> pages_;    // of one section
    std::vector<std::uint64_t> sections_; // of all `state` sections
    std::vector<std::byte> swapped_;      // canonical rows of one section; big-endian machines only
    std::vector<Known> known_;
    std::uint64_t known_version_ = 0; // 0: nothing is known
};

} // namespace lockwind
