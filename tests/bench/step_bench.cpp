#include "bench_scene.h"
#include "bullet_world.h"
#include "measured_world.h"
#include "step_times.h"

#include <benchmark/benchmark.h>
#include <string>

namespace lockwind::bench {
namespace {

/// All of the scene's steps; the iteration's time is their mean.
template <class World>
void run_steps(benchmark::State& state, const BenchScene& scene, World& world) {
    StepTimes times(scene.steps);
    for (std::uint32_t step = 0; step < scene.steps; ++step) {
        times.measure([&world] { world.step(); });
    }
    state.SetIterationTime(times.mean_seconds());
    state.counters["p50_us"] = times.percentile_us(50);
    state.counters["p99_us"] = times.percentile_us(99);
    state.counters["awake"] = world.awake_count();
    state.counters["contacts"] = world.contact_count();
    state.counters["penetration_mm"] = world.penetration_mm();
}

void step_lockwind(benchmark::State& state, const BenchScene& scene, Simd simd) {
    const WorldDefinition definition = load_bench_scene(scene);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        MeasuredWorld world(definition, simd);
        run_steps(state, scene, world);
        if (!world.error().empty()) {
            state.SkipWithError(world.error().c_str());
            return;
        }
        state.SetLabel("state_hash=" + world.hash_text());
    }
}

void step_bullet(benchmark::State& state, const BenchScene& scene) {
    const WorldDefinition definition = load_bench_scene(scene);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        BulletWorld world(definition);
        run_steps(state, scene, world);
    }
}

template <class Step, class... Arguments>
void register_step(const BenchScene& scene,
                   const std::string& engine,
                   Step step,
                   Arguments... arguments) {
    const std::string name = std::string("step/") + scene.name + "/" + engine;
    benchmark::RegisterBenchmark(name.c_str(), step, scene, arguments...)
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
}

} // namespace

void register_step_benchmarks() {
    for (const BenchScene& scene : kBenchScenes) {
        register_step(scene, "lockwind", &step_lockwind, best_simd());
        for (int index = 0; index < kSimdCount; ++index) {
            const auto simd = static_cast<Simd>(index);
            if (is_available(simd)) {
                register_step(
                    scene, std::string("lockwind_") + to_string(simd), &step_lockwind, simd);
            }
        }
        if (scene.players == 0) {
            register_step(scene, "bullet", &step_bullet);
        }
    }
}

} // namespace lockwind::bench
