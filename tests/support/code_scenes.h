#pragma once

#include "lockwind/player_input.h"
#include "lockwind/rng.h"
#include "lockwind/world.h"

#include <cstdint>
#include <vector>

// Scenes and inputs built in code, for tests that need a world but no scene file.
namespace lockwind::test {

/// Drawn for the `index`th body; a definition need not be a unit.
inline RealQuat random_orientation(std::uint64_t seed, std::uint64_t index) {
    return {random_symmetric(seed, index, 0),
            random_symmetric(seed, index, 1),
            random_symmetric(seed, index, 2),
            random_symmetric(seed, index, 3)};
}

/// A plane that holds everything with y >= 0 up.
inline BodyDefinition ground(BodyId id) {
    BodyDefinition body;
    body.id = id;
    body.mode = BodyMode::fixed;
    body.shape.type = ShapeType::plane;
    return body;
}

inline BodyDefinition box(BodyId id, const Vec3& position, const Vec3& half_extents) {
    BodyDefinition body;
    body.id = id;
    body.shape.type = ShapeType::box;
    body.shape.half_extents = half_extents;
    body.position = position;
    return body;
}

inline BodyDefinition sphere(BodyId id, const Vec3& position, Real radius) {
    BodyDefinition body;
    body.id = id;
    body.shape.type = ShapeType::sphere;
    body.shape.radius = radius;
    body.position = position;
    return body;
}

inline BodyDefinition capsule(BodyId id, const Vec3& position, Real radius, Real half_height) {
    BodyDefinition body;
    body.id = id;
    body.shape.type = ShapeType::capsule;
    body.shape.radius = radius;
    body.shape.half_height = half_height;
    body.position = position;
    return body;
}

/// A pod of the usual shape and its player.
inline void add_pod(WorldDefinition& definition, BodyId id, const Vec3& position) {
    BodyDefinition body = box(id, position, {0.5, 0.3, 0.7});
    body.density = 300;
    definition.bodies.push_back(body);
    PodDefinition pod;
    pod.body = id;
    definition.pods.push_back(pod);
}

/// Ground, four walls and a pile of `count` boxes, spheres and capsules that falls, `pods` pods
/// beside it.
inline WorldDefinition busy_scene(std::uint32_t count, std::uint32_t pods, std::uint64_t seed = 1) {
    WorldDefinition definition;
    definition.name = "busy";
    definition.settings.seed = seed;
    definition.settings.bounds = 100;
    definition.bodies.push_back(ground(1));
    const Vec3 walls[] = {{16, 1, 0}, {-16, 1, 0}, {0, 1, 16}, {0, 1, -16}};
    for (BodyId wall = 0; wall < 4; ++wall) {
        const bool along_x = wall >= 2;
        BodyDefinition body =
            box(2 + wall, walls[wall], along_x ? Vec3{16, 1, 0.5} : Vec3{0.5, 1, 16});
        body.mode = BodyMode::fixed;
        definition.bodies.push_back(body);
    }
    for (std::uint32_t index = 0; index < count; ++index) {
        const std::int64_t column = index % 8;
        const std::int64_t row = (index / 8) % 8;
        const std::int64_t layer = index / 64;
        const Vec3 jitter{random_symmetric(seed, index, 0) * Real(0.1),
                          0,
                          random_symmetric(seed, index, 1) * Real(0.1)};
        const Vec3 place{Real(column) * Real(1.5) - Real(5.25),
                         Real(layer) * Real(1.5) + Real(1),
                         Real(row) * Real(1.5) - Real(5.25)};
        const BodyId id = 100 + index;
        switch (index % 3) {
        case 0:
            definition.bodies.push_back(box(id, place + jitter, {0.4, 0.3, 0.5}));
            break;
        case 1:
            definition.bodies.push_back(sphere(id, place + jitter, 0.4));
            break;
        default:
            definition.bodies.push_back(capsule(id, place + jitter, 0.3, 0.3));
        }
        definition.bodies.back().restitution = index % 4 == 0 ? Real(0.5) : Real(0);
    }
    for (std::uint32_t slot = 0; slot < pods; ++slot) {
        const Vec3 corner{slot % 2 == 0 ? Real(10) : Real(-10),
                          0.5,
                          slot % 4 < 2 ? Real(10 + slot / 4) : Real(-10) - Real(slot / 4)};
        add_pod(definition, 10 + slot, corner);
    }
    return definition;
}

/// One joint of each kind between a fixed post and a body of its own, in motion; ids of bodies and
/// joints from `first` on.
inline void add_joints(WorldDefinition& definition, BodyId first, const Vec3& place) {
    constexpr std::uint32_t kKinds = static_cast<std::uint32_t>(JointKind::grab) + 1;
    BodyDefinition post = box(first, place, {4, 0.1, 0.1});
    post.mode = BodyMode::fixed;
    definition.bodies.push_back(post);
    for (std::uint32_t index = 0; index < kKinds; ++index) {
        const Real x = Real(index) - Real(3.5);
        BodyDefinition body = box(first + 1 + index, place + Vec3{x, -1, 0.3}, {0.2, 0.3, 0.15});
        body.linear_velocity = {0.5, 0, 1};
        body.angular_velocity = {1, 2, -1};
        definition.bodies.push_back(body);
        JointDefinition joint;
        joint.id = first + index;
        joint.kind = static_cast<JointKind>(index);
        joint.body_a = joint.kind == JointKind::grab ? 0 : first;
        joint.body_b = body.id;
        joint.anchor_a = {x, -0.5, 0.3};
        joint.anchor_b = {0, 0.5, 0};
        joint.frame_a = {0, 0, 0.6, 0.8};
        joint.frame_b = joint.frame_a;
        joint.target = place + Vec3{x, -0.5, 0.5};
        const bool has_axis = joint.kind == JointKind::hinge || joint.kind == JointKind::slider ||
                              joint.kind == JointKind::wheel;
        joint.has_limit =
            has_axis || joint.kind == JointKind::distance || joint.kind == JointKind::cone_twist;
        joint.length_min = joint.kind == JointKind::distance ? Real(0) : Real(-0.2);
        joint.length_max = 0.2;
        joint.angle_min = -0.2;
        joint.angle_max = 0.4;
        joint.swing_max = 0.5;
        joint.has_motor = has_axis;
        joint.motor_speed = 2;
        joint.motor_max = 30;
        joint.has_spring = has_axis || joint.kind == JointKind::distance ||
                           joint.kind == JointKind::fixed || joint.kind == JointKind::grab;
        joint.spring_hertz = 3;
        joint.spring_damping = 0.2;
        joint.rest_length = 0.1;
        joint.rest_angle = 0.1;
        joint.break_force = 100000;
        definition.joints.push_back(joint);
    }
}

/// A thin wall at `place`, thick ones 10 m to both sides of it, and between them two balls and a
/// rod of each collision mode that fly at them, and at each other, at 100 m/s; ids from `first` on.
inline void add_bullets(WorldDefinition& definition, BodyId first, const Vec3& place) {
    BodyDefinition wall = box(first, place, {0.05, 4, 8});
    wall.mode = BodyMode::fixed;
    definition.bodies.push_back(wall);
    for (const Real side : {Real(-10), Real(10)}) {
        BodyDefinition thick = box(++first, place + Vec3{side, 0, 0}, {2, 4, 8});
        thick.mode = BodyMode::fixed;
        definition.bodies.push_back(thick);
    }
    constexpr auto kModes = static_cast<std::uint32_t>(CollisionMode::speculative) + 1;
    for (std::uint32_t mode = 0; mode < kModes; ++mode) {
        const Vec3 start = place + Vec3{-6, 1, Real(mode) * Real(2) - Real(3)};
        for (std::uint32_t which = 0; which < 3; ++which) {
            const BodyId id = first + 1 + 3 * mode + which;
            BodyDefinition bullet =
                which == 0 ? box(id, start + Vec3{1, 1, 0}, {0.1, 0.4, 0.1})
                           : sphere(id, start + Vec3{Real(which) * Real(4), 0, 0}, 0.1);
            bullet.linear_velocity = {which == 2 ? Real(-100) : Real(100), 0, 0};
            bullet.angular_velocity = {0, 0, which == 0 ? Real(90) : Real(0)};
            bullet.collision_mode = static_cast<CollisionMode>(mode);
            bullet.restitution = 0.8;
            definition.bodies.push_back(bullet);
        }
    }
}

/// busy_scene with a joint of each kind and bullets above it; a wedge falls on the pile, and an
/// angle piece and a box on a mesh beside it.
inline WorldDefinition scene_of_all(std::uint32_t count, std::uint32_t pods) {
    WorldDefinition definition = busy_scene(count, pods);
    add_joints(definition, 10000, {0, 30, 0});
    add_bullets(definition, 30000, {0, 20, 0});
    definition.hulls = {
        {{{-0.5, 0, -0.5}, {0.5, 0, -0.5}, {0.5, 0, 0.5}, {-0.5, 0, 0.5}, {0, 0.8, 0}}}};
    BodyDefinition wedge;
    wedge.id = 20000;
    wedge.shape.type = ShapeType::hull;
    wedge.position = {0, 3, 0};
    definition.bodies.push_back(wedge);
    CompoundDefinition angle;
    angle.children.resize(2);
    for (CompoundChild& child : angle.children) {
        child.shape.type = ShapeType::box;
        child.shape.half_extents = {0.5, 0.15, 0.15};
    }
    angle.children[1].position = {0.35, 0.5, 0};
    angle.children[1].orientation = {0, 0, 0.6, 0.8};
    definition.compounds = {angle};
    definition.meshes = {{{{-2, 0.1, -2}, {-2, 0.1, 2}, {2, 0.3, 2}, {2, 0.1, -2}, {4, 0.4, 0}},
                          {0, 1, 2, 0, 2, 3, 3, 2, 4}}};
    BodyDefinition patch;
    patch.id = 20001;
    patch.mode = BodyMode::fixed;
    patch.shape.type = ShapeType::mesh;
    patch.position = {40, 0.5, 0};
    definition.bodies.push_back(patch);
    BodyDefinition piece;
    piece.id = 20002;
    piece.shape.type = ShapeType::compound;
    piece.position = {40, 1.2, 0};
    definition.bodies.push_back(piece);
    definition.bodies.push_back(box(20003, {41.5, 1.1, 0.5}, {0.3, 0.2, 0.25}));
    return definition;
}

/// The same with levels of detail, so near that scene_of_all with pods has bodies at each.
inline WorldDefinition with_levels(WorldDefinition definition) {
    definition.settings.level_of_detail = {true, 8, 25, 2};
    return definition;
}

/// Inputs of one tick: each player drives, turns, jumps and shoots by draws that change every 15
/// ticks.
inline std::vector<SlotInput> busy_inputs(Tick tick, std::uint32_t slots, std::uint64_t seed = 1) {
    std::vector<SlotInput> inputs(slots);
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
        const std::uint64_t draw = random_u64(seed ^ 0x1234U, slot, tick / 15);
        PlayerInput input;
        input.thrust = static_cast<std::int16_t>(draw & 0x7fffU);
        input.turn = static_cast<std::int16_t>((draw >> 16U) & 0xffffU);
        input.buttons = static_cast<std::uint16_t>((draw >> 32U) & 3U);
        inputs[slot].status = InputStatus::confirmed;
        encode(input, inputs[slot]);
    }
    return inputs;
}

