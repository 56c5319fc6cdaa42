#include "base/state_hash.h"
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

using Snapshot = std::vector<std::byte>;
using Ring = std::array<Snapshot, kRingSize>;

MeasuredWorld warm_world(const BenchScene& scene) {
    MeasuredWorld world(load_bench_scene(scene));
    world.run(kWarmUpSteps);
    return world;
}

/// Repeats `work` on a world that has `snapshot` as its state.
template <class Work>
void repeat(benchmark::State& state, const BenchScene& scene, Work&& work) {
    MeasuredWorld world = warm_world(scene);
    Snapshot snapshot;
    world.simulation().save(snapshot);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        work(world.simulation(), snapshot);
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(snapshot.size()));
    state.counters["snapshot_bytes"] = static_cast<double>(snapshot.size());
    state.counters["bodies"] = world.simulation().world().body_count();
}

/// The same with what the world keeps for itself. All of it counts as changed each time.
template <class Work>
void repeat_kept(benchmark::State& state, const BenchScene& scene, Work&& work) {
    MeasuredWorld world = warm_world(scene);
    static_cast<void>(world.simulation().world().section_bytes(0));
    KeptState kept;
    world.simulation().keep(kept);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        work(world.simulation(), kept);
    }
    state.counters["snapshot_bytes"] = static_cast<double>(kept.bytes.size());
}

void save_state(benchmark::State& state, const BenchScene& scene) {
    Ring ring;
    std::size_t next = 0;
    repeat(state, scene, [&](WorldSimulation& simulation, const Snapshot&) {
        simulation.save(ring[next]);
        next = (next + 1) % kRingSize;
    });
}

void keep_state(benchmark::State& state, const BenchScene& scene) {
    std::array<KeptState, kRingSize> ring;
    std::size_t next = 0;
    repeat_kept(state, scene, [&](WorldSimulation& simulation, const KeptState&) {
        simulation.keep(ring[next]);
        next = (next + 1) % kRingSize;
    });
}

/// The floor under keep_state and restore_state.
void copy_state(benchmark::State& state, const BenchScene& scene) {
    Ring ring;
    std::size_t next = 0;
    repeat_kept(state, scene, [&](WorldSimulation&, const KeptState& kept) {
        ring[next].resize(kept.bytes.size()); // the first nine times; as keep() does
        std::memcpy(ring[next].data(), kept.bytes.data(), kept.bytes.size());
        benchmark::ClobberMemory();
        next = (next + 1) % kRingSize;
    });
}

void load_state(benchmark::State& state, const BenchScene& scene) {
    std::string error;
    repeat(state, scene, [&](WorldSimulation& simulation, const Snapshot& snapshot) {
        const Status status = simulation.load(snapshot);
        if (!status) {
            error = status.error().message;
        }
    });
    if (!error.empty()) {
        state.SkipWithError(error.c_str());
    }
}

void restore_state(benchmark::State& state, const BenchScene& scene) {
    repeat_kept(state, scene, [](WorldSimulation& simulation, const KeptState& kept) {
        simulation.restore(kept);
    });
}

void hash_state(benchmark::State& state, const BenchScene& scene) {
    repeat_kept(state, scene, [](WorldSimulation& simulation, const KeptState&) {
        benchmark::DoNotOptimize(simulation.state_hash());
    });
}

/// The floor under hash_state: the same bytes in one go, without a tree.
void hash_bytes_at_once(benchmark::State& state, const BenchScene& scene) {
    repeat(state, scene, [](WorldSimulation&, const Snapshot& snapshot) {
        benchmark::DoNotOptimize(hash_bytes(snapshot));
    });
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
        register_state("keep", scene, &keep_state);
        register_state("restore", scene, &restore_state);
        register_state("hash", scene, &hash_state);
        register_state("memcpy", scene, &copy_state);
        register_state("xxh3", scene, &hash_bytes_at_once);
    }
}

} // namespace lockwind::bench
