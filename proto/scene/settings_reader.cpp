#include "scene/settings_reader.h"

namespace lockwind {
namespace {

constexpr Range kTickRate{10, 240, "Hz"};
constexpr Range kCapacity{1, 1'000'000, ""};
constexpr Range kDetailDistance{1, 16'000, "m"};

LevelOfDetail read_level_of_detail(const FieldReader& settings) {
    LevelOfDetail detail;
    if (!settings.has("level_of_detail")) {
        return detail;
    }
    const FieldReader reader = settings.nested("level_of_detail");
    detail.enabled = true;
    detail.full_within = reader.real("full_within", detail.full_within, kDetailDistance);
    detail.simplified_within =
        reader.real("simplified_within", detail.simplified_within, kDetailDistance);
    detail.simplified_substeps =
        reader.count("simplified_substeps", detail.simplified_substeps, {1, 16, ""});
    if (detail.full_within > detail.simplified_within) {
        const bool is_given = reader.has("simplified_within");
        reader.fail(is_given ? "simplified_within" : "full_within",
                    is_given ? "is below full_within" : "is above simplified_within, 200 m");
    }
    return detail;
}

} // namespace

WorldSettings read_settings(const scene_text::Scene& scene,
                            const FieldReader& scene_reader,
                            const SceneOptions& options) {
    const FieldReader reader = scene_reader.nested("settings");
    WorldSettings settings;
    settings.tick_rate_hz = reader.count("tick_rate_hz", settings.tick_rate_hz, kTickRate);
    settings.substeps = reader.count("substeps", settings.substeps, {1, 16, ""});
    settings.gravity = reader.vector("gravity", settings.gravity, {-100, 100, "m/s^2"});
    settings.linear_speed_max =
        reader.real("linear_speed_max", settings.linear_speed_max, {1, 1000, "m/s"});
    settings.angular_speed_max =
        reader.real("angular_speed_max", settings.angular_speed_max, {1, 200, "rad/s"});
    settings.sleep_speed = reader.real("sleep_speed", settings.sleep_speed, {0, 10, "m/s"});
    settings.sleep_seconds = reader.real("sleep_seconds", settings.sleep_seconds, {0, 60, "s"});
    settings.bounds = reader.real("bounds", settings.bounds, {1, 16'000, "m"});
    settings.bounds_policy = static_cast<BoundsPolicy>(scene.settings().bounds_policy());
    settings.level_of_detail = read_level_of_detail(reader);
    settings.body_capacity = reader.count("body_capacity", 0, kCapacity);
    settings.pair_capacity = reader.count("pair_capacity", 0, kCapacity);
    settings.manifold_capacity = reader.count("manifold_capacity", 0, kCapacity);
    settings.joint_capacity = reader.count("joint_capacity", 0, kCapacity);
    settings.seed = options.seed;
    if (options.tick_rate_hz != 0) {
        settings.tick_rate_hz = options.tick_rate_hz;
    }
    return settings;
}

} // namespace lockwind
