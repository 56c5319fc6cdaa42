#include "report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lockwind {

namespace {

nlohmann::ordered_json quantiles_json(const Histogram& histogram) {
    return {{"p50", histogram.quantile(500)},
            {"p99", histogram.quantile(990)},
            {"max", histogram.max()}};
}

/// By reason; those that occurred.
nlohmann::ordered_json violations_json(const ViolationCounts& violations) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (std::size_t index = 0; index < kViolationCount; ++index) {
        const auto violation = static_cast<Violation>(index);
        if (violations.of(violation) > 0) {
            json[std::string(to_string(violation))] = violations.of(violation);
        }
    }
    return json;
}

nlohmann::ordered_json or_null(const std::string& text) {
    return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
}

std::string quantiles_text(const Histogram& histogram) {
    return fmt::format(
        "{}/{}/{}", histogram.quantile(500), histogram.quantile(990), histogram.max());
}

} // namespace

std::string report_json(const MatchServer& match) {
    const LockstepServer& session = match.session();
    const LockstepServerCounters& counters = session.counters();
    nlohmann::ordered_json desyncs = nlohmann::ordered_json::array();
    for (const DesyncOutcome& outcome : match.desyncs()) {
        desyncs.push_back({{"slot", outcome.desync.slot},
                           {"tick", outcome.desync.bad_tick},
                           {"bundle", or_null(outcome.bundle)},
                           {"verdict", or_null(outcome.verdict)},
                           {"problem", or_null(outcome.problem)}});
    }
    const nlohmann::ordered_json report{
        {"ticks", session.confirmed_tick()},
        {"players", session.config().players},
        {"state_hash", hash_text(session.state_hash())},
        {"state_hash_tick", session.state_hash_tick()},
        {"desyncs", counters.desyncs},
        {"desync", std::move(desyncs)},
        {"contacts", match.figures().contacts.quantile(500)},
        {"created", match.figures().created},
        {"destroyed", match.figures().destroyed},
        {"scores", match.figures().scores},
        {"late_inputs", counters.late_inputs},
        {"substituted_inputs", counters.substituted_inputs},
        {"stalls", counters.stalls},
        {"stall_ms_max", counters.stall_ms_max},
        {"drops", counters.drops},
        {"reconnects", counters.reconnects},
        {"joins", counters.joins},
        {"violations", violations_json(counters.violations)},
        {"packets_malformed", match.transport().stats().packets_malformed},
        {"packets_spoofed", match.transport().stats().packets_spoofed},
        {"tick_lateness_us", quantiles_json(counters.tick_lateness_us)},
        {"step_us", quantiles_json(match.figures().step_us)},
        {"log", match.log().path()},
        {"sim_version", sim_version()},
        {"ended", to_string(session.end_reason())},
    };
    // A path may hold any bytes; JSON holds UTF-8.
    return report.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string report_text(const MatchServer& match) {
    const LockstepServer& session = match.session();
    const LockstepServerCounters& counters = session.counters();
    std::string text =
        fmt::format("match      {}: {} at tick {}{}{}\n"
                    "state      {} at tick {}\n"
                    "contacts   {} a tick (median); {} bodies created, {} destroyed\n"
                    "lateness   {} us p50/p99/max; step {} us\n"
                    "network    {} joins, {} reconnects, {} drops, {} stalls, {} late inputs\n"
                    "log        {}\n",
                    session.config().match,
                    to_string(session.end_reason()),
                    session.confirmed_tick(),
                    session.end_message().empty() ? "" : ": ",
                    session.end_message(),
                    hash_text(session.state_hash()),
                    session.state_hash_tick(),
                    match.figures().contacts.quantile(500),
                    match.figures().created,
                    match.figures().destroyed,
                    quantiles_text(counters.tick_lateness_us),
                    quantiles_text(match.figures().step_us),
                    counters.joins,
                    counters.reconnects,
                    counters.drops,
                    counters.stalls,
                    counters.late_inputs,
                    match.log().path());
    if (counters.violations.total() > 0) {
        text += fmt::format("ignored    {}\n", violations_json(counters.violations).dump());
    }
    for (const DesyncOutcome& outcome : match.desyncs()) {
        text +=
            fmt::format("desync     slot {} at tick {}: {}\n",
                        outcome.desync.slot,
                        outcome.desync.bad_tick,
                        outcome.bundle.empty()
                            ? outcome.problem
                            : fmt::format("{}; lockwind diff {}", outcome.verdict, outcome.bundle));
    }
    return text;
}

} // namespace lockwind
