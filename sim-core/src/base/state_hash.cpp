#include "base/state_hash.h"

#include "base/canonical.h"

#include <algorithm>
#include <bit>
#include <cstring>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace lockwind {

namespace {

/// A hash as it is hashed again: little-endian in memory.
std::uint64_t canonical_word(std::uint64_t value) {
    if constexpr (std::endian::native == std::endian::big) {
        std::byte bytes[sizeof(value)];
        std::memcpy(bytes, &value, sizeof(value));
        std::reverse(bytes, bytes + sizeof(value));
        std::memcpy(&value, bytes, sizeof(value));
    }
    return value;
}

std::uint64_t hash_words(const std::vector<std::uint64_t>& words) {
    return hash_bytes(std::as_bytes(std::span(words)));
}

} // namespace

std::uint64_t hash_bytes(std::span<const std::byte> bytes) {
    return XXH3_64bits(bytes.data(), bytes.size());
}

StateHasher::StateHasher(const StateArena& arena) {
    std::size_t largest_bytes = 0;
    for (std::uint32_t section = 0; section < arena.state_section_count(); ++section) {
        const std::size_t stride = arena.schema()[section].stride_bytes;
        largest_bytes = std::max(largest_bytes, stride * arena.capacity(section));
    }
    pages_.reserve(largest_bytes / kHashPageBytes + 1);
    sections_.reserve(arena.section_count());
    known_.resize(arena.state_section_count());
    for (std::uint32_t section = 0; section < arena.state_section_count(); ++section) {
        const std::size_t stride = arena.schema()[section].stride_bytes;
        known_[section].pages.reserve(stride * arena.capacity(section) / kHashPageBytes + 1);
    }
    if constexpr (std::endian::native == std::endian::big) {
        swapped_.reserve(largest_bytes);
    }
}

std::uint64_t StateHasher::hash_section(const StateArena& arena, std::uint32_t section) {
    std::span<const std::byte> rows = arena.live_bytes(section);
    if constexpr (std::endian::native == std::endian::big) {
        swapped_.assign(rows.begin(), rows.end());
        swap_rows(arena.schema()[section], swapped_);
        rows = swapped_;
    }
    pages_.clear();
    for (std::size_t offset = 0; offset < rows.size(); offset += kHashPageBytes) {
        const std::size_t size = std::min(kHashPageBytes, rows.size() - offset);
        pages_.push_back(canonical_word(hash_bytes(rows.subspan(offset, size))));
    }
    return hash_words(pages_);
}

std::uint64_t StateHasher::root(const StateArena& arena) {
    sections_.clear();
    for (std::uint32_t section = 0; section < arena.state_section_count(); ++section) {
        sections_.push_back(canonical_word(hash_section(arena, section)));
    }
    return hash_words(sections_);
}

std::uint64_t StateHasher::hash_known(const StateArena& arena,
                                      std::uint32_t section,
                                      const PageVersions& versions) {
    const std::span<const std::byte> rows = arena.live_bytes(section);
    Known& known = known_[section];
    known.pages.resize((rows.size() + kHashPageBytes - 1) / kHashPageBytes);
    for (std::size_t page = 0; page < known.pages.size(); ++page) {
        const std::size_t offset = page * kHashPageBytes;
        const std::size_t end = std::min(offset + kHashPageBytes, rows.size());
        const bool same_size =
            end <= known.size_bytes && (end - offset == kHashPageBytes || end == known.size_bytes);
        if (!same_size || versions.of(section, page) > known_version_) {
            known.pages[page] = hash_bytes(rows.subspan(offset, end - offset));
        }
    }
    known.size_bytes = rows.size();
    return hash_words(known.pages);
}

std::uint64_t StateHasher::root(const StateArena& arena, PageVersions& versions) {
    if constexpr (std::endian::native == std::endian::big) {
        return root(arena); // a section's rows are swapped as a whole
    }
    sections_.clear();
    for (std::uint32_t section = 0; section < arena.state_section_count(); ++section) {
        sections_.push_back(hash_known(arena, section, versions));
    }
    known_version_ = versions.look();
    return hash_words(sections_);
}

HashTree StateHasher::tree(const StateArena& arena) {
    HashTree tree;
    sections_.clear();
    for (std::uint32_t section = 0; section < arena.state_section_count(); ++section) {
        const std::uint64_t hash = hash_section(arena, section);
        sections_.push_back(canonical_word(hash));
        tree.sections.push_back(hash);
        tree.pages.emplace_back(pages_.size());
        std::transform(pages_.begin(), pages_.end(), tree.pages.back().begin(), canonical_word);
    }
    tree.root = hash_words(sections_);
    return tree;
}

} // namespace lockwind
