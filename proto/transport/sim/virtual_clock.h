#pragma once

#include "lockwind/assert.h"

#include <cstdint>

namespace lockwind {

/// Time of a simulated network, us. Moves only when the test says so, never backward.
class VirtualClock {
public:
    std::uint64_t now_us() const { return now_us_; }
    void advance_to(std::uint64_t time_us) {
        LOCKWIND_ASSERT(time_us >= now_us_);
        now_us_ = time_us;
    }
    void advance_by(std::uint64_t duration_us) { now_us_ += duration_us; }

private:
    std::uint64_t now_us_ = 0;
};

} // namespace lockwind
