#pragma once

#include "lockwind/ccd.h"
#include "lockwind/event.h"
#include "lockwind/kept_state.h"
#include "lockwind/query.h"
#include "lockwind/result.h"
#include "lockwind/schema.h"
#include "lockwind/simd.h"
#include "lockwind/world_definition.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace lockwind {

class PhaseObserver;
struct SlotInput;
struct HashTree;

/// A body as a reader sees it; exact, at the API's scale.
struct BodyView {
    BodyId id;
    BodyMode mode;
    ShapeDefinition shape;
    Vec3 position; // m
    RealQuat orientation;
    Vec3 linear_velocity;  // m/s
    Vec3 angular_velocity; // rad/s
    Real mass;             // kg; 0 unless dynamic
    bool asleep;           // fixed bodies are, and kinematic ones that do not move
    BodyLevel level;
};

struct JointView {
    JointId id;
    JointKind kind;
    BodyId body_a; // 0 of a grab
    BodyId body_b;
    Real motor_speed; // m/s or rad/s
    Vec3 target;      // m, of a grab
};

/// What two bodies press on each other, since contact_begin until contact_end. Bodies that are made
/// of parts have one for each two parts that touch, in the order of their numbers; their events are
/// told once for all of them.
struct ContactView {
    struct Point {
        Vec3 position;     // m, halfway between the surfaces
        Real separation;   // m; negative where they overlap
        Real normal_force; // N, mean of the last substep; 0 of a sensor
    };
    BodyId body_a; // below body_b
    BodyId body_b;
    std::uint32_t part_a; // child of a compound, triangle of a surface; 0 of any other shape
    std::uint32_t part_b;
    bool sensor;
    Vec3 normal; // unit, from a to b
    std::uint32_t point_count;
    std::array<Point, 4> points; // those past point_count are 0
};

/// Counts of a state, for progress, metrics and the vacuity checks of tests.
struct WorldCounts {
    std::uint32_t bodies;
    std::uint32_t awake;    // dynamic bodies that are
    std::uint32_t pairs;    // overlapping fat bounds
    std::uint32_t contacts; // contact points in touching manifolds
    std::uint32_t manifolds;
    std::uint32_t joints;
    std::uint64_t events_total;    // since state(0)
    std::uint64_t created_total;   // bodies created in ticks since state(0)
    std::uint64_t destroyed_total; // bodies destroyed in ticks since state(0)
};

class World;
using WorldPtr = std::unique_ptr<World>;

/// A deterministic rigid-body world. Same definition, same inputs: the same bits everywhere.
class World {
public:
    /// An Error names the body and field that is wrong. `simd` is available, see simd.h; it changes
    /// no bit.
    static Result<WorldPtr> create(const WorldDefinition& definition, Simd simd = best_simd());
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    std::uint32_t slot_count() const;
    Tick tick() const;
    /// One input per slot. No allocation. An Error (a capacity ran out) names what to raise; final.
    Status step(std::span<const SlotInput> inputs, PhaseObserver* observer = nullptr);
    static std::span<const std::string_view> phases();

    /// Events of the last step, in order; none after a load. A body that is destroyed ends its
    /// contacts without a contact_end.
    std::span<const Event> events() const;
    /// Chain of XXH3-64 over all events since state(0); part of the state.
    std::uint64_t event_hash() const;
    WorldCounts counts() const;
    std::uint32_t body_count() const;
    BodyView body_at(BodyRow row) const; // id order
    std::optional<BodyView> body(BodyId id) const;
    /// The body that slot's pod is; nothing where it is gone.
    std::optional<BodyView> pod(Slot slot) const;
    std::uint32_t score(Slot slot) const;
    /// Touching pairs as the last step left them, those of sensors too, by (body_a, body_b).
    std::vector<ContactView> contacts() const;
    /// Dynamic bodies that are fast for their size, by id, whatever their mode.
    std::vector<FastBody> fast_bodies() const;

