#include "transport/dds/wait.h"

#include "transport/dds/dds_participant.h"

#include <algorithm>
#include <dds/dds.h>

namespace lockwind {

void wait_on(std::int32_t waitset, std::uint64_t deadline_us) {
    const std::uint64_t now_us = DdsParticipant::clock_us();
    if (deadline_us <= now_us) {
        return;
    }
    // Cyclone's deadlines are on the wall clock, ours are on the monotonic one.
    constexpr std::uint64_t kWaitUsMax = 3'600'000'000;
    const std::uint64_t wait_us = std::min(deadline_us - now_us, kWaitUsMax);
    (void)dds_waitset_wait_until(
        waitset, nullptr, 0, dds_time() + static_cast<dds_duration_t>(wait_us * 1'000));
}

} // namespace lockwind
