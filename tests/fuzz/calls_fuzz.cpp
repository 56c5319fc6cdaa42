#include "tests/fuzz/fuzz_target.h"
#include "tests/support/code_scenes.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <limits>
#include <vector>

// Calls of the world's interface in any order, with any values: refused with a message, or the
// state stays one that check() takes. Unlike forged states these must not trap a checked build.

namespace lockwind {
namespace {

constexpr int kCallsMax = 200;
constexpr int kStepsMax = 240;
constexpr BodyId kIds = 40; // few, so that calls meet what others made

/// Draws from the input; zeros behind its end.
class Draws {
public:
    explicit Draws(std::span<const std::byte> bytes) : bytes_(bytes) {}

    bool at_end() const { return next_ >= bytes_.size(); }
    std::uint8_t byte() {
        return at_end() ? std::uint8_t{0} : static_cast<std::uint8_t>(bytes_[next_++]);
    }
    std::uint32_t below(std::uint32_t bound) { return byte() % bound; }
    bool flag() { return (byte() & 1U) != 0; }
    std::uint64_t word() {
        std::uint64_t word = 0;
        for (int index = 0; index < 8; ++index) {
            word = word << 8U | byte();
        }
        return word;
    }
    /// Most definitions are tame: of values that a world takes. The others have extreme ones too.
    void begin_definition() { is_tame_ = byte() % 8 != 0; }
    bool is_tame() const { return is_tame_; }
    Real real() {
        const std::uint8_t kind = is_tame_ ? std::uint8_t{5} : byte();
        const auto fine = Real::from_raw(std::int64_t{static_cast<std::int8_t>(byte())} << 27);
        switch (kind % 16) {
        case 0:
            return Real::from_raw(static_cast<std::int64_t>(word()));
        case 1:
            return flag() ? Real::highest()
                          : Real::from_raw(std::numeric_limits<std::int64_t>::min());
        case 2:
            return Real::from_raw(flag() ? 1 : -1);
        case 3:
            return fine * 256;
        case 4:
            return 0;
        default:
            return fine; // -4 .. 4 by 1/32
        }
    }
    Real positive() {
        const Real value = real();
        return value < 0 && value != Real::from_raw(std::numeric_limits<std::int64_t>::min())
                   ? -value
                   : value;
    }
    Vec3 vector() { return {real(), real(), real()}; }
    RealQuat turn() { return {real(), real(), real(), real()}; }

private:
    std::span<const std::byte> bytes_;
    std::size_t next_ = 0;
    bool is_tame_ = true;
};

ShapeDefinition draw_shape(Draws& draws) {
    constexpr ShapeType kBounded[] = {ShapeType::sphere,
                                      ShapeType::capsule,
                                      ShapeType::box,
                                      ShapeType::hull,
                                      ShapeType::compound,
                                      ShapeType::height_field,
                                      ShapeType::mesh};
    const Real least = draws.is_tame() ? Real(0.05) : Real(0);
    ShapeDefinition shape;
    // A wild one has a type that there is not.
    shape.type =
        draws.is_tame() ? kBounded[draws.below(7)] : static_cast<ShapeType>(draws.below(10));
    shape.half_extents = {
        draws.positive() + least, draws.positive() + least, draws.positive() + least};
    shape.radius = draws.positive() + least;
    shape.half_height = draws.positive() + least;
    shape.hull = draws.is_tame() ? 0 : draws.below(4);
    shape.compound = draws.is_tame() ? 0 : draws.below(4);
    shape.height_field = draws.is_tame() ? 0 : draws.below(2);
    shape.mesh = draws.is_tame() ? 0 : draws.below(4);
    return shape;
}

BodyDefinition draw_body(Draws& draws) {
    BodyDefinition body;
    draws.begin_definition();
    body.id = draws.below(kIds);
    body.mode = static_cast<BodyMode>(draws.below(draws.is_tame() ? 3 : 4));
    body.shape = draw_shape(draws);
    body.position = draws.vector();
    body.orientation = draws.turn();
    if (body.mode != BodyMode::fixed || !draws.is_tame()) {
        body.linear_velocity = draws.vector();
        body.angular_velocity = draws.vector();
    }
    if (draws.flag()) {
        body.mass = draws.positive();
        body.friction = draws.positive();
        body.restitution = draws.is_tame() ? Real(draws.below(2)) : draws.positive();
        body.surface_velocity = draws.vector();
        body.friction_rule = static_cast<CombineRule>(draws.below(draws.is_tame() ? 5 : 6));
        body.layer = draws.below(draws.is_tame() ? 32 : 33);
        body.mask = static_cast<std::uint32_t>(draws.word());
        body.sensor = draws.flag();
        body.can_sleep = draws.flag();
        body.collision_mode = static_cast<CollisionMode>(draws.below(draws.is_tame() ? 4 : 5));
        body.substeps = draws.below(4) == 0 ? draws.below(draws.is_tame() ? 17 : 40) : 0;
    }
    return body;
}

JointDefinition draw_joint(Draws& draws, const World& world) {
    JointDefinition joint;
    draws.begin_definition();
    const auto body = [&] {
        return draws.is_tame() ? world.body_at(draws.below(world.body_count())).id
                               : draws.below(kIds);
    };
    joint.id = draws.below(kIds);
    joint.kind = static_cast<JointKind>(draws.below(draws.is_tame() ? 8 : 9));
    joint.body_a = joint.kind == JointKind::grab && draws.is_tame() ? 0 : body();
    joint.body_b = body();
    joint.anchor_a = draws.vector();
    joint.anchor_b = draws.vector();
    joint.frame_a = draws.turn();
    joint.frame_b = draws.turn();
    joint.collide_connected = draws.flag();
    const bool has_axis = joint.kind == JointKind::hinge || joint.kind == JointKind::slider ||
                          joint.kind == JointKind::wheel;
    const bool is_long = joint.kind == JointKind::distance;
    const bool takes_all = !draws.is_tame() || has_axis;
    joint.has_limit = (takes_all || is_long || joint.kind == JointKind::cone_twist) && draws.flag();
    joint.has_motor = takes_all && draws.flag();
    joint.has_spring = (takes_all || is_long || joint.kind == JointKind::fixed) && draws.flag();
    const auto limits = [&](Real& low, Real& high, Real most) {
        low = draws.real();
        high = draws.real();
        if (draws.is_tame()) {
            low = std::clamp(low, is_long ? Real(0) : -most, most);
            high = std::clamp(high, low, most);
        }
    };
    limits(joint.length_min, joint.length_max, 10);
    limits(joint.angle_min, joint.angle_max, 3);
    joint.swing_max = draws.is_tame() ? draws.positive() / 2 : draws.positive();
    joint.motor_speed = draws.real();
    joint.motor_max = draws.is_tame() ? draws.positive() * 100 : draws.positive();
    joint.spring_hertz = draws.positive() + (draws.is_tame() ? Real(0.1) : Real(0));
    joint.spring_damping = draws.positive();
    joint.rest_length = draws.is_tame() ? draws.positive() : draws.real();
    joint.rest_angle = draws.is_tame() ? draws.real() / 2 : draws.real();
    joint.break_force = draws.is_tame() ? draws.positive() * 100 : draws.positive();
    joint.break_torque = draws.is_tame() ? draws.positive() * 100 : draws.positive();
    joint.target = draws.vector();
    return joint;
}

WorldDefinition draw_world(Draws& draws) {
    WorldDefinition definition = test::scene_of_all(4, 1);
    definition.settings.body_capacity = 64;
    definition.settings.joint_capacity = 32;
    definition.settings.bounds_policy = static_cast<BoundsPolicy>(draws.below(3));
    definition.settings.level_of_detail = {draws.flag(), 2, 5, 2};
    draws.begin_definition();
    for (std::uint32_t hull = draws.below(3); hull > 0; --hull) {
        HullDefinition points;
        for (std::uint32_t point = (draws.is_tame() ? 8 : 0) + draws.below(24); point > 0;
             --point) {
            points.points.push_back(draws.vector());
        }
        definition.hulls.push_back(points);
    }
    for (std::uint32_t compound = draws.below(2); compound > 0; --compound) {
        CompoundDefinition parts;
        for (std::uint32_t child = draws.below(5); child > 0; --child) {
            parts.children.push_back(
                {draw_shape(draws), draws.vector(), draws.turn(), draws.positive()});
        }
        definition.compounds.push_back(parts);
    }
    for (std::uint32_t field = draws.below(2); field > 0; --field) {
        HeightFieldDefinition ground;
        ground.columns = (draws.is_tame() ? 2 : 0) + draws.below(4);
        ground.rows = (draws.is_tame() ? 2 : 0) + draws.below(4);
        ground.spacing_x = draws.positive() + (draws.is_tame() ? Real(0.1) : Real(0));
        ground.spacing_z = draws.positive() + (draws.is_tame() ? Real(0.1) : Real(0));
        ground.heights.resize(ground.columns * ground.rows + (draws.is_tame() ? 0 : 1));
        for (Real& height : ground.heights) {
            height = draws.real();
        }
        if (draws.flag()) {
            ground.holes.push_back(draws.below(draws.is_tame() ? 1 : 20));
        }
        definition.height_fields.push_back(ground);
    }
    for (std::uint32_t mesh = draws.below(2); mesh > 0; --mesh) {
        MeshDefinition triangles;
        for (std::uint32_t vertex = 3 + draws.below(6); vertex > 0; --vertex) {
            triangles.vertices.push_back(draws.vector());
        }
        for (std::uint32_t index = 3 * (1 + draws.below(4)); index > 0; --index) {
            triangles.indices.push_back(draws.below(draws.is_tame() ? 3 : 10));
        }
        definition.meshes.push_back(triangles);
    }
    return definition;
}

void require_message(const Status& status) {
    LOCKWIND_ASSERT(status.ok() || !status.error().message.empty());
}

class Caller {
public:
    Caller(Draws& draws, World& world) : draws_(draws), world_(world) {}

