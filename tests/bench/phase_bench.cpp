#include "bench_scene.h"
#include "measured_world.h"
#include "thread_clock.h"

#include "lockwind/phase_observer.h"

#include <benchmark/benchmark.h>
#include <string>
#include <vector>

// Where the time of a step goes: all phases of one run, so that their shares belong together.
namespace lockwind::bench {
namespace {

class PhaseClock final : public PhaseObserver {
public:
    PhaseClock() : seconds_(World::phases().size()) {}

    void begin_step() { last_ = thread_seconds(); }
    void after_phase(std::uint32_t phase) override {
        const double now = thread_seconds();
        seconds_[phase] += now - last_;
        last_ = now;
    }
    const std::vector<double>& seconds() const { return seconds_; }

private:
    std::vector<double> seconds_; // by phase, over all steps
    double last_ = 0;
};

/// A counter a phase, us a step; the iteration's time is their sum.
void time_phases(benchmark::State& state, const BenchScene& scene) {
    const WorldDefinition definition = load_bench_scene(scene);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        MeasuredWorld world(definition);
        PhaseClock clock;
        world.simulation().observe(&clock);
        for (std::uint32_t step = 0; step < scene.steps; ++step) {
            clock.begin_step();
            world.step();
        }
        if (!world.error().empty()) {
            state.SkipWithError(world.error().c_str());
            return;
        }
        double total = 0;
        for (std::size_t phase = 0; phase < clock.seconds().size(); ++phase) {
            const double mean = clock.seconds()[phase] / scene.steps;
            state.counters[std::string(World::phases()[phase]) + "_us"] = 1e6 * mean;
            total += mean;
        }
        state.SetIterationTime(total);
    }
}

} // namespace

void register_phase_benchmarks() {
    for (const BenchScene& scene : kBenchScenes) {
        const std::string name = std::string("phases/") + scene.name;
        benchmark::RegisterBenchmark(name.c_str(), &time_phases, scene)
            ->UseManualTime()
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
    }
}

} // namespace lockwind::bench
