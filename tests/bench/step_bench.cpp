#include "bench_scene.h"
#include "bullet_world.h"
#include "dynamics/contact.h"
#include "measured_world.h"

#include "lockwind/world.h"

#include <benchmark/benchmark.h>
#include <chrono>
#include <cstdio>
#include <string>

namespace lockwind::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

void set_counters(benchmark::State& state, double awake, double contacts, double penetration_mm) {
    state.counters["awake"] = awake;
    state.counters["contacts"] = contacts;
    state.counters["penetration_mm"] = penetration_mm;
}

/// One iteration: an untimed reset, then all steps; its time is their mean.
void step_lockwind(benchmark::State& state, const BenchScene& scene, Simd simd) {
    const WorldDefinition definition = load_bench_scene(scene);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        MeasuredWorld world(definition, simd);
        const auto begin = Clock::now();
        for (std::uint32_t step = 0; step < scene.steps; ++step) {
            world.step();
        }
        state.SetIterationTime(seconds_since(begin) / scene.steps);
        if (!world.error().empty()) {
            state.SkipWithError(world.error().c_str());
            return;
        }
        set_counters(state, world.awake_count(), world.contact_count(), world.penetration_mm());
        state.SetLabel("state_hash=" + world.hash_text());
    }
}

void step_bullet(benchmark::State& state, const BenchScene& scene) {
    const WorldDefinition definition = load_bench_scene(scene);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        BulletWorld world(definition);
        const auto begin = Clock::now();
        for (std::uint32_t step = 0; step < scene.steps; ++step) {
            world.step();
        }
        state.SetIterationTime(seconds_since(begin) / scene.steps);
        set_counters(state, world.awake_count(), world.contact_count(), world.penetration_mm());
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