    /// Between steps, all immediate; SI units, world frame. False where there is no such dynamic
    /// body. None of these makes events.
    bool apply_impulse(BodyId id, const Vec3& impulse, const Vec3& point); // N s, at point
    bool apply_force(BodyId id, const Vec3& force, const Vec3& point);     // N over the next tick
    bool apply_torque(BodyId id, const Vec3& torque);                      // N m over the next tick
    /// m/s and rad/s, each axis held to the settings' limits and to what a step turns a body by at
    /// most, 200 m/s at its gyration radius; steers kinematic bodies, too, and ends no contact.
    /// False where there is no body that moves.
    bool set_velocity(BodyId id, const Vec3& linear, const Vec3& angular);
    /// An id that was ever used must not come back: only living bodies and pods are checked.
    Status create_body(const BodyDefinition& definition);
    bool destroy_body(BodyId id); // and its joints
    /// Makes a body anew from a definition with its id and shape, joints kept: hands a kinematic
    /// body over to the solver and back, or changes its place, mass, material or layer. What it
    /// touches begins anew. Not of pods, nor of balls that they shot. An Error changes nothing.
    Status redefine_body(const BodyDefinition& definition);

    /// Between steps, as the calls above. An id that was ever used must not come back.
    Status create_joint(const JointDefinition& definition);
    bool destroy_joint(JointId id);
    std::optional<JointView> joint(JointId id) const;
    /// Where a grab draws its anchor, m; held to 30 km. False where there is no such grab.
    bool set_joint_target(JointId id, const Vec3& target);
    /// m/s or rad/s, held to 1000. False where there is no such joint with a motor.
    bool set_joint_motor(JointId id, Real speed);

    /// Queries: of the bodies as they stand, in fixed point; they change no bit of the state. Ties
    /// go to the lower id. Each visits few bodies, by a tree of bounds that the first query after a
    /// change builds: so no two threads may query one world at once. Coordinates beyond 65,536 m
    /// find nothing. A world that is moved as a whole finds the same bits relative to itself.
    ///
    /// First hit on the segment from + t * (to - from); none of a body it starts in, nor without
    /// length.
    std::optional<RayHit>
    ray_cast(const Vec3& from, const Vec3& to, const QueryFilter& filter = {}) const;
    /// The first hit of each body on it, by fraction, then id.
    std::vector<RayHit>
    ray_cast_all(const Vec3& from, const Vec3& to, const QueryFilter& filter = {}) const;
    /// Whether overlap and shape_cast take a shape: any convex one that a kinematic body may have.
    /// The Error says why not; they assert it.
    Status check_query_shape(const ShapeDefinition& shape) const;
    /// Bodies that touch or overlap a shape (error 2 um), by id.
    std::vector<BodyId> overlap(const ShapeDefinition& shape,
                                const Vec3& position,
                                const RealQuat& orientation,
                                const QueryFilter& filter = {}) const;
    /// Nearest body within distance_max, m; a body that the point lies in is at 0. Error 2 um, and
    /// 2^-26 of the distance and size where these are beyond 128 m.
    std::optional<ClosestPoint>
    closest_point(const Vec3& point, Real distance_max, const QueryFilter& filter = {}) const;
    /// First body that the shape, moved along `translation` without turning, comes within 15 um of
    /// while nearing it; moved by the fraction, it overlaps nothing. Bodies that it overlaps at the
    /// start count at fraction 0. None is passed, however thin or fast.
    std::optional<ShapeCastHit> shape_cast(const ShapeDefinition& shape,
                                           const Vec3& position,
                                           const RealQuat& orientation,
                                           const Vec3& translation,
                                           const QueryFilter& filter = {}) const;

    /// See Simulation.
    std::uint64_t state_hash() const;
    HashTree hash_tree() const;
    void save(std::vector<std::byte>& out) const;
    Status load(std::span<const std::byte> bytes);
    void keep(KeptState& kept) const;
    void restore(const KeptState& kept);
    static StateSchema schema();
    std::uint32_t row_count(std::uint32_t section) const;

    /// Test tools: live bytes of a section in this machine's order, after a change of which all
    /// that is derived is to be dropped; whether load() would take the state as it is; dropping
    /// what is derived, to be made anew.
    std::span<std::byte> section_bytes(std::uint32_t section);
    Status check() const;
    void drop_derived();

    struct Impl; // of layer world

private:
    explicit World(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

} // namespace lockwind
