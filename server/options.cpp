#include "options.h"

#include "program/console.h"
#include "program/exit_code.h"
#include "program/flag_values.h"
#include "session/match_config.h"
#include "transport/dds/dds_participant.h"

#include "lockwind/world_definition.h"
#include "lockwind/world_simulation.h"

#include <algorithm>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace lockwind {

namespace {

/// A flag of the contract that this version knows and refuses whatever its value.
struct Unavailable {
    const char* flag;
    const char* help;
    const char* instead;
};
constexpr Unavailable kUnavailable[] = {
    {"--resume",
     "continue the match of a log",
     "the log stays readable: lockwind replay --verify LOG"},
    {"--matches",
     "matches in one process",
     "start a server for each match, on a --domain of its own"},
    {"--metrics", "HTTP port for metrics", "--json reports the match at its end"},
    {"--window", "prediction window, ticks", "it belongs to --mode rollback"},
};

/// A choice of which only one is there yet.
CLI::Validator only(const std::string& available, const std::vector<std::string>& planned) {
    const auto check = [=](const std::string& value) -> std::string {
        if (value == available) {
            return "";
        }
        const bool is_planned = std::ranges::find(planned, value) != planned.end();
        return fmt::format("'{}' {}; use {}",
                           value,
                           is_planned ? "is not available in this version" : "is unknown",
                           available);
    };
    return CLI::Validator(check, "", "only");
}

void add_match_flags(CLI::App& app, ServerOptions& options) {
    MatchConfig& config = options.config;
    app.add_option("--scene", config.scene_name, "built-in scene or scene file (lockwind scenes)")
        ->check(not_empty())
        ->required();
    app.add_option("--mode", config.mode, "lockstep, rollback or snapshot")
        ->check(only("lockstep", {"rollback", "snapshot"}))
        ->capture_default_str();
    app.add_option("--players", config.players, "seats; the match starts when all are taken")
        ->check(whole_number(1, kPlayersMax))
        ->capture_default_str();
    app.add_option("--ticks", config.ticks, "length of the match; without it, until all have left")
        ->check(whole_number(1, kMatchTicksMax));
    app.add_option("--tick-rate", config.tick_rate_hz, "ticks a second")
        ->check(whole_number(kWorldTickRateHzMin, kWorldTickRateHzMax))
        ->capture_default_str();
    app.add_option("--seed", config.seed, "of the world's random draws")
        ->check(whole_number())
        ->capture_default_str();
    app.add_option("--match", config.match, "name of the match; bots join by it")
        ->capture_default_str();
    app.add_option("--input-delay", config.input_delay_ticks, "ticks from an input to its effect")
        ->check(whole_number(0, kInputDelayTicksMax))
        ->capture_default_str();
    app.add_option("--hash-interval", config.hash_interval_ticks, "ticks from hash to hash")
        ->check(whole_number(1, kHashIntervalTicksMax))
        ->capture_default_str();
}

void add_server_flags(CLI::App& app, ServerOptions& options) {
    app.add_option("--listen", options.listen, "network interface, or its address")
        ->check(not_empty())
        ->capture_default_str();
    app.add_option("--domain", options.domain, "DDS domain; one server each")
        ->check(whole_number(1, kDdsDomainMax))
        ->capture_default_str();
    app.add_option("--join-timeout", options.join_timeout_s, "seconds to wait for the players")
        ->check(whole_number(1, 86'400))
        ->capture_default_str();
    app.add_option("--log", options.log_path, "the match's log; must not exist")
        ->check(not_empty());
    app.add_flag("--json", options.json, "print one JSON object on stdout at the end");
}

void add_unavailable_flags(CLI::App& app) {
    const auto ignore = [](const std::string& /*value*/) {};
    app.add_option_function<std::string>(
           "--desync", ignore, "what a desync does: halt, resync or kick")
        ->check(only("halt", {"resync", "kick"}))
        ->default_str("halt");
    for (const Unavailable& one : kUnavailable) {
        const auto refuse = [&one](const std::string& /*value*/) {
            throw CLI::ValidationError(
                one.flag, fmt::format("is not available in this version; {}", one.instead));
        };
        app.add_option_function<std::string>(
            one.flag, refuse, fmt::format("{} (not available)", one.help));
    }
}

} // namespace

ParsedOptions parse_options(int argc, const char* const* argv) {
    ServerOptions options;
    options.config.match = "match";
    options.config.mode = "lockstep";
    CLI::App app{"Lockwind's dedicated server: runs one match over DDS, records it in a log, and "
                 "traces every desync."};
    app.set_version_flag(
        "--version",
        fmt::format("lockwind-server, sim_version {}, {}", sim_version(), build_info()));
    app.footer("Exit codes: 0 done; 1 a desync; 2 wrong usage; 3 file trouble; 4 network trouble.");
    add_match_flags(app, options);
    add_server_flags(app, options);
    add_unavailable_flags(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return {std::nullopt, app.exit(success)};
    } catch (const CLI::ParseError& error) {
        say_error(fmt::format("{}; see lockwind-server --help", error.what()));
        return {std::nullopt, kExitUsage};
    }
    return {options, kExitDone};
}

} // namespace lockwind
