#pragma once

#include "session/messages.h"

#include "lockwind/result.h"

namespace lockwind {

inline constexpr std::uint32_t kTickRateHzMax = 1000;
inline constexpr std::uint32_t kInputDelayTicksMax = 30;
inline constexpr std::uint32_t kHashIntervalTicksMax = 60;
/// 2^40 ticks last 290 years at 120 Hz; the bound keeps times in us within 64 bits.
inline constexpr Tick kMatchTicksMax = Tick{1} << 40U;

/// Ranges of every field; the Error names the field, its value and what is allowed.
Status check(const MatchConfig& config);

/// Is the hash of `tick` reported? Every hash_interval_ticks, and on the last tick of the match.
bool hash_due(const MatchConfig& config, Tick tick);
/// First tick after `tick` whose hash is due.
Tick next_hash_tick(const MatchConfig& config, Tick tick);

/// Length of one tick. Rounded down to whole us; use TickClock for due times, which do not drift.
std::uint64_t tick_period_us(const MatchConfig& config);

} // namespace lockwind
