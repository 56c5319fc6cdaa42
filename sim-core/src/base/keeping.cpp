#include "base/keeping.h"

#include "lockwind/assert.h"
#include "lockwind/hash_tree.h"

#include <algorithm>
#include <cstring>

namespace lockwind {

namespace {

// Kept bytes: the row counts, then each section's rows with room to grow in, so that the next
// section stays where it is while they do.
constexpr std::size_t kRoomBytes = 4 * kHashPageBytes;

std::size_t round_up(std::size_t size_bytes) {
    return (size_bytes + kRoomBytes - 1) / kRoomBytes * kRoomBytes;
}

std::size_t counts_size(const StateArena& arena) {
    return arena.section_count() * sizeof(std::uint32_t);
}

std::uint32_t kept_count(const KeptState& kept, std::uint32_t section) {
    std::uint32_t count = 0;
    std::memcpy(&count, kept.bytes.data() + section * sizeof(count), sizeof(count));
    return count;
}

/// Calls visit(offset, size) for each page of a section that differs from how it was at `version`.
/// `known_size`: how many of its bytes were there then.
template <class Visit>
void for_changed_pages(const PageVersions& versions,
                       std::uint32_t section,
                       std::size_t size,
                       std::size_t known_size,
                       std::uint64_t version,
                       Visit&& visit) {
    for (std::size_t offset = 0; offset < size; offset += kHashPageBytes) {
        const std::size_t end = std::min(offset + kHashPageBytes, size);
        if (versions.of(section, offset / kHashPageBytes) > version || end > known_size) {
            visit(offset, end - offset);
        }
    }
}

} // namespace

Keeper::Keeper() : token_(std::make_shared<const int>(0)) {}

void Keeper::keep(const StateArena& arena, PageVersions& versions, KeptState& kept) const {
    std::size_t total = counts_size(arena);
    bool same_places = kept.owner == token_;
    for (std::uint32_t section = 1; section < arena.section_count(); ++section) {
        const std::size_t room = round_up(arena.live_bytes(section).size());
        const std::size_t stride = arena.schema()[section].stride_bytes;
        same_places = same_places && room == round_up(stride * kept_count(kept, section));
        total += room;
    }
    kept.bytes.resize(total);
    std::byte* next = kept.bytes.data() + counts_size(arena);
    for (std::uint32_t section = 1; section < arena.section_count(); ++section) {
        const std::span<const std::byte> rows = arena.live_bytes(section);
        const std::size_t stride = arena.schema()[section].stride_bytes;
        const std::size_t known = same_places ? stride * kept_count(kept, section) : 0;
        for_changed_pages(versions,
                          section,
                          rows.size(),
                          known,
                          same_places ? kept.version : 0,
                          [&](std::size_t offset, std::size_t size) {
                              std::memcpy(next + offset, rows.data() + offset, size);
                          });
        next += round_up(rows.size());
    }
    for (std::uint32_t section = 0; section < arena.section_count(); ++section) {
        const std::uint32_t count = arena.row_count(section);
        std::memcpy(kept.bytes.data() + section * sizeof(count), &count, sizeof(count));
    }
    kept.owner = token_;
    kept.version = versions.look();
}

void Keeper::restore(StateArena& arena, PageVersions& versions, const KeptState& kept) const {
    LOCKWIND_ASSERT(kept.owner == token_);
    const std::byte* next = kept.bytes.data() + counts_size(arena);
    versions.touch(0);
    for (std::uint32_t section = 1; section < arena.section_count(); ++section) {
        const std::size_t known = arena.live_bytes(section).size();
        arena.set_row_count(section, kept_count(kept, section));
        const std::span<std::byte> rows = arena.live_bytes(section);
        const std::uint32_t stride = arena.schema()[section].stride_bytes;
        for_changed_pages(
            versions,
            section,
            rows.size(),
            known,
            kept.version,
            [&](std::size_t offset, std::size_t size) {
                std::memcpy(rows.data() + offset, next + offset, size);
                versions.touch(section, static_cast<std::uint32_t>(offset / stride));
                versions.touch(section, static_cast<std::uint32_t>((offset + size - 1) / stride));
            });
        next += round_up(rows.size());
    }
}

} // namespace lockwind
