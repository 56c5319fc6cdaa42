#pragma once

#include "lockwind/result.h"
#include "lockwind/world_definition.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace lockwind {

/// SceneOptions::players for as many as the scene seats.
inline constexpr std::uint32_t kEverySeat = 0xffffffffU;

/// What a match adds to a scene's text.
struct SceneOptions {
    std::uint32_t players = 0;      // pods to seat; refused above the scene's players_max
    std::uint64_t seed = 1;         // WorldSettings::seed
    std::uint32_t tick_rate_hz = 0; // 0: the scene's own
};

/// Most bodies that a scene may define, arrangements and pods counted out.
inline constexpr std::uint32_t kSceneBodiesMax = 100'000;
inline constexpr std::uint32_t kScenePlayersMax = 64;
inline constexpr std::size_t kSceneTextSizeBytesMax = 16U << 20U;

/// Reads a scene (sim-core/scenes/README.md). Bodies get the ids 1, 2, 3 ... in the order of the
/// text, an arrangement's in its own order, the pods' last. An Error reads "file:line:column: field
/// ..."; `file_name` serves only that.
Result<WorldDefinition>
parse_scene(std::string_view text, std::string_view file_name, const SceneOptions& options = {});

/// Text of a built-in scene ("arena"; "heap_N" for any N), or else of the file at that path.
Result<std::string> load_scene_text(std::string_view name_or_path);

/// load_scene_text, then parse_scene.
Result<WorldDefinition> load_scene(std::string_view name_or_path, const SceneOptions& options = {});

struct BuiltInScene {
    std::string_view name;
    std::string_view text;
};

/// The scenes of sim-core/scenes, embedded at build, by name.
std::span<const BuiltInScene> built_in_scenes();

/// What a scene holds, for a person.
struct SceneReport {
    std::string name;
    std::string description;
    std::uint32_t bodies = 0; // without pods
    std::uint32_t bodies_dynamic = 0;
    std::uint32_t players_max = 0;
    std::uint32_t tick_rate_hz = 0;
};

/// Parses the scene with every seat taken and creates its world: an Error unless a match could run
/// it.
Result<SceneReport> check_scene(std::string_view name_or_path);

} // namespace lockwind
