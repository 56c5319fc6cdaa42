#include "bots_report.h"

#include "log/log_format.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lockwind {

namespace {

using Json = nlohmann::ordered_json;

/// Of sessions that predict; a lock-step session never does.
constexpr std::uint64_t kNone = 0;

Json bot_json(const Bot& bot) {
    const LockstepClient& session = bot.session();
    const LockstepClientCounters& counters = session.counters();
    const TransportStats stats = bot.transport().stats();
    return {
        {"slot", session.slot() == kNoSlot ? Json(nullptr) : Json(session.slot())},
        {"ticks_confirmed", counters.ticks_confirmed},
        {"ticks_predicted", kNone},
        {"rollbacks", kNone},
        {"ticks_resimulated", kNone},
        {"mispredictions", kNone},
        {"corrections", kNone},
        {"desyncs", counters.desyncs},
        {"stalls", counters.stalls},
        {"stall_ms_max", counters.stall_ms_max},
        {"rtt_us",
         {{"p50", counters.rtt_us.quantile(500)}, {"p99", counters.rtt_us.quantile(990)}}},
        {"bytes_out", stats.bytes_out},
        {"bytes_in", stats.bytes_in},
        {"state_hash", hash_text(session.state_hash())},
        {"state_hash_tick", session.state_hash_tick()},
        {"confirmed_tick", session.confirmed_tick()},
        {"reconnects", counters.reconnects},
        {"ended", to_string(session.end_reason())},
    };
}

} // namespace

std::string bots_json(const std::vector<const Bot*>& bots) {
    Json list = Json::array();
    for (const Bot* bot : bots) {
        list.push_back(bot_json(*bot));
    }
    return Json{{"bots", std::move(list)}}.dump() + "\n";
}

std::string bots_text(const std::vector<const Bot*>& bots) {
    std::string text;
    for (const Bot* bot : bots) {
        const LockstepClient& session = bot->session();
        const LockstepClientCounters& counters = session.counters();
        text += fmt::format(
            "{}: {} at tick {}, state {}, rtt {}/{} us p50/p99, {} stalls, {} desyncs{}{}\n",
            session.slot() == kNoSlot ? "no slot" : fmt::format("slot {}", session.slot()),
            to_string(session.end_reason()),
            session.confirmed_tick(),
            hash_text(session.state_hash()),
            counters.rtt_us.quantile(500),
            counters.rtt_us.quantile(990),
            counters.stalls,
            counters.desyncs,
            session.end_message().empty() ? "" : ": ",
            session.end_message());
    }
    return text;
}

} // namespace lockwind
