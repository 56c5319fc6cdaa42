#include "bench_scene.h"
#include "scene/scene.h"

#include "lockwind/world_simulation.h"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lockwind::bench {

void give_up(const std::string& message) {
    std::fprintf(stderr, "lockwind-bench: %s\n", message.c_str());
    std::exit(2); // NOLINT(concurrency-mt-unsafe): there is one thread
}

WorldDefinition load_bench_scene(const BenchScene& scene) {
    SceneOptions options;
    options.players = scene.players;
    Result<WorldDefinition> definition = load_scene(scene.name, options);
    if (!definition) {
        give_up(definition.error().message);
    }
    return std::move(definition).value();
}

namespace {

/// Drops what the library appends to names ("/iterations:1/manual_time"): a name stays a name.
class BareNames : public benchmark::BenchmarkReporter {
public:
    explicit BareNames(std::unique_ptr<benchmark::BenchmarkReporter> reporter)
        : reporter_(std::move(reporter)) {}

    bool ReportContext(const Context& context) override {
        reporter_->SetOutputStream(&GetOutputStream()); // the library gave it to this one only
        reporter_->SetErrorStream(&GetErrorStream());
        return reporter_->ReportContext(context);
    }
    void ReportRuns(const std::vector<Run>& runs) override {
        std::vector<Run> bare = runs;
        for (Run& run : bare) {
            run.run_name.iterations.clear();
            run.run_name.time_type.clear();
        }
        reporter_->ReportRuns(bare);
    }
    void Finalize() override { reporter_->Finalize(); }

private:
    std::unique_ptr<benchmark::BenchmarkReporter> reporter_;
};

bool writes_file(int argc, char** argv) {
    constexpr std::string_view kFlag = "--benchmark_out=";
    return std::any_of(argv, argv + argc, [&](const char* argument) {
        return std::string_view(argument).substr(0, kFlag.size()) == kFlag;
    });
}

} // namespace
} // namespace lockwind::bench

int main(int argc, char** argv) {
    benchmark::AddCustomContext("sim_version", std::string(lockwind::sim_version()));
    benchmark::AddCustomContext("build_info", std::string(lockwind::build_info()));
    lockwind::bench::register_step_benchmarks();
    lockwind::bench::register_phase_benchmarks();
    lockwind::bench::register_state_benchmarks();
    lockwind::bench::register_rollback_benchmarks();
    lockwind::bench::register_growth_benchmarks();
    const bool to_file = lockwind::bench::writes_file(argc, argv);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
        return 2;
    }
    using lockwind::bench::BareNames;
    std::unique_ptr<benchmark::BenchmarkReporter> terminal(
        benchmark::CreateDefaultDisplayReporter());
    BareNames display(std::move(terminal));
    BareNames file(std::make_unique<benchmark::JSONReporter>());
    benchmark::RunSpecifiedBenchmarks(&display, to_file ? &file : nullptr);
    benchmark::Shutdown();
    return 0;
}
