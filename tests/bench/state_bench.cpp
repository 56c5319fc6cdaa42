#include "bench_scene.h"
#include "measured_world.h"

#include <array>
#include <benchmark/benchmark.h>
#include <cstring>
#include <string>
#include <vector>

namespace lockwind::bench {
namespace {

constexpr std::size_t kRingSize = 9;
constexpr std::uint32_t kWarmUpSteps = 120; // all scenes have landed by then

using Snapshot = std::vector<std::byte>;
using Ring = std::array<Snapshot, kRingSize>;

MeasuredWorld warm_world(const BenchScene& scene) {
    MeasuredWorld world(load_bench_scene(scene));
    for (std::uint32_t step = 0; step < kWarmUpSteps; ++step) {
        world.step();
    }
    return world;
}

void set_bytes(benchmark::State& state, std::size_t size_bytes) {
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(size_bytes));
    state.counters["snapshot_bytes"] = static_cast<double>(size_bytes);
}

void save_state(benchmark::State& state, const BenchScene& scene) {
    MeasuredWorld world = warm_world(scene);
    Ring ring;
    std::size_t next = 0;
    for (auto iteration : state) {
        static_cast<void>(iteration);
        world.simulation().save(ring[next]);
        next = (next + 1) % kRingSize;
    }
    set_bytes(state, ring[0].size());
}

void copy_state(benchmark::State& state, const BenchScene& scene) {
    Snapshot from;
    warm_world(scene).simulation().save(from);
    Ring ring;
    ring.fill(from);
    std::size_t next = 0;
    for (auto iteration : state) {
        static_cast<void>(iteration);
        std::memcpy(ring[next].data(), from.data(), from.size());
        benchmark::ClobberMemory();
        next = (next + 1) % kRingSize;
    }
    set_bytes(state, from.size());
}

void load_state(benchmark::State& state, const BenchScene& scene) {
    MeasuredWorld world = warm_world(scene);
    Snapshot snapshot;
    world.simulation().save(snapshot);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        const Status status = world.simulation().load(snapshot);
        if (!status) {
            state.SkipWithError(status.error().message.c_str());
            return;
        }
    }
    set_bytes(state, snapshot.size());
}

void restore_state(benchmark::State& state, const BenchScene& scene) {
    MeasuredWorld world = warm_world(scene);
    Snapshot snapshot;
    world.simulation().save(snapshot);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        world.simulation().restore(snapshot);
    }
    set_bytes(state, snapshot.size());
}

void hash_state(benchmark::State& state, const BenchScene& scene) {
    MeasuredWorld world = warm_world(scene);
    Snapshot snapshot;
    world.simulation().save(snapshot);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        benchmark::DoNotOptimize(world.simulation().state_hash());
    }
    set_bytes(state, snapshot.size());
}

/// What a rollback client pays for the worst misprediction: 8 ticks back, then 9 ticks anew.
void roll_back(benchmark::State& state, const BenchScene& scene) {
    MeasuredWorld world = warm_world(scene);
    Ring ring; // the last nine states; `oldest` is 8 ticks back
    for (Snapshot& snapshot : ring) {
        world.step();
        world.simulation().save(snapshot);
    }
    std::size_t oldest = 0;
    for (auto iteration : state) {
        static_cast<void>(iteration);
        world.simulation().restore(ring[oldest]);
        for (std::size_t tick = 1; tick <= kRingSize; ++tick) {
            world.step();
            world.simulation().save(ring[(oldest + tick) % kRingSize]);
            benchmark::DoNotOptimize(world.simulation().state_hash());
        }
        oldest = (oldest + 1) % kRingSize;
    }
    if (!world.error().empty()) {
        state.SkipWithError(world.error().c_str());
    }
}

using StateFunction = void (*)(benchmark::State&, const BenchScene&);

void register_state(const char* what, const BenchScene& scene, StateFunction function) {
    const std::string name = std::string(what) + "/" + scene.name;
    benchmark::RegisterBenchmark(name.c_str(), function, scene)->Unit(benchmark::kMicrosecond);
}

} // namespace

void register_state_benchmarks() {
    for (const BenchScene& scene : kBenchScenes) {
        register_state("save", scene, &save_state);
        register_state("load", scene, &load_state);
        register_state("restore", scene, &restore_state);
        register_state("hash", scene, &hash_state);
        register_state("memcpy", scene, &copy_state);
        register_state("rollback", scene, &roll_back);
    }
}

} // namespace lockwind::bench
