#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lockwind {

/// Hash tree of a state: world -> section -> page of kHashPageBytes (XXH3-64 throughout).
struct HashTree {
    std::uint64_t root = 0;
    std::vector<std::uint64_t> sections;           // one per `state` section, in schema order
    std::vector<std::vector<std::uint64_t>> pages; // pages[section][page]
};

inline constexpr std::size_t kHashPageBytes = 4096;

} // namespace lockwind
