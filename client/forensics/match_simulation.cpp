#include "forensics/match_simulation.h"

#include "scene/scene.h"

namespace lockwind {

Result<std::unique_ptr<WorldSimulation>> create_match_simulation(const MatchConfig& config) {
    const SceneOptions options{config.players, config.seed, config.tick_rate_hz};
    const Result<WorldDefinition> definition =
        parse_scene(config.scene_text, config.scene_name, options);
    if (!definition) {
        return definition.error();
    }
    return WorldSimulation::create(definition.value());
}

} // namespace lockwind
