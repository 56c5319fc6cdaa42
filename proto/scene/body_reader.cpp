#include "scene/body_reader.h"

#include "scene/scene.h"

namespace lockwind {
namespace {

constexpr Range kSurfaceSpeed{-100, 100, "m/s"};
constexpr Range kMass{0.001, 1e6, "kg"};
constexpr Range kDensity{0.01, 1e5, "kg/m^3"};
constexpr Range kFriction{0, 4, ""};
constexpr Range kRestitution{0, 1, ""};
constexpr Range kPitch{0.01, 1000, "m"};
constexpr Range kDraws{0, 4294967295.0, ""};
constexpr std::uint32_t kDrawsDefault = 12345;

/// For ranges and messages only: no value of the world passes through it.
double to_double(Real value) {
    return static_cast<double>(value.raw()) / static_cast<double>(Real(1).raw());
}

Range within(Real limit, std::string_view unit) {
    return {-to_double(limit), to_double(limit), unit};
}

bool is_zero(const Vec3& v) {
    return v == Vec3{};
}

bool inside(Real value, Real bound) {
    return -bound <= value && value <= bound;
}

/// The text's rules are those of the core, one further.
CombineRule rule_of(scene_text::CombineRule rule, CombineRule fallback) {
    return rule == scene_text::given ? fallback : static_cast<CombineRule>(rule - 1);
}

bool is_arranged(const scene_text::Body& body) {
    return body.arrangement_case() != scene_text::Body::ARRANGEMENT_NOT_SET;
}

} // namespace

BodyReader::BodyReader(const scene_text::Scene& scene,
                       const FieldReader& reader,
                       const LayerReader& layers,
                       const ShapeReader& shapes,
                       WorldDefinition& world)
    : scene_(scene), reader_(reader), layers_(layers), shapes_(shapes), world_(world) {}

void BodyReader::read_body(int index) {
    const scene_text::Body& body = scene_.body(index);
    const FieldReader reader = reader_.nested("body", index);
    const BodyDefinition definition = read_common(body, reader);
    if (!is_arranged(body)) {
        if (room_for(1, reader)) {
            append(definition, {{}, definition.orientation}, reader);
        }
        return;
    }
    for (Placement& place : read_arrangement(body, reader)) {
        if (!body.has_heap()) {
            place.orientation = definition.orientation;
        }
        append(definition, place, reader);
    }
}

void BodyReader::read_pods(std::uint32_t players) {
    if (!scene_.has_pods()) {
        if (players > 0 && players != kEverySeat) {
            reader_.fail("",
                         "the scene seats no player: it has no `pods`, but " +
                             std::to_string(players) + " are to be seated");
        }
        return;
    }
    const FieldReader reader = reader_.nested("pods");
    const std::uint32_t players_max =
        reader.count("players_max", 0, {1, static_cast<double>(kScenePlayersMax), "players"});
    const Real radius = reader.real("ring_radius", 1, {0.01, 1000, "m"});
    const PodDefinition pod = read_pod(reader);
    const FieldReader body_reader = reader.nested("body");
    const scene_text::Body& body = scene_.pods().body();
    const BodyDefinition definition = read_common(body, body_reader);
    if (is_arranged(body) || body.turn_case() != scene_text::Body::TURN_NOT_SET) {
        body_reader.fail("", "is placed and turned by the ring: it has no arrangement or turn");
    }
    if (definition.mode != BodyMode::dynamic) {
        body_reader.fail("mode", "must be dynamic: a pod is driven by forces");
    }
    if (players == kEverySeat) {
        players = players_max;
    } else if (players > players_max) {
        reader.fail("players_max",
                    "is " + std::to_string(players_max) + ", but " + std::to_string(players) +
                        " players are to be seated");
        return;
    }
    for (const Placement& place : arrange_ring(players, radius)) {
        append(definition, place, body_reader);
        world_.pods.push_back(pod);
        world_.pods.back().body = world_.bodies.back().id;
    }
}

BodyDefinition BodyReader::read_common(const scene_text::Body& body,
                                       const FieldReader& reader) const {
    BodyDefinition definition;
    switch (body.mode()) {
    case scene_text::Body::fixed:
        definition.mode = BodyMode::fixed;
        break;
    case scene_text::Body::kinematic:
        definition.mode = BodyMode::kinematic;
        break;
    default:
        definition.mode = BodyMode::dynamic;
        break;
    }
    read_motion(reader, definition);
    definition.orientation = read_turn(reader);
    if (body.has_heap() && body.turn_case() != scene_text::Body::TURN_NOT_SET) {
        reader.fail("heap", "draws its bodies' orientations; leave out the body's own");
    }
    shapes_.read_shape(body, reader, definition.mode == BodyMode::fixed, definition.shape);
    read_matter(body, reader, definition);
    definition.surface_velocity = reader.vector("surface_velocity", {}, kSurfaceSpeed);
    definition.layer = layers_.read_layer(body.layer(), reader);
    definition.mask = layers_.read_mask(body.ignores(), reader);
    definition.sensor = body.sensor();
    definition.collision_mode = static_cast<CollisionMode>(body.collision_mode());
    definition.substeps = reader.count("substeps", 0, {1, 16, ""});
    definition.can_sleep = !body.has_can_sleep() || body.can_sleep();
    return definition;
}

void BodyReader::read_motion(const FieldReader& reader, BodyDefinition& definition) const {
    const WorldSettings& settings = world_.settings;
    definition.position = reader.vector("position", {}, within(settings.bounds, "m"));
    definition.linear_velocity =
        reader.vector("linear_velocity", {}, within(settings.linear_speed_max, "m/s"));
    definition.angular_velocity =
        reader.vector("angular_velocity", {}, within(settings.angular_speed_max, "rad/s"));
    const bool moves =
        !is_zero(definition.linear_velocity) || !is_zero(definition.angular_velocity);
    if (definition.mode == BodyMode::fixed && moves) {
        reader.fail("mode", "is fixed, but the body has a velocity; make it kinematic or dynamic");
    }
}

void BodyReader::read_matter(const scene_text::Body& body,
                             const FieldReader& reader,
                             BodyDefinition& definition) const {
    const auto read_from = [&definition](const auto& message, const FieldReader& source) {
        definition.density = source.real("density", definition.density, kDensity);
        definition.friction = source.real("friction", definition.friction, kFriction);
        definition.restitution = source.real("restitution", definition.restitution, kRestitution);
        definition.friction_rule = rule_of(message.friction_rule(), definition.friction_rule);
        definition.restitution_rule =
            rule_of(message.restitution_rule(), definition.restitution_rule);
    };
    bool known = body.material().empty();
    std::string names;
    for (int index = 0; index < scene_.material_size(); ++index) {
        const std::string& name = scene_.material(index).name();
        if (!known && name == body.material()) {
            read_from(scene_.material(index), reader_.nested("material", index));
            known = true;
        }
        names += (index == 0 ? "" : ", ") + name;
    }
    if (!known) {
        reader.fail("material",
                    "\"" + body.material() + "\" is not defined; " +
                        (names.empty() ? "the scene has no materials" : "there is: " + names));
    }
    read_from(body, reader);
    if (reader.has("mass") && reader.has("density")) {
        reader.fail("mass", "and density are both given; give one");
    }
    definition.mass = reader.real("mass", 0, kMass);
    check_mass(reader, definition);
}

void BodyReader::check_mass(const FieldReader& reader, const BodyDefinition& definition) const {
    if (definition.mode != BodyMode::dynamic || definition.mass > Real(0)) {
        return;
    }
    if (reader.failed()) {
        return; // what it names may not be there
    }
    const double mass = to_double(shapes_.mass(definition.shape, definition.density));
    if (mass < kMass.min || mass > kMass.max) {
        const std::string kilograms = text_of(mass, 3) + " kg";
        const std::string limits = "; a dynamic body weighs 0.001 .. 1000000 kg";
        if (reader.has("density")) {
            reader.fail("density", "makes the body weigh " + kilograms + limits);
        } else {
            reader.fail("", "weighs " + kilograms + " by its density" + limits);
        }
    }
}

std::vector<Placement> BodyReader::read_arrangement(const scene_text::Body& body,
                                                    const FieldReader& reader) const {
    constexpr Range kCount{1, static_cast<double>(kSceneBodiesMax), "bodies"};
    if (body.has_grid()) {
        const FieldReader grid = reader.nested("grid");
        const FieldReader count = grid.nested("count");
        GridLayout layout;
        layout.count = {
            count.count("x", 1, kCount), count.count("y", 1, kCount), count.count("z", 1, kCount)};
        layout.pitch = grid.vector("pitch", {}, kPitch);
        layout.jitter = grid.real("jitter", 0, {0, 1000, "m"});
        layout.draws = grid.count("draws", kDrawsDefault, kDraws);
        if (!grid.has("count") || !grid.has("pitch")) {
            grid.fail("", "needs a count and a pitch, x y z each");
        }
        const auto [x, y, z] = layout.count;
        return room_for(std::uint64_t{x} * y, grid) && room_for(std::uint64_t{x} * y * z, grid)
                   ? arrange_grid(layout)
                   : std::vector<Placement>{};
    }
    if (body.has_pyramid()) {
        const FieldReader pyramid = reader.nested("pyramid");
        const std::uint32_t base = pyramid.count("base", 1, kCount);
        const Real pitch_x = pyramid.real("pitch_x", 1, kPitch);
        const Real pitch_y = pyramid.real("pitch_y", 1, kPitch);
        return room_for(std::uint64_t{base} * (base + 1) / 2, pyramid)
                   ? arrange_pyramid(base, pitch_x, pitch_y)
                   : std::vector<Placement>{};
    }
    const FieldReader heap = reader.nested("heap");
    HeapLayout layout;
    layout.count = heap.count("count", 1, kCount);
    layout.pitch = heap.real("pitch", 1, kPitch);
    layout.draws = heap.count("draws", kDrawsDefault, kDraws);
    return room_for(layout.count, heap) ? arrange_heap(layout) : std::vector<Placement>{};
}

bool BodyReader::room_for(std::uint64_t count, const FieldReader& reader) const {
    if (world_.bodies.size() + count <= kSceneBodiesMax) {
        return true;
    }
    reader.fail("", "makes more than " + std::to_string(kSceneBodiesMax) + " bodies in all");
    return false;
}

void BodyReader::append(const BodyDefinition& definition,
                        const Placement& place,
                        const FieldReader& reader) {
    BodyDefinition body = definition;
    body.id = world_.bodies.size() + 1;
    body.position = definition.position + place.offset;
    body.orientation = place.orientation;
    const Real bounds = world_.settings.bounds;
    if (!inside(body.position.x, bounds) || !inside(body.position.y, bounds) ||
        !inside(body.position.z, bounds)) {
        reader.fail("", "puts bodies outside settings.bounds");
    }
    world_.bodies.push_back(body);
}

PodDefinition BodyReader::read_pod(const FieldReader& reader) const {
    constexpr Range kTicks{1, 100'000, "ticks"};
    constexpr Range kSpeed{0, 200, "m/s"};
    PodDefinition pod;
    pod.thrust_acceleration =
        reader.real("thrust_acceleration", pod.thrust_acceleration, {0, 1000, "m/s^2"});
    pod.speed_max = reader.real("speed_max", pod.speed_max, {0.1, 200, "m/s"});
    pod.turn_rate = reader.real("turn_rate", pod.turn_rate, {0, 50, "rad/s"});
    pod.jump_speed = reader.real("jump_speed", pod.jump_speed, kSpeed);
    pod.ball_radius = reader.real("ball_radius", pod.ball_radius, {0.01, 10, "m"});
    pod.ball_density = reader.real("ball_density", pod.ball_density, kDensity);
    pod.ball_speed = reader.real("ball_speed", pod.ball_speed, kSpeed);
    pod.ball_cooldown_ticks = reader.count("ball_cooldown_ticks", pod.ball_cooldown_ticks, kTicks);
    pod.ball_lifetime_ticks = reader.count("ball_lifetime_ticks", pod.ball_lifetime_ticks, kTicks);
    return pod;
}

} // namespace lockwind
