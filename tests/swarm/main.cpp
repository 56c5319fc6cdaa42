#include "forensics/match_simulation.h"
#include "program/console.h"
#include "program/exit_code.h"
#include "program/progress.h"
#include "scene/scene.h"
#include "tests/support/temporary_folder.h"
#include "tests/swarm/options.h"
#include "tests/swarm/report.h"
#include "tests/swarm/scenario.h"
#include "tests/swarm/workers.h"

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>

namespace lockwind::swarm {

namespace {

void say_failures(const SeedResult& result, const SwarmOptions& options) {
    if (!result.failures.empty()) {
        say_error(fmt::format("seed {}: {}; replay: {}",
                              result.seed,
                              fmt::join(result.failures, "; "),
                              replay_command(result.seed, options)));
    }
}

/// In this process, so that a debugger sees it; with its timeline.
std::vector<SeedResult> run_one(const SwarmOptions& options) {
    SeedResult result = run_seed(options.workers.first_seed, options.swarm);
    for (const std::string& line : result.timeline) {
        fmt::print(stderr, "{}\n", line);
    }
    say_failures(result, options);
    return {result};
}

std::vector<SeedResult> run_all(const SwarmOptions& options) {
    Progress progress("seed", options.workers.seeds);
    std::uint64_t done = 0;
    return run_seeds(
        options.workers,
        [&](std::uint64_t seed) { return run_seed(seed, options.swarm); },
        [&](const SeedResult& result) {
            say_failures(result, options);
            progress.update(++done);
        });
}

/// Every number of players that a seed may draw fits the scene.
Status check_scene(const SwarmSettings& settings) {
    MatchConfig config =
        draw_scenario(1, settings.ticks, settings.scene_name, settings.scene_text).config;
    for (config.players = kClientsMin; config.players <= kClientsMax; ++config.players) {
        if (const auto simulation = create_match_simulation(config); !simulation) {
            return simulation.error();
        }
    }
    return Success{};
}

int run(SwarmOptions options) {
    Result<std::string> scene = load_scene_text(options.swarm.scene_name);
    if (!scene) {
        say_error(scene.error().message);
        return kExitFile;
    }
    options.swarm.scene_text = std::move(scene).value();
    if (const Status fits = check_scene(options.swarm); !fits) {
        say_error(fits.error().message);
        return kExitUsage;
    }
    // Memory, where there is such a folder: every tick is a write.
    const std::filesystem::path memory = "/dev/shm";
    const bool fast = ::access(memory.c_str(), W_OK) == 0;
    const testing::TemporaryFolder folder(fast ? memory : std::filesystem::temp_directory_path());
    options.swarm.folder = folder.file("");
    const SwarmReport report = sum_up(options.verbose ? run_one(options) : run_all(options));
    fmt::print("{}{}",
               options.json ? report_json(report, options) : report_text(report, options),
               options.json ? "\n" : "");
    return passed(report) ? kExitDone : kExitDiverged;
}

} // namespace

} // namespace lockwind::swarm

int main(int argc, char** argv) try {
    lockwind::set_up_messages();
    const lockwind::swarm::ParsedOptions parsed = lockwind::swarm::parse_options(argc, argv);
    return parsed.options ? lockwind::swarm::run(*parsed.options) : parsed.exit_code;
} catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return lockwind::kExitFile;
}
