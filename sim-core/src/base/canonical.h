#pragma once

#include "base/arena.h"

#include "lockwind/result.h"
#include "lockwind/schema.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// The canonical form of a state: the live rows of each `state` section, in schema order (so the
/// row counts come first), every component little-endian. On a little-endian machine it is the
/// arena's own bytes; elsewhere the schema drives the byte swap.

std::size_t component_size_bytes(FieldType type);

/// Reverses the bytes of every component of `rows` (whole rows of `section`) in place. Its own
/// inverse.
void swap_rows(const SectionDescriptor& section, std::span<std::byte> rows);

std::size_t canonical_size_bytes(const StateArena& arena);

/// Replaces `out`. Allocates only where `out` is too small.
void save_canonical(const StateArena& arena, std::vector<std::byte>& out);

/// Where the rows of each `state` section lie in `bytes`. Refuses sizes that do not
/// fit the counts; checks nothing else. The counts are not compared to any capacity.
Result<std::vector<std::span<const std::byte>>> split_canonical(StateSchema schema,
                                                                std::span<const std::byte> bytes);

/// Fills `arena` with what save_canonical gave. Refuses sizes and counts that do not fit; the rows'
/// content is not checked. On an Error the arena may hold anything. No allocation but for an Error.
Status load_canonical(StateArena& arena, std::span<const std::byte> bytes);

} // namespace lockwind
