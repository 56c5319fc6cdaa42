#pragma once

#include <ctime>

namespace lockwind::bench {

/// Processor time of this thread, s. A step waits for nothing, so that this is its time on an idle
/// machine; what wall clocks add on a busy one is the time of others.
inline double thread_seconds() {
    std::timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

} // namespace lockwind::bench
