#include "bots_command.h"
#include "program/console.h"
#include "program/exit_code.h"
#include "scenes_command.h"
#include "transport/dds/dds_participant.h"

#include "lockwind/world_simulation.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace lockwind {

namespace {

/// What was asked for: one subcommand's options, and how to run it.
struct Commands {
    BotsOptions bots;
    ScenesOptions scenes;
    std::function<int()> run;
};

void add_bots(CLI::App& app, Commands& commands) {
    BotsOptions& options = commands.bots;
    CLI::App* command = app.add_subcommand("bots", "play a match with headless bots");
    command->add_option("--count", options.count, "bots in this process, each with its own world")
        ->check(CLI::Range(1U, kPlayersMax))
        ->capture_default_str();
    command->add_option("--server", options.server, "the server's address")->capture_default_str();
    command->add_option("--domain", options.domain, "DDS domain, as the server's")
        ->check(CLI::Range(1U, kDdsDomainMax))
        ->capture_default_str();
    command->add_option("--match", options.match, "name of the match")->capture_default_str();
    command->add_option("--behaviour", options.behaviour, "fight, wander, idle or log:FILE")
        ->capture_default_str();
    command->add_option("--seed", options.seed, "of the bots' whims and tokens; drawn if not given");
    command->add_option("--net",
                        options.net,
                        "worse links: latency=40ms,jitter=10ms,loss=2%,duplicate=1%,reorder=1%");
    command->add_option("--corrupt",
                        options.corrupt,
                        "test tool: slot=S,tick=T[,field=NAME] changes state after step T");
    command->add_option("--corrupt-phase",
                        options.corrupt_phase,
                        "test tool: changes state after every run of this phase");
    command->add_flag("--json", options.json, "print one JSON object on stdout at the end");
    command->callback([&commands] { commands.run = [&] { return run_bots(commands.bots); }; });
}

void add_scenes(CLI::App& app, Commands& commands) {
    ScenesOptions& options = commands.scenes;
    CLI::App* command = app.add_subcommand("scenes", "list the built-in scenes, or check one");
    command->add_option("--check", options.check, "scene file (or name) to check");
    command->add_flag("--json", options.json, "print one JSON object on stdout");
    command->callback([&commands] { commands.run = [&] { return run_scenes(commands.scenes); }; });
}

int run(int argc, char** argv) {
    Commands commands;
    CLI::App app{"Lockwind's client tools: bots, and whatever reads the files of a match."};
    app.set_version_flag("--version",
                         fmt::format("lockwind, sim_version {}, {}", sim_version(), build_info()));
    app.footer("Exit codes: 0 done and in agreement; 1 a divergence; 2 wrong usage; 3 a file is "
               "missing or damaged; 4 network trouble.");
    app.require_subcommand(1);
    add_bots(app, commands);
    add_scenes(app, commands);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        say_error(fmt::format("{}; see lockwind --help", error.what()));
        return kExitUsage;
    }
    return commands.run();
}

} // namespace

} // namespace lockwind

int main(int argc, char** argv) {
    lockwind::set_up_messages();
    return lockwind::run(argc, argv);
}
