#pragma once

#include <cstdint>

namespace lockwind {

/// Waits until a condition of `waitset` (a dds_entity_t) holds or DdsParticipant::clock_us()
/// reaches `deadline_us`. A deadline that has passed returns without a system call.
void wait_on(std::int32_t waitset, std::uint64_t deadline_us);

} // namespace lockwind
