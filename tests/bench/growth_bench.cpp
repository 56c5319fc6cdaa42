#include "bench_scene.h"
#include "measured_world.h"
#include "step_times.h"

#include <array>
#include <benchmark/benchmark.h>
#include <cstdint>
#include <string>

// How the time of a step grows with bodies that do not touch, and what sleeping ones cost: to step,
// and to keep and hash.
namespace lockwind::bench {
namespace {

constexpr std::uint32_t kSide = 250; // bodies in a row

BodyDefinition unit_box(BodyId id, const Vec3& position) {
    BodyDefinition body;
    body.id = id;
    body.shape.type = ShapeType::box;
    body.shape.half_extents = {0.5, 0.5, 0.5};
    body.position = position;
    return body;
}

/// Boxes 3 m apart, in rows of kSide.
void add_boxes(WorldDefinition& scene, std::uint32_t count, Real height) {
    for (std::uint32_t index = 0; index < count; ++index) {
        const Real x = Real(3) * Real(index % kSide) - Real(400);
        const Real z = Real(3) * Real(index / kSide) - Real(400);
        scene.bodies.push_back(unit_box(index + 2, {x, height, z}));
    }
}

/// Boxes that drift side by side and never meet.
WorldDefinition separate_scene(std::uint32_t count) {
    WorldDefinition scene;
    scene.settings.gravity = {0, 0, 0};
    scene.settings.sleep_seconds = 0;
    add_boxes(scene, count, 0);
    for (BodyDefinition& body : scene.bodies) {
        body.linear_velocity.x = 2;
    }
    return scene;
}

/// Boxes that lie on the ground.
WorldDefinition resting_scene(std::uint32_t count, bool sleeps) {
    WorldDefinition scene;
    if (!sleeps) {
        scene.settings.sleep_seconds = 0;
    }
    BodyDefinition ground;
    ground.id = 1;
    ground.mode = BodyMode::fixed;
    ground.shape.type = ShapeType::plane;
    scene.bodies.push_back(ground);
    add_boxes(scene, count, 0.5);
    return scene;
}

void step_scene(benchmark::State& state, const WorldDefinition& scene) {
    MeasuredWorld world(scene);
    world.run(kWarmUpSteps);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        world.step();
    }
    if (!world.error().empty()) {
        state.SkipWithError(world.error().c_str());
    }
    state.counters["bodies"] = world.simulation().world().body_count();
    state.counters["awake"] = world.simulation().world().counts().awake;
}

/// What a step leaves to keep and to hash, in a ring as a rollback has one.
void keep_and_hash(benchmark::State& state, const WorldDefinition& scene) {
    MeasuredWorld world(scene);
    world.run(kWarmUpSteps);
    std::array<KeptState, 9> ring;
    std::size_t next = 0;
    for (auto iteration : state) {
        static_cast<void>(iteration);
        world.step();
        StepTimes times(1);
        times.measure([&] {
            world.simulation().keep(ring[next]);
            benchmark::DoNotOptimize(world.simulation().state_hash());
        });
        next = (next + 1) % ring.size();
        state.SetIterationTime(times.mean_seconds());
    }
    state.counters["awake"] = world.simulation().world().counts().awake;
}

/// 1,000 boxes on the ground; the first of them sleep.
WorldDefinition partly_asleep_scene(std::uint32_t asleep) {
    WorldDefinition scene = resting_scene(1000, true);
    for (std::size_t box = 1 + std::size_t{asleep}; box < scene.bodies.size(); ++box) {
        scene.bodies[box].can_sleep = false;
    }
    return scene;
}

void register_growth(const std::string& name, WorldDefinition (*make)(std::uint32_t), int count) {
    const std::string full = "growth/" + name + "_" + std::to_string(count);
    benchmark::RegisterBenchmark(full.c_str(), [make, count](benchmark::State& state) {
        step_scene(state, make(static_cast<std::uint32_t>(count)));
    })->Unit(benchmark::kMillisecond);
}

} // namespace

void register_growth_benchmarks() {
    for (const std::uint32_t asleep : {0U, 900U}) {
        const std::string name = "keep_and_hash/asleep_" + std::to_string(asleep) + "_of_1000";
        benchmark::RegisterBenchmark(name.c_str(),
                                     [asleep](benchmark::State& state) {
                                         keep_and_hash(state, partly_asleep_scene(asleep));
                                     })
            ->UseManualTime()
            ->Unit(benchmark::kMicrosecond);
    }
    for (const int count : {1'000, 10'000, 50'000}) {
        register_growth("separate", &separate_scene, count);
        register_growth(
            "resting_awake",
            [](std::uint32_t bodies) { return resting_scene(bodies, false); },
            count);
        register_growth(
            "resting_asleep",
            [](std::uint32_t bodies) { return resting_scene(bodies, true); },
            count);
    }
}

} // namespace lockwind::bench
