#include "replay_command.h"

#include "bisect.h"
#include "forensics/match_simulation.h"
#include "forensics/replay.h"
#include "forensics/rerecord.h"
#include "forensics/snapshot_file.h"
#include "forensics/trace.h"
#include "program/console.h"
#include "program/exit_code.h"
#include "program/output_path.h"
#include "program/progress.h"

#include <fmt/format.h>
#include <optional>
#include <unistd.h>
#include <utility>

namespace lockwind {
namespace {

int fail(const std::string& message, int exit_code) {
    say_error(message);
    return exit_code;
}

Status
write_last_state(const std::string& path, const Party& party, const WorldSimulation& simulation) {
    Snapshot snapshot;
    snapshot.party = party;
    snapshot.tick = simulation.tick();
    snapshot.hash = simulation.state_hash();
    snapshot.schema = OwnedSchema(simulation.schema());
    simulation.save(snapshot.state);
    return write_snapshot(path, snapshot);
}

int replay_log(LogReader& log, const ReplayCommandOptions& options) {
    const MatchConfig& config = log.header().config;
    Result<std::unique_ptr<WorldSimulation>> simulation = create_match_simulation(config);
    if (!simulation) {
        return fail(options.log + ": its scene: " + simulation.error().message, kExitUsage);
    }
    const Party party{std::string(sim_version()), std::string(build_info()), config};
    std::optional<Result<TraceWriter>> trace;
    if (!options.trace.empty()) {
        trace.emplace(TraceWriter::create(
            options.trace, trace_header(*simulation.value(), party, options.trace_states)));
        if (!*trace) {
            return fail(trace->error().message, kExitFile);
        }
    }
    ReplayOptions replay_options;
    replay_options.verify = options.verify;
    replay_options.from = options.from;
    replay_options.to = options.to;
    replay_options.trace = trace ? &trace->value() : nullptr;
    replay_options.trace_states = options.trace_states;
    std::optional<Progress> progress;
    replay_options.progress = [&progress](Tick tick, Tick last) {
        if (!progress) {
            progress.emplace("replay", last);
        }
        progress->update(tick);
    };
    const Result<ReplayResult> result = replay(log, *simulation.value(), replay_options);
    progress.reset();
    if (!result) {
        return fail(result.error().message, kExitUsage);
    }
    Status written = trace ? trace->value().finish() : Status(Success{});
    if (written && !options.snapshot.empty()) {
        written = write_last_state(options.snapshot, party, *simulation.value());
    }
    if (!written) {
        return fail(written.error().message, kExitFile);
    }
    fmt::print("{}",
               options.json ? replay_json(result.value()) + "\n" : replay_text(result.value()));
    return replay_exit_code(result.value());
}

int rerecord_log(LogReader& log, const ReplayCommandOptions& options) {
    Result<std::unique_ptr<WorldSimulation>> simulation =
        create_match_simulation(log.header().config);
    if (!simulation) {
        return fail(options.log + ": its scene: " + simulation.error().message, kExitUsage);
    }
    const Result<RerecordResult> result = rerecord(log, *simulation.value(), options.rerecord);
    if (!result) {
        return fail(result.error().message, kExitFile);
    }
    fmt::print("{}",
               options.json ? rerecord_json(result.value()) + "\n" : rerecord_text(result.value()));
    return rerecord_exit_code(result.value());
}

} // namespace

int run_replay(const ReplayCommandOptions& options) {
    for (const auto& [flag, path] : {std::pair{"--trace", &options.trace},
                                     std::pair{"--snapshot", &options.snapshot},
                                     std::pair{"--rerecord", &options.rerecord}}) {
        if (const auto trouble = output_path_trouble(flag, *path, Existing::refused)) {
            return *trouble;
        }
    }
    if (!options.trace.empty() && options.trace == options.snapshot) {
        return fail("--trace and --snapshot name the same file", kExitUsage);
    }
    if (!options.bisect.empty() && access(options.bisect.c_str(), X_OK) != 0) {
        return fail(fmt::format("--bisect {}: no program", options.bisect), kExitFile);
    }
    Result<LogReader> log = LogReader::open(options.log);
    if (!log) {
        return fail(log.error().message, kExitFile);
    }
    if (options.from && options.to && *options.to < *options.from) {
        return fail(fmt::format("--to {} is before --from {}", *options.to, *options.from),
                    kExitUsage);
    }
    if (const std::string& logged = log.value().header().sim_version; logged != sim_version()) {
        return fail(fmt::format("{}: recorded by sim_version {}, but this program is {}; replay it "
                                "with the program that recorded it",
                                options.log,
                                logged,
                                sim_version()),
                    kExitUsage);
    }
    if (!options.rerecord.empty()) {
        return rerecord_log(log.value(), options);
    }
    return options.bisect.empty() ? replay_log(log.value(), options) : run_bisect(options);
}

} // namespace lockwind
