#pragma once

#include "base/arena.h"

#include "lockwind/hash_tree.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace lockwind {

/// When each page (kHashPageBytes of a section's rows) of an arena last may have changed, as told
/// by whoever writes to it: what has not changed need not be copied or hashed again. Versions count
/// the looks at the arena, not ticks.
class PageVersions {
public:
    explicit PageVersions(const StateArena& arena);

    void touch_all() { all_ = now_; }
    void touch(std::uint32_t section) { places_[section].all = now_; }
    void touch(std::uint32_t section, std::uint32_t row) {
        const Place& place = places_[section];
        const std::size_t first = std::size_t{row} * place.stride_bytes;
        const std::size_t last = first + place.stride_bytes - 1;
        pages_[place.first_page + first / kHashPageBytes] = now_;
        pages_[place.first_page + last / kHashPageBytes] = now_;
    }

    /// A page is as it was at a look if its version is not above the look's.
    std::uint64_t of(std::uint32_t section, std::size_t page) const {
        const Place& place = places_[section];
        return std::max({all_, place.all, pages_[place.first_page + page]});
    }
    /// Version of a look now; what is touched from here on is above it.
    std::uint64_t look() { return now_++; }

private:
    struct Place {
        std::size_t first_page;
        std::size_t stride_bytes;
        std::uint64_t all;
    };

    std::uint64_t now_ = 1;
    std::uint64_t all_ = 1;
    std::vector<Place> places_;
    std::vector<std::uint64_t> pages_; // of all sections
};

} // namespace lockwind
