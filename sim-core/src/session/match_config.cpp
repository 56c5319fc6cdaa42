#include "session/match_config.h"

#include <string>
#include <string_view>

namespace lockwind {
namespace {

Error out_of_range(std::string_view field,
                   std::uint64_t value,
                   std::uint64_t smallest,
                   std::uint64_t largest) {
    return Error{"match config: " + std::string(field) + " is " + std::to_string(value) +
                 "; allowed are " + std::to_string(smallest) + " to " + std::to_string(largest)};
}

} // namespace

Status check(const MatchConfig& config) {
    if (config.mode != "lockstep") {
        return Error{"match config: mode is \"" + config.mode + "\"; supported is \"lockstep\""};
    }
    if (config.tick_rate_hz < 1 || config.tick_rate_hz > kTickRateHzMax) {
        return out_of_range("tick_rate_hz", config.tick_rate_hz, 1, kTickRateHzMax);
    }
    if (config.players < 1 || config.players > kPlayersMax) {
        return out_of_range("players", config.players, 1, kPlayersMax);
    }
    if (config.input_delay_ticks > kInputDelayTicksMax) {
        return out_of_range("input_delay_ticks", config.input_delay_ticks, 0, kInputDelayTicksMax);
    }
    if (config.hash_interval_ticks < 1 || config.hash_interval_ticks > kHashIntervalTicksMax) {
        return out_of_range(
            "hash_interval_ticks", config.hash_interval_ticks, 1, kHashIntervalTicksMax);
    }
    if (config.ticks > kMatchTicksMax) {
        return out_of_range("ticks", config.ticks, 0, kMatchTicksMax);
    }
    return Success{};
}

bool hash_due(const MatchConfig& config, Tick tick) {
    return tick % config.hash_interval_ticks == 0 || (config.ticks != 0 && tick == config.ticks);
}

Tick next_hash_tick(const MatchConfig& config, Tick tick) {
    const Tick next = tick - tick % config.hash_interval_ticks + config.hash_interval_ticks;
    return tick < config.ticks && next > config.ticks ? config.ticks : next;
}

std::uint64_t tick_period_us(const MatchConfig& config) {
    return 1'000'000 / config.tick_rate_hz;
}

} // namespace lockwind