    /// False where the world can go on no further.
    bool call() {
        const std::uint32_t kind = draws_.below(16);
        switch (kind) {
        case 0:
            require_message(world_.create_body(draw_body(draws_)));
            return true;
        case 1:
            require_message(world_.create_joint(draw_joint(draws_, world_)));
            return true;
        case 2:
            world_.destroy_body(draws_.below(kIds));
            return true;
        case 3:
            world_.destroy_joint(draws_.below(kIds));
            return true;
        case 4:
            return push();
        case 5:
            draws_.begin_definition();
            world_.set_joint_target(draws_.below(kIds), draws_.vector());
            world_.set_joint_motor(draws_.below(kIds), draws_.real());
            return true;
        case 6:
            return keep_or_return();
        case 7:
            return look();
        case 8:
            world_.drop_derived();
            return true;
        case 9:
            require_message(world_.redefine_body(draw_redefinition()));
            return true;
        default:
            return step(1 + kind % 4);
        }
    }

private:
    /// Of a body that there is, in half of all cases of its own shape.
    BodyDefinition draw_redefinition() {
        BodyDefinition definition = draw_body(draws_);
        const BodyView view = world_.body_at(draws_.below(world_.body_count()));
        definition.id = view.id;
        if (draws_.flag()) {
            definition.shape = view.shape;
        }
        return definition;
    }
    bool push() {
        draws_.begin_definition();
        const BodyId id = draws_.below(kIds);
        world_.apply_impulse(id, draws_.vector(), draws_.vector());
        world_.apply_force(id, draws_.vector(), draws_.vector());
        world_.apply_torque(id, draws_.vector());
        if (draws_.flag()) {
            world_.set_velocity(id, draws_.vector(), draws_.vector());
        }
        return true;
    }
    bool keep_or_return() {
        const bool returns = draws_.flag() && !kept_.empty();
        if (!returns) {
            world_.save(kept_);
            return true;
        }
        LOCKWIND_ASSERT(world_.load(kept_).ok());
        std::vector<std::byte> again;
        world_.save(again);
        LOCKWIND_ASSERT(again == kept_);
        return true;
    }
    bool look() {
        for (const FastBody& fast : world_.fast_bodies()) {
            LOCKWIND_ASSERT(2 * fast.way > fast.size && fast.size > 0);
        }
        for (const ContactView& contact : world_.contacts()) {
            LOCKWIND_ASSERT(contact.body_a < contact.body_b && contact.point_count > 0);
        }
        draws_.begin_definition();
        QueryFilter filter;
        filter.layers = static_cast<std::uint32_t>(draws_.word());
        filter.sensors = draws_.flag();
        filter.ignore = draws_.below(kIds);
        const Vec3 from = draws_.vector();
        const Vec3 to = draws_.vector();
        const std::vector<RayHit> all = world_.ray_cast_all(from, to, filter);
        const std::optional<RayHit> first = world_.ray_cast(from, to, filter);
        LOCKWIND_ASSERT(first.has_value() == !all.empty() && (all.empty() || *first == all[0]));
        world_.closest_point(from, draws_.real(), filter);
        const ShapeDefinition shape = draw_shape(draws_);
        if (!world_.check_query_shape(shape)) {
            return true;
        }
        const RealQuat turn = draws_.turn();
        const std::vector<BodyId> overlapping = world_.overlap(shape, from, turn, filter);
        const auto hit = world_.shape_cast(shape, from, turn, to, filter);
        const auto is_far = [](Real coordinate) {
            return coordinate > Real(65536) || coordinate < -Real(65536);
        };
        LOCKWIND_ASSERT(is_far(to.x) || is_far(to.y) || is_far(to.z) || overlapping.empty() ||
                        (hit.has_value() && hit->fraction == Real(0)));
        return true;
    }
    bool step(std::uint32_t count) {
        for (std::uint32_t index = 0; index < count && steps_ < kStepsMax; ++index, ++steps_) {
            const std::vector<SlotInput> inputs =
                test::busy_inputs(world_.tick() + 1, world_.slot_count());
            if (const Status stepped = world_.step(inputs); !stepped) {
                require_message(stepped);
                return false;
            }
        }
        return true;
    }

    Draws& draws_;
    World& world_;
    std::vector<std::byte> kept_;
    int steps_ = 0;
};

} // namespace
} // namespace lockwind

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lockwind;
    Draws draws(fuzz::bytes_of(data, size));
    const Result<WorldPtr> world = World::create(draw_world(draws));
    if (!world.ok()) {
        LOCKWIND_ASSERT(!world.error().message.empty());
        return 0;
    }
    Caller caller(draws, *world.value());
    for (int call = 0; call < kCallsMax && !draws.at_end(); ++call) {
        if (!caller.call()) {
            break;
        }
        const Status sound = world.value()->check();
        LOCKWIND_ASSERT(sound.ok());
    }
    return 0;
}
