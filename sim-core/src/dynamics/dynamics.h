#pragma once

#include "base/table.h"
#include "dynamics/body.h"
#include "dynamics/body_properties_view.h"
#include "dynamics/contact.h"
#include "dynamics/joint.h"
#include "geometry/shape_library.h"

#include "lockwind/level_of_detail.h"
#include "lockwind/simd.h"
#include "lockwind/vector.h"

#include <cstdint>
#include <memory>
#include <span>

namespace lockwind {

struct DynamicsSettings {
    std::uint32_t tick_rate_hz = 60;
    std::uint32_t substeps = 4;
    Vec3 gravity;                   // m/s^2
    Real linear_speed_max = 400.0;  // m/s
    Real angular_speed_max = 100.0; // rad/s
    Real sleep_speed = 0.05;        // m/s
    std::uint32_t sleep_ticks = 0;  // slow for so long, an island sleeps; 0: never
    LevelOfDetail level_of_detail;
    std::uint32_t body_capacity = 0;
    std::uint32_t pair_capacity = 0;
    std::uint32_t manifold_capacity = 0;
    std::uint32_t joint_capacity = 0;
};

/// Views of the arena's sections; motion, lives and sleep have the same rows, and so have manifolds
/// and impulses.
struct DynamicsTables {
    Table<BodyMotion> motion;
    Table<BodyProperties> kinds;
    Table<BodyLife> lives;
    Table<BodySleep> sleep;
    Table<Pair> pairs;
    Table<Manifold> manifolds;
    Table<ContactImpulse> impulses;
    Table<Joint> joints;
    BodyPropertiesView properties{kinds, lives};
};

/// A capacity that ran out, or a body that left the bounds where that is an error. The tables stay
/// whole: no row is half-written.
enum class StepFault : std::uint8_t {
    none = 0,
    bodies_full = 1,
    pairs_full = 2,
    manifolds_full = 3,
    events_full = 4,
    bounds_left = 5,
};

/// A pair that began or ceased to touch in this tick's narrow phase; in pair order.
struct ContactChange {
    BodyRow row_a;
    BodyRow row_b;
    bool begin;
};

/// A pair that met at more than 1 m/s in this tick; in pair order.
struct ContactHit {
    BodyRow row_a;
    BodyRow row_b;
    std::int32_t impulse; // Q11.20 m/s: largest normal impulse of a substep / reduced mass
};

/// A dynamic body that fell asleep or woke in this tick. To freeze and to thaw is neither.
struct SleepChange {
    BodyRow row;
    bool asleep;
};

/// The rigid-body step over the arena's tables. Holds settings and scratch only: nothing that a
/// later tick reads, nothing allocated after construction.
class Dynamics {
public:
    /// `shapes` must outlive this; none: no body is a hull. `simd` is available, see simd.h.
    explicit Dynamics(const DynamicsSettings& settings,
                      const ShapeLibrary* shapes = nullptr,
                      Simd simd = best_simd());
    ~Dynamics();
    Dynamics(const Dynamics&) = delete;
    Dynamics& operator=(const Dynamics&) = delete;

    /// Updates fat bounds and the sorted pairs of overlapping ones.
    StepFault broad_phase(const DynamicsTables& tables);
    /// Makes, recycles and frees manifolds of the pairs.
    StepFault narrow_phase(const DynamicsTables& tables);
    std::span<const ContactChange> contact_changes() const;
    /// Wakes the islands that a body which is awake touches.
    void wake(const DynamicsTables& tables);
    /// Substeps: integrates velocities and positions, solves contacts with friction.
    void solve(const DynamicsTables& tables);
    /// Newton's restitution for contacts that approached faster than 1 m/s. What was foreseen but
    /// does not touch is forgotten.
    void restitution(const DynamicsTables& tables);
    /// Of the last solve and restitution.
    std::span<const ContactHit> contact_hits() const;
    /// Rows of the joints that the last solve broke, ascending; they are still there.
    std::span<const std::uint32_t> broken_joints() const;

    /// Puts islands to sleep that were slow for long enough.
    void sleep(const DynamicsTables& tables);
    /// Gives all bodies that do not sleep their levels of detail by the distance to `viewers`.
    void choose_levels(const DynamicsTables& tables, std::span<const BodyRow> viewers);
    /// Of wake and sleep, in this order, each in row order.
    std::span<const SleepChange> sleep_changes() const;
    /// Rows that the last solve moved, or would have, in row order.
    std::span<const BodyRow> awake_rows() const;
    /// Rows of the pairs and joints that concern them.
    std::span<const std::uint32_t> active_pairs() const;
    std::span<const std::uint32_t> active_joints() const;
    /// Rows of manifolds that were made, renewed or freed since the last broad phase began.
    std::span<const std::uint32_t> changed_manifolds() const;
    /// Whether pairs came or went in the last broad phase; if not, only changed_pairs() did change.
    bool pairs_moved() const;
    std::span<const std::uint32_t> changed_pairs() const;

    /// Makes the derived pairs anew from fat bounds and manifolds. False where there are too many
    /// for the table, or a manifold belongs to none of them or to one that has another.
    bool derive_pairs(const DynamicsTables& tables);
    /// Drops what is only a cache; the results of later phases do not change by a bit.
    void drop_caches();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Wakes, or thaws, one body; the next tick's wake() wakes what it touches and is joined to.
void wake_body(const DynamicsTables& tables, BodyRow row);
/// The same of both; kNoIndex and bodies that are not dynamic stay as they are.
void wake_joined(const DynamicsTables& tables, const Joint& joint);

/// Removes pairs (and frees manifolds) and joints of rows that map to kNoIndex and renumbers the
/// others. `new_row_of[old_row]`, monotone over the rows that stay. Appends contact-end changes to
/// none. What touched or was joined to a row that goes wakes.
void remap_rows(const DynamicsTables& tables, std::span<const BodyRow> new_row_of);

/// Removes the row's pairs, frees their manifolds and wakes what it touched.
void drop_contacts(const DynamicsTables& tables, BodyRow row);

} // namespace lockwind
