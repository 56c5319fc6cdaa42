#pragma once

#include "lockwind/level_of_detail.h"
#include "lockwind/shape.h"
#include "lockwind/types.h"
#include "lockwind/vector.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lockwind {

inline constexpr std::uint32_t kWorldTickRateHzMin = 10;
inline constexpr std::uint32_t kWorldTickRateHzMax = 240;

enum class BodyMode : std::uint8_t { fixed = 0, kinematic = 1, dynamic = 2 };

/// How two bodies' values become the pair's. Where their rules differ, the later one counts.
enum class CombineRule : std::uint8_t {
    average = 0,
    geometric_mean = 1,
    minimum = 2,
    multiply = 3,
    maximum = 4,
};

/// What a dynamic body meets on its way within a tick; at the ticks' ends all meet all.
enum class CollisionMode : std::uint8_t {
    discrete = 0,    // nothing: faster than its size a tick it may pass through what is thin
    swept = 1,       // what does not move, and kinematic bodies: its way ends at the first touch
    continuous = 2,  // dynamic bodies too, whose ways then end there as well
    speculative = 3, // all: the solver stops it before it gets there, and it keeps the rest of its
                     // tick; but also what it would just have missed
};

/// Groups of bodies that meet or pass through each other.
inline constexpr std::uint32_t kLayerCount = 32;
inline constexpr std::uint32_t kAllLayers = 0xffffffffU;

struct BodyDefinition {
    BodyId id = 0; // 1 .. 2^32 - 1, unique
    BodyMode mode = BodyMode::dynamic;
    ShapeDefinition shape;
    Vec3 position;         // m, of the shape's origin
    RealQuat orientation;  // x y z w; normalised on creation, must not be 0
    Vec3 linear_velocity;  // m/s, of the centre of mass
    Vec3 angular_velocity; // rad/s
    Real density = 1000.0; // kg/m^3; used where mass is 0
    Real mass = 0.0;       // kg; overrides density where > 0
    Real friction = 0.5;   // Coulomb
    Real restitution = 0.0;
    Vec3 surface_velocity; // m/s, in the body's frame: what its surface does to others, as a belt's
    CombineRule friction_rule = CombineRule::geometric_mean;
    CombineRule restitution_rule = CombineRule::maximum;
    std::uint32_t layer = 0;         // below kLayerCount
    std::uint32_t mask = kAllLayers; // bit L: meets bodies of layer L whose masks agree
    bool sensor = false;             // tells which dynamic bodies overlap it, and stops nothing
    CollisionMode collision_mode = CollisionMode::discrete;
    std::uint32_t substeps = 0; // 1 .. 16 a tick of its island's; 0: the settings'
    bool can_sleep = true;      // false keeps what it touches awake too
};

enum class JointKind : std::uint8_t {
    ball = 0,       // one point in common
    distance = 1,   // anchors between two distances apart, or on a spring, or a rod
    hinge = 2,      // one axis in common; limit, motor, spring about it
    slider = 3,     // no turn; limit, motor, spring along the axis
    fixed = 4,      // no motion; a spring makes it soft
    wheel = 5,      // suspension along the axis, spin about a second one with a motor
    cone_twist = 6, // a ball whose axes stay within a cone, and within a twist about them
    grab = 7,       // a spring from a place in the world: the mouse, a gravity gun
};

/// What a kind has no use for is left as it is here.
struct JointDefinition {
    JointId id = 0; // 1 .. 2^32 - 1, unique among joints
    JointKind kind = JointKind::ball;
    BodyId body_a = 0; // 0 for a grab, which has one body only
    BodyId body_b = 0;
    /// In each body's frame, m; a distance is measured between them, all others bring them
    /// together.
    Vec3 anchor_a;
    Vec3 anchor_b;
    /// The joint's frame in each body's: x is the axis of hinge, slider, suspension and cone; a
    /// wheel spins about z. The turn from A's to B's is what limits and springs measure.
    RealQuat frame_a;
    RealQuat frame_b;
    bool collide_connected = false; // whether the two bodies collide with each other

