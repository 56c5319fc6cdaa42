#pragma once

#include "lockwind/world_definition.h"

#include <array>
#include <cstdint>
#include <string>

namespace lockwind::bench {

/// A scene and how many steps make one measurement: those that the peers were measured with.
struct BenchScene {
    const char* name;
    std::uint32_t steps;
    std::uint32_t players; // whose pods circle and shoot; Bullet has none
};

inline constexpr std::array kBenchScenes{
    BenchScene{"box_grid_1000", 600, 0},
    BenchScene{"pyramid_210", 600, 0},
    BenchScene{"spheres_1000", 600, 0},
    BenchScene{"heap_1000", 400, 0},
    BenchScene{"heap_8000", 400, 0},
    BenchScene{"heap_hulls_1000", 400, 0},
    BenchScene{"arena", 600, 4},
};

/// All scenes have landed by then.
inline constexpr std::uint32_t kWarmUpSteps = 120;

/// Prints the message and ends the program with exit code 2.
[[noreturn]] void give_up(const std::string& message);

/// The scene's definition. Ends the program with a message where it cannot be loaded.
WorldDefinition load_bench_scene(const BenchScene& scene);

void register_step_benchmarks();
void register_phase_benchmarks();
void register_state_benchmarks();
void register_rollback_benchmarks();
void register_growth_benchmarks();

} // namespace lockwind::bench