inline std::vector<SlotInput> inputs_of(const std::vector<PlayerInput>& players) {
    std::vector<SlotInput> inputs(players.size());
    for (std::size_t slot = 0; slot < players.size(); ++slot) {
        inputs[slot].status = InputStatus::confirmed;
        encode(players[slot], inputs[slot]);
    }
    return inputs;
}

/// Asserts where the definition is refused.
inline WorldPtr make_world(const WorldDefinition& definition) {
    Result<WorldPtr> world = World::create(definition);
    if (!world) {
        assert_failed(world.error().message.c_str(), __FILE__, __LINE__);
    }
    return std::move(world).value();
}

/// Steps with busy inputs; asserts on a fault.
inline void step_busy(World& world) {
    const Status status = world.step(busy_inputs(world.tick() + 1, world.slot_count()));
    if (!status) {
        assert_failed(status.error().message.c_str(), __FILE__, __LINE__);
    }
}

/// Steps without players.
inline void step_idle(World& world, int ticks = 1) {
    const std::vector<SlotInput> inputs(world.slot_count());
    for (int tick = 0; tick < ticks; ++tick) {
        const Status status = world.step(inputs);
        if (!status) {
            assert_failed(status.error().message.c_str(), __FILE__, __LINE__);
        }
    }
}

/// Steps until nobody is awake; how many ticks that took, 0 where it took longer than `most`.
inline int ticks_till_asleep(World& world, int most) {
    for (int tick = 1; tick <= most; ++tick) {
        step_idle(world);
        if (world.counts().awake == 0) {
            return tick;
        }
    }
    return 0;
}

/// For messages and tolerances of tests only.
inline double to_double(Real value) {
    return static_cast<double>(value.raw()) / 4294967296.0;
}

} // namespace lockwind::test