    bool has_limit = false;
    Real length_min = 0; // m: distance; travel of slider and wheel
    Real length_max = 0;
    Real angle_min = 0; // rad, -pi .. pi: hinge; twist of a cone_twist
    Real angle_max = 0;
    Real swing_max = 0; // rad, 0 .. pi: half the cone's opening

    bool has_motor = false;
    Real motor_speed = 0; // m/s of a slider, rad/s of hinge and wheel
    Real motor_max = 0;   // N of slider and grab, N m of hinge and wheel

    bool has_spring = false; // a grab always has one
    Real spring_hertz = 5;   // of the two bodies against each other while the joint holds
    Real spring_damping = 1; // damping ratio: 1 is critical
    Real rest_length = 0;    // m, where the spring is slack
    Real rest_angle = 0;     // rad

    Real break_force = 0;  // N, mean of a tick; 0 for never
    Real break_torque = 0; // N m
    Vec3 target;           // m: where a grab draws its anchor
};

/// A player-controlled body: thrust along its +z, turn about y, jump, shoot a ball.
struct PodDefinition {
    BodyId body = 0; // a dynamic body of the definition; pods are seated in slot order
    Real thrust_acceleration = 25.0; // m/s^2 at full stick
    Real speed_max = 12.0;           // m/s, thrust fades to 0 there
    Real turn_rate = 3.0;            // rad/s at full stick
    Real jump_speed = 5.0;           // m/s
    Real ball_radius = 0.2;          // m
    Real ball_density = 400.0;       // kg/m^3
    Real ball_speed = 20.0;          // m/s, relative to the pod
    std::uint32_t ball_cooldown_ticks = 10;
    std::uint32_t ball_lifetime_ticks = 180;
};

/// What becomes of a body that moves out of the bounds.
enum class BoundsPolicy : std::uint8_t {
    destroy = 0, // it is destroyed; a pod is put back at its start
    wrap = 1,    // it goes on from the opposite side, alone: a joint draws it back across the world
    error = 2,   // the step fails and names it
};

constexpr std::array<std::uint32_t, kLayerCount> all_layers() {
    std::array<std::uint32_t, kLayerCount> masks{};
    masks.fill(kAllLayers);
    return masks;
}

struct WorldSettings {
    std::uint32_t tick_rate_hz = 60; // kWorldTickRateHzMin .. kWorldTickRateHzMax
    std::uint32_t substeps = 4;      // 1 .. 16
    Vec3 gravity{0, -9.81, 0};       // m/s^2
    Real linear_speed_max = 400.0;   // m/s
    Real angular_speed_max = 100.0;  // rad/s
    Real sleep_speed = 0.05;         // m/s, of any point of a body that counts as still
    Real sleep_seconds = 0.5;        // still for so long, an island sleeps; 0: none ever does
    Real bounds = 1000.0;            // m from the origin, on each axis
    BoundsPolicy bounds_policy = BoundsPolicy::destroy;
    LevelOfDetail level_of_detail;
    std::uint64_t seed = 1;
    /// By layer, the layers that its bodies meet; both must agree.
    std::array<std::uint32_t, kLayerCount> layer_masks = all_layers();
    // Capacities; 0 derives one from the bodies of the scene.
    std::uint32_t body_capacity = 0;
    std::uint32_t pair_capacity = 0;
    std::uint32_t manifold_capacity = 0;
    std::uint32_t joint_capacity = 0;
};

struct WorldDefinition {
    std::string name;
    WorldSettings settings;
    // What ShapeDefinition::hull, compound, height_field and mesh count.
    std::vector<HullDefinition> hulls;
    std::vector<CompoundDefinition> compounds;
    std::vector<HeightFieldDefinition> height_fields;
    std::vector<MeshDefinition> meshes;
    std::vector<BodyDefinition> bodies;
    std::vector<JointDefinition> joints;
    std::vector<PodDefinition> pods; // slot s controls pods[s]
};

} // namespace lockwind
