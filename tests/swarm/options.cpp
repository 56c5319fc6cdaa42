#include "tests/swarm/options.h"

#include "program/console.h"
#include "program/exit_code.h"
#include "program/flag_values.h"
#include "tests/swarm/scenario.h"

#include "lockwind/world_simulation.h"

#include <algorithm>
#include <fmt/format.h>
#include <string>
#include <thread>
#include <vector>

namespace lockwind::swarm {

namespace {

constexpr std::uint64_t kSeedsDefault = 200;
constexpr std::uint64_t kSeedsMax = 1'000'000'000;
constexpr std::uint64_t kTicksMax = 100'000;

void add_flags(CLI::App& app, SwarmOptions& options, std::string& mode, std::string& plant) {
    const auto names = plant_names();
    app.add_option("--seeds", options.workers.seeds, "how many seeds")
        ->check(whole_number(1, kSeedsMax))
        ->capture_default_str();
    app.add_option("--first", options.workers.first_seed, "the first seed")
        ->check(whole_number())
        ->capture_default_str();
    app.add_option("--ticks", options.swarm.ticks, "length of each match")
        ->check(whole_number(kTicksMin, kTicksMax))
        ->capture_default_str();
    app.add_option("--mode", mode, "of the matches; there is one so far")
        ->check(CLI::IsMember({"lockstep"}))
        ->capture_default_str();
    app.add_option("--scene", options.swarm.scene_name, "built-in scene or scene file")
        ->check(not_empty())
        ->capture_default_str();
    app.add_option("--jobs", options.workers.jobs, "seeds at the same time, a process each")
        ->check(whole_number(1, 1024))
        ->capture_default_str();
    app.add_option("--plant", plant, "a bug to be found; stops at the first seed that finds it")
        ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
    app.add_flag("--verbose", options.verbose, "with --seeds 1: what happened, in virtual time");
    app.add_flag("--json", options.json, "print one JSON object on stdout at the end");
}

} // namespace

ParsedOptions parse_options(int argc, const char* const* argv) {
    SwarmOptions options;
    options.workers.seeds = kSeedsDefault;
    options.workers.jobs = std::max(1U, std::thread::hardware_concurrency());
    std::string mode = "lockstep";
    std::string plant;
    CLI::App app{"Plays matches of the shipped server and bots over a simulated network in virtual "
                 "time, each under the faults that its seed draws, and checks what everybody saw."};
    app.set_version_flag(
        "--version",
        fmt::format("lockwind-swarm, sim_version {}, {}", sim_version(), build_info()));
    app.footer("Exit codes: 0 all seeds held; 1 one failed, or too little happened; 2 wrong usage; "
               "3 file trouble.");
    add_flags(app, options, mode, plant);
    try {
        app.parse(argc, argv);
        if (options.verbose && options.workers.seeds != 1) {
            throw CLI::ValidationError("--verbose", "shows one match: it needs --seeds 1");
        }
    } catch (const CLI::Success& success) {
        return {std::nullopt, app.exit(success)};
    } catch (const CLI::ParseError& error) {
        say_error(fmt::format("{}; see lockwind-swarm --help", error.what()));
        return {std::nullopt, kExitUsage};
    }
    options.swarm.plant = find_plant(plant).value_or(Plant::none);
    options.workers.stop_at_failure = options.swarm.plant != Plant::none;
    return {options, kExitDone};
}

} // namespace lockwind::swarm
