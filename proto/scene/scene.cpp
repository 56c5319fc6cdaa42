#include "scene/scene.h"

#include "scene.pb.h"
#include "scene/body_reader.h"
#include "scene/field_reader.h"
#include "scene/joint_reader.h"
#include "scene/layer_reader.h"
#include "scene/settings_reader.h"
#include "scene/text_parser.h"

#include "lockwind/world.h"

#include <google/protobuf/text_format.h>

namespace lockwind {
namespace {

void read_name(const scene_text::Scene& scene, const FieldReader& reader, WorldDefinition& world) {
    constexpr std::size_t kNameSizeMax = 64;
    world.name = scene.name();
    if (world.name.empty()) {
        reader.fail("name", "is missing; begin the scene with one");
    } else if (world.name.size() > kNameSizeMax) {
        reader.fail("name", "is longer than 64 bytes");
    }
}

struct SceneContent {
    std::string description;
    WorldDefinition world;
};

Result<SceneContent>
read_scene(std::string_view text, std::string_view file_name, const SceneOptions& options) {
    SceneErrors errors(file_name);
    scene_text::Scene scene;
    google::protobuf::TextFormat::ParseInfoTree tree;
    if (!parse_scene_text(text, scene, tree, errors)) {
        return Error{errors.message()};
    }
    const FieldReader reader(scene, tree, errors);
    SceneContent content;
    content.description = scene.description();
    WorldDefinition& world = content.world;
    read_name(scene, reader, world);
    world.settings = read_settings(scene, reader, options);
    const LayerReader layers(scene, reader);
    world.settings.layer_masks = layers.masks();
    ShapeReader shapes(scene, reader, world);
    shapes.read_named();
    BodyReader bodies(scene, reader, layers, shapes, world);
    JointReader joints(scene, reader, world);
    for (int index = 0; index < scene.body_size() && !errors.any(); ++index) {
        const std::size_t first = world.bodies.size();
        bodies.read_body(index);
        joints.note_body(index, first, world.bodies.size() - first);
    }
    for (int index = 0; index < scene.joint_size() && !errors.any(); ++index) {
        joints.read_joint(index);
    }
    if (!errors.any()) {
        bodies.read_pods(options.players);
    }
    if (errors.any()) {
        return Error{errors.message()};
    }
    return content;
}

std::uint32_t count_dynamic(const std::vector<BodyDefinition>& bodies) {
    std::uint32_t count = 0;
    for (const BodyDefinition& body : bodies) {
        count += body.mode == BodyMode::dynamic ? 1U : 0U;
    }
    return count;
}

} // namespace

Result<WorldDefinition>
parse_scene(std::string_view text, std::string_view file_name, const SceneOptions& options) {
    Result<SceneContent> content = read_scene(text, file_name, options);
    if (!content) {
        return content.error();
    }
    return std::move(content).value().world;
}

Result<SceneReport> check_scene(std::string_view name_or_path) {
    const Result<std::string> text = load_scene_text(name_or_path);
    if (!text) {
        return text.error();
    }
    SceneOptions options;
    options.players = kEverySeat;
    const Result<SceneContent> content = read_scene(text.value(), name_or_path, options);
    if (!content) {
        return content.error();
    }
    const WorldDefinition& world = content.value().world;
    if (const Result<WorldPtr> created = World::create(world); !created) {
        return Error{std::string(name_or_path) + ": " + created.error().message};
    }
    const auto pods = static_cast<std::uint32_t>(world.pods.size());
    SceneReport report;
    report.name = world.name;
    report.description = content.value().description;
    report.bodies = static_cast<std::uint32_t>(world.bodies.size()) - pods;
    report.bodies_dynamic = count_dynamic(world.bodies) - pods;
    report.players_max = pods;
    report.tick_rate_hz = world.settings.tick_rate_hz;
    return report;
}

} // namespace lockwind
