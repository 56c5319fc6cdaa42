#include "bench_scene.h"
#include "measured_world.h"
#include "step_times.h"

#include <array>
#include <benchmark/benchmark.h>
#include <string>
#include <vector>

// What a rollback client pays for the worst misprediction: 8 ticks back, then 9 ticks anew.
namespace lockwind::bench {
namespace {

constexpr std::uint32_t kTicksAnew = 9;

/// The same nine ticks of a world, rolled back or stepped again and again: each iteration does the
/// same work, however long a scene takes to settle.
class NineTicks {
public:
    explicit NineTicks(MeasuredWorld& world) : world_(world) {
        world_.simulation().keep(before_);
        world_.step();
        world_.simulation().keep(first_);
    }

    double roll_back_seconds() {
        StepTimes times(1);
        times.measure([this] {
            world_.simulation().restore(first_);
            for (KeptState& kept : anew_) {
                world_.step();
                world_.simulation().keep(kept);
                benchmark::DoNotOptimize(world_.simulation().state_hash());
            }
        });
        return times.mean_seconds();
    }

    /// Of one step, without rolling back: a step before has filled the caches that a restore
    /// empties.
    double step_seconds() {
        world_.simulation().restore(before_);
        world_.step();
        StepTimes times(kTicksAnew);
        for (std::uint32_t tick = 0; tick < kTicksAnew; ++tick) {
            times.measure([this] { world_.step(); });
        }
        return times.mean_seconds();
    }

private:
    MeasuredWorld& world_;
    KeptState before_; // a tick before first_
    KeptState first_;  // where a rollback goes back to
    std::array<KeptState, kTicksAnew> anew_;
};

void roll_back(benchmark::State& state, const BenchScene& scene) {
    MeasuredWorld world(load_bench_scene(scene));
    world.run(scene.steps);
    NineTicks ticks(world);
    double rollback_seconds = 0;
    double step_seconds = 0;
    for (auto iteration : state) {
        static_cast<void>(iteration);
        step_seconds += ticks.step_seconds();
        const double seconds = ticks.roll_back_seconds();
        rollback_seconds += seconds;
        state.SetIterationTime(seconds);
    }
    if (!world.error().empty()) {
        state.SkipWithError(world.error().c_str());
        return;
    }
    state.counters["steps"] = rollback_seconds / step_seconds;
    state.counters["contacts"] = world.contact_count();
}

void register_rollback(const std::string& name, const BenchScene& scene) {
    benchmark::RegisterBenchmark(("rollback/" + name).c_str(), &roll_back, scene)
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
}

} // namespace

void register_rollback_benchmarks() {
    for (BenchScene scene : kBenchScenes) {
        scene.steps = kWarmUpSteps;
        register_rollback(scene.name, scene);
    }
    // The same boxes while they tumble and when they lie still; they do not sleep.
    register_rollback("boxes_200", {"heap_200", 90, 0});
    register_rollback("boxes_200_resting", {"heap_200", 1'200, 0});
}

} // namespace lockwind::bench
