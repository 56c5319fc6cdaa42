#include "tests/swarm/report.h"

#include "log/log_format.h"
#include "tests/swarm/digest.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <utility>

namespace lockwind::swarm {

SwarmReport sum_up(const std::vector<SeedResult>& results) {
    SwarmReport report;
    Digest digest;
    for (const SeedResult& result : results) {
        ++report.seeds;
        report.total += result.figures;
        digest.add(result.digest);
        if (!result.failures.empty()) {
            ++report.failures;
            report.first_failing_seed = report.first_failing_seed.value_or(result.seed);
        }
    }
    report.digest = digest.value();
    const SwarmFigures& total = report.total;
    const std::pair<const char*, std::uint64_t> wanted[] = {
        {"contacts", total.contacts},
        {"drops", total.drops},
        {"reconnects", total.reconnects},
        {"stalls", total.stalls},
        {"late joins", total.late_joins},
        {"partitions", total.partitions},
        {"kills", total.kills},
        {"packets lost", total.packets_lost},
        {"packets duplicated", total.packets_duplicated},
        {"packets reordered", total.packets_reordered},
        {"substituted inputs", total.substituted_inputs},
    };
    for (const auto& [name, count] : wanted) {
        if (report.seeds >= kSeedsForVacuity && count == 0) {
            report.vacuous.emplace_back(name);
        }
    }
    return report;
}

bool passed(const SwarmReport& report) {
    return report.failures == 0 && report.vacuous.empty();
}

std::string replay_command(std::uint64_t seed, const SwarmOptions& options) {
    const SwarmSettings defaults;
    std::string command = fmt::format("lockwind-swarm --first {} --seeds 1", seed);
    if (options.swarm.ticks != defaults.ticks) {
        command += fmt::format(" --ticks {}", options.swarm.ticks);
    }
    if (options.swarm.scene_name != defaults.scene_name) {
        command += fmt::format(" --scene {}", options.swarm.scene_name);
    }
    if (options.swarm.plant != Plant::none) {
        command += fmt::format(" --plant {}", to_string(options.swarm.plant));
    }
    return command;
}

std::string report_text(const SwarmReport& report, const SwarmOptions& options) {
    const SwarmFigures& total = report.total;
    std::string text = fmt::format(
        "seeds      {} from {}, of {} ticks each: {} failed\n"
        "played     {} ticks ({} s), {} contacts, {} hashes agreed on\n"
        "faults     {} partitions ({} of one way), {} kills, {} leaves, {} freezes, {} storms\n"
        "network    packets: {} lost, {} duplicated, {} reordered\n"
        "players    {} joins ({} late), {} drops, {} reconnects, {} stalls\n"
        "inputs     {} substituted, {} late\n"
        "digest     {}\n",
        report.seeds,
        options.workers.first_seed,
        options.swarm.ticks,
        report.failures,
        total.ticks,
        total.virtual_us / 1'000'000,
        total.contacts,
        total.hashes_agreed,
        total.partitions,
        total.one_way_partitions,
        total.kills,
        total.leaves,
        total.freezes,
        total.storms,
        total.packets_lost,
        total.packets_duplicated,
        total.packets_reordered,
        total.joins,
        total.late_joins,
        total.drops,
        total.reconnects,
        total.stalls,
        total.substituted_inputs,
        total.late_inputs,
        hash_text(report.digest));
    for (const std::string& name : report.vacuous) {
        text += fmt::format("vacuous    {} seeds saw no {}\n", report.seeds, name);
    }
    if (report.first_failing_seed) {
        text += fmt::format("first      {} --verbose\n",
                            replay_command(*report.first_failing_seed, options));
    }
    return text;
}

std::string report_json(const SwarmReport& report, const SwarmOptions& options) {
    const SwarmFigures& total = report.total;
    nlohmann::ordered_json first_failing_seed = nullptr;
    if (report.first_failing_seed) {
        first_failing_seed = *report.first_failing_seed;
    }
    // Lock-step predicts nothing: rollbacks and mispredictions belong to another mode.
    const nlohmann::ordered_json object{
        {"seeds", report.seeds},
        {"first_seed", options.workers.first_seed},
        {"ticks", total.ticks},
        {"failures", report.failures},
        {"first_failing_seed", first_failing_seed},
        {"vacuous", report.vacuous},
        {"contacts", total.contacts},
        {"rollbacks", 0},
        {"mispredictions", 0},
        {"joins", total.joins},
        {"late_joins", total.late_joins},
        {"drops", total.drops},
        {"reconnects", total.reconnects},
        {"stalls", total.stalls},
        {"substituted_inputs", total.substituted_inputs},
        {"late_inputs", total.late_inputs},
        {"hashes_agreed", total.hashes_agreed},
        {"partitions", total.partitions},
        {"one_way_partitions", total.one_way_partitions},
        {"kills", total.kills},
        {"leaves", total.leaves},
        {"freezes", total.freezes},
        {"storms", total.storms},
        {"packets_lost", total.packets_lost},
        {"packets_duplicated", total.packets_duplicated},
        {"packets_reordered", total.packets_reordered},
        {"digest", hash_text(report.digest)},
    };
    return object.dump();
}

} // namespace lockwind::swarm
