#include "options.h"

#include "program/console.h"
#include "program/exit_code.h"
#include "transport/dds/dds_participant.h"

#include "lockwind/world_simulation.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace lockwind {

namespace {

/// Flags of the contract that this version knows and refuses, each with its reason.
struct Unavailable {
    std::string desync = "halt";
    std::string resume;
    std::uint32_t matches = 1;
    std::uint32_t metrics = 0;
    std::uint32_t window = 0;
};

std::string refusal(const ServerOptions& options, const Unavailable& asked) {
    if (options.config.mode != "lockstep") {
        return fmt::format("--mode {} is not available in this version; use --mode lockstep",
                           options.config.mode);
    }
    if (asked.desync != "halt") {
        return fmt::format("--desync {} is not available in this version; use --desync halt",
                           asked.desync);
    }
    if (!asked.resume.empty()) {
        return "--resume is not available in this version; the log stays readable: "
               "lockwind replay --verify " +
               asked.resume;
    }
    if (asked.matches != 1) {
        return "--matches above 1 is not available in this version; start a server for each, on a "
               "--domain of its own";
    }
    if (asked.metrics != 0) {
        return "--metrics is not available in this version; --json reports the match at its end";
    }
    if (asked.window != 0) {
        return "--window belongs to --mode rollback, which is not available in this version";
    }
    return "";
}

void add_match_flags(CLI::App& app, ServerOptions& options) {
    MatchConfig& config = options.config;
    app.add_option("--scene", config.scene_name, "built-in scene or scene file (lockwind scenes)")
        ->required();
    app.add_option("--mode", config.mode, "lockstep, rollback or snapshot")
        ->check(CLI::IsMember({"lockstep", "rollback", "snapshot"}))
        ->capture_default_str();
    app.add_option("--players", config.players, "seats; the match starts when all are taken")
        ->capture_default_str();
    app.add_option("--ticks", config.ticks, "length of the match; without it, until all have left")
        ->check(CLI::PositiveNumber);
    app.add_option("--tick-rate", config.tick_rate_hz, "ticks a second")->capture_default_str();
    app.add_option("--seed", config.seed, "of the world's random draws")->capture_default_str();
    app.add_option("--match", config.match, "name of the match; bots join by it")
        ->capture_default_str();
    app.add_option("--input-delay", config.input_delay_ticks, "ticks from an input to its effect")
        ->capture_default_str();
    app.add_option("--hash-interval", config.hash_interval_ticks, "ticks from hash to hash")
        ->capture_default_str();
}

void add_server_flags(CLI::App& app, ServerOptions& options) {
    app.add_option("--listen", options.listen, "network interface, or its address")
        ->capture_default_str();
    app.add_option("--domain", options.domain, "DDS domain; one server each")
        ->check(CLI::Range(1U, kDdsDomainMax))
        ->capture_default_str();
    app.add_option("--join-timeout", options.join_timeout_s, "seconds to wait for the players")
        ->check(CLI::Range(1U, 86'400U))
        ->capture_default_str();
    app.add_option("--log", options.log_path, "the match's log; must not exist");
    app.add_flag("--json", options.json, "print one JSON object on stdout at the end");
}

void add_unavailable_flags(CLI::App& app, Unavailable& asked) {
    app.add_option("--desync", asked.desync, "what a desync does: halt, resync or kick")
        ->check(CLI::IsMember({"halt", "resync", "kick"}))
        ->capture_default_str();
    app.add_option("--resume", asked.resume, "continue the match of a log (not available)");
    app.add_option("--matches", asked.matches, "matches in one process (not available)");
    app.add_option("--metrics", asked.metrics, "HTTP port for metrics (not available)");
    app.add_option("--window", asked.window, "prediction window, ticks (not available)");
}

} // namespace

ParsedOptions parse_options(int argc, const char* const* argv) {
    ServerOptions options;
    options.config.match = "match";
    options.config.mode = "lockstep";
    Unavailable asked;
    CLI::App app{"Lockwind's dedicated server: runs one match over DDS, records it in a log, and "
                 "traces every desync."};
    app.set_version_flag(
        "--version",
        fmt::format("lockwind-server, sim_version {}, {}", sim_version(), build_info()));
    app.footer("Exit codes: 0 done; 1 a desync; 2 wrong usage; 3 file trouble; 4 network trouble.");
    add_match_flags(app, options);
    add_server_flags(app, options);
    add_unavailable_flags(app, asked);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return {std::nullopt, app.exit(success)};
    } catch (const CLI::ParseError& error) {
        say_error(fmt::format("{}; see lockwind-server --help", error.what()));
        return {std::nullopt, kExitUsage};
    }
    if (const std::string refused = refusal(options, asked); !refused.empty()) {
        say_error(refused);
        return {std::nullopt, kExitUsage};
    }
    return {options, kExitDone};
}

} // namespace lockwind
