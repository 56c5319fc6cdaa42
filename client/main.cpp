#include "bots_command.h"
#include "diff_command.h"
#include "info_command.h"
#include "program/console.h"
#include "program/exit_code.h"
#include "program/flag_values.h"
#include "replay_command.h"
#include "scenes_command.h"
#include "transport/dds/dds_participant.h"

#include "lockwind/world_simulation.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <fmt/format.h>

namespace lockwind {

namespace {

/// What was asked for: one subcommand's options, and how to run it.
struct Commands {
    BotsOptions bots;
    ReplayCommandOptions replay;
    DiffCommandOptions diff;
    InfoCommandOptions info;
    ScenesOptions scenes;
    std::function<int()> run;
};

void add_bots(CLI::App& app, Commands& commands) {
    BotsOptions& options = commands.bots;
    CLI::App* command = app.add_subcommand("bots", "play a match with headless bots");
    command->add_option("--count", options.count, "bots in this process, each with its own world")
        ->check(whole_number(1, kPlayersMax))
        ->capture_default_str();
    command->add_option("--server", options.server, "the server's address")
        ->check(not_empty())
        ->capture_default_str();
    command->add_option("--domain", options.domain, "DDS domain, as the server's")
        ->check(whole_number(1, kDdsDomainMax))
        ->capture_default_str();
    command->add_option("--match", options.match, "name of the match")
        ->check(not_empty())
        ->capture_default_str();
    command
        ->add_option(
            "--connect-timeout", options.connect_timeout_s, "seconds to look for the match")
        ->check(whole_number(1, 86'400))
        ->capture_default_str();
    command->add_option("--behaviour", options.behaviour, "fight, wander, idle or log:FILE")
        ->capture_default_str();
    command->add_option("--seed", options.seed, "of the bots' whims and tokens; drawn if not given")
        ->check(whole_number());
    command->add_option("--net",
                        options.net,
                        "worse links: latency=40ms,jitter=10ms,loss=2%,duplicate=1%,reorder=1%");
    command->add_option("--corrupt",
                        options.corrupt,
                        "test tool: slot=S,tick=T[,field=NAME] changes state after step T");
    command
        ->add_option("--corrupt-phase",
                     options.corrupt_phase,
                     "test tool: changes state after every run of this phase")
        ->check(not_empty());
    command->add_flag("--json", options.json, "print one JSON object on stdout at the end");
    command->callback([&commands] { commands.run = [&] { return run_bots(commands.bots); }; });
}

void add_replay(CLI::App& app, Commands& commands) {
    ReplayCommandOptions& options = commands.replay;
    CLI::App* command = app.add_subcommand("replay", "step a log's inputs again");
    command->add_option("LOG", options.log, "the log")->check(not_empty())->required();
    command->add_flag("--verify", options.verify, "compare every hash; exit 1 at a difference");
    command->add_option("--from", options.from, "first tick to step, from the keyframe before it")
        ->check(whole_number());
    command->add_option("--to", options.to, "last tick to step")->check(whole_number());
    command->add_option("--trace", options.trace, "write the hash after every phase to this file")
        ->check(not_empty());
    command->add_flag("--trace-states",
                      options.trace_states,
                      "with the states, so that a diff of traces names the field");
    command->add_option("--snapshot", options.snapshot, "write the last state to this file")
        ->check(not_empty());
    CLI::Option* bisect =
        command
            ->add_option("--bisect",
                         options.bisect,
                         "another build's lockwind: trace both, print the first divergence")
            ->check(not_empty());
    command
        ->add_option("--rerecord",
                     options.rerecord,
                     "write the log as this build records it; exit 1 where a byte differs")
        ->check(not_empty())
        ->excludes(bisect, "--verify", "--from", "--to", "--trace", "--trace-states", "--snapshot");
    command->add_flag("--json", options.json, "print one JSON object on stdout");
    command->callback([&commands] { commands.run = [&] { return run_replay(commands.replay); }; });
}

void add_diff(CLI::App& app, Commands& commands) {
    DiffCommandOptions& options = commands.diff;
    CLI::App* command = app.add_subcommand(
        "diff", "the first divergence: of a bundle, or of two logs, traces or snapshots");
    command->add_option("A", options.a, "a bundle, log, trace or snapshot")
        ->check(not_empty())
        ->required();
    command->add_option("B", options.b, "what to compare it with; not for a bundle")
        ->check(not_empty());
    command->add_option("--junit", options.junit, "write JUnit XML to this file, for CI")
        ->check(not_empty());
    command->add_flag("--json", options.json, "print one JSON object on stdout");
    command->callback([&commands] { commands.run = [&] { return run_diff(commands.diff); }; });
}

void add_info(CLI::App& app, Commands& commands) {
    InfoCommandOptions& options = commands.info;
    CLI::App* command = app.add_subcommand("info", "what a log, trace, bundle or snapshot holds");
    command->add_option("FILE", options.file, "any file that the tools wrote")
        ->check(not_empty())
        ->required();
    command->add_option("--export", options.export_file, "write it as plain protobuf to this file")
        ->check(not_empty());
    command->add_flag("--json", options.json, "print one JSON object on stdout");
    command->callback([&commands] { commands.run = [&] { return run_info(commands.info); }; });
}

void add_scenes(CLI::App& app, Commands& commands) {
    ScenesOptions& options = commands.scenes;
    CLI::App* command = app.add_subcommand("scenes", "list the built-in scenes, or check one");
    command->add_option("--check", options.check, "scene file (or name) to check")
        ->check(not_empty());
    command->add_flag("--json", options.json, "print one JSON object on stdout");
    command->callback([&commands] { commands.run = [&] { return run_scenes(commands.scenes); }; });
}

/// CLI11 calls a mistyped command a missing one.
std::string what_is_wrong(const CLI::App& app, int argc, char** argv, const char* words) {
    const auto commands = app.get_subcommands([](const CLI::App* /*any*/) { return true; });
    const bool is_mistyped =
        argc > 1 && argv[1][0] != '-' &&
        std::ranges::none_of(commands, [&](auto* command) { return command->check_name(argv[1]); });
    return is_mistyped ? fmt::format("there is no command '{}'", argv[1]) : words;
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
    add_replay(app, commands);
    add_diff(app, commands);
    add_info(app, commands);
    add_scenes(app, commands);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        say_error(
            fmt::format("{}; see lockwind --help", what_is_wrong(app, argc, argv, error.what())));
        return kExitUsage;
    }
    return commands.run();
}

} // namespace

} // namespace lockwind

int main(int argc, char** argv) try {
    lockwind::set_up_messages();
    return lockwind::run(argc, argv);
} catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return lockwind::kExitFile;
}
