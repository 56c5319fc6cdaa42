#include "world/validate.h"

#include "dynamics/bounds_grid.h"
#include "dynamics/make_body.h"
#include "dynamics/make_joint.h"
#include "dynamics/pairing.h"
#include "dynamics/step_constants.h"
#include "geometry/fixed_geometry.h"
#include "geometry/manifold.h"
#include "systems/spawn.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

namespace lockwind {

namespace {

constexpr std::int64_t kUnitSquare = std::int64_t{1} << 60U;    // 1 in Q4.60
constexpr std::int64_t kUnitTolerance = std::int64_t{1} << 42U; // 2^-18 of it
constexpr std::uint32_t kSpawnCountMax = 0x7fffffffU;
constexpr std::int32_t kMotionSumMax = 1 << 20U; // Q9.22: 25 cm
constexpr std::int64_t kFatBoundsSlack = 2;      // m in all, beyond the body
constexpr std::int64_t kForesightSlack = 5;      // m more of one that looks ahead, see Foresight

Error bad(const char* section_name, std::uint32_t row, const char* field) {
    return Error{std::string("snapshot: ") + section_name + " row " + std::to_string(row) + ": " +
                 field + " is out of range"};
}

bool all_zero(std::span<const std::uint8_t> bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0; });
}

bool all_within(std::span<const std::int32_t> values, std::int64_t limit) {
    return std::all_of(values.begin(), values.end(), [&](std::int32_t value) {
        return value >= -limit && value <= limit;
    });
}

/// Unit length of a Q2.30 vector of 3 or 4 components. Rounding leaves a component up to 5 ulp
/// above 1.
bool is_unit(std::span<const std::int32_t> vector) {
    if (!all_within(vector, (std::int64_t{1} << 30U) + (std::int64_t{1} << 14U))) {
        return false;
    }
    std::int64_t square = 0;
    for (const std::int32_t component : vector) {
        square += std::int64_t{component} * component;
    }
    return std::abs(square - kUnitSquare) <= kUnitTolerance;
}

/// Nothing for a body that the broad phase has not seen.
std::optional<Bounds> fat_bounds(const BodyMotion& motion) {
    Bounds bounds{};
    std::copy_n(motion.fat_bounds, 3, bounds.low);
    std::copy_n(motion.fat_bounds + 3, 3, bounds.high);
    return bounds.low[0] > bounds.high[0] ? std::nullopt : std::optional(bounds);
}

bool is_empty_or_near(const BodyMotion& motion, const BodyProperties& properties) {
    const std::optional<Bounds> bounds = fat_bounds(motion);
    if (!bounds) {
        return true;
    }
    if (properties.shape == static_cast<std::uint8_t>(ShapeType::plane)) {
        return *bounds == kUnbounded;
    }
    // Q9.22 to Q15.16, and both sides of the body.
    constexpr auto kSpeculative = static_cast<std::uint8_t>(CollisionMode::speculative);
    const std::int64_t slack =
        kFatBoundsSlack + (properties.collision_mode == kSpeculative ? kForesightSlack : 0);
    // A compound's bounds are as long to both sides, and so are its hulls', which lie beside its
    // centre: their centres are within the radius, and their points within two of those.
    const std::int64_t radii =
        properties.shape == static_cast<std::uint8_t>(ShapeType::compound) ? 3 : 1;
    const std::int64_t side_max =
        radii * (std::int64_t{properties.bounding_radius} >> 5U) + (slack << 16U);
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t side = std::int64_t{bounds->high[axis]} - bounds->low[axis];
        if (side < 0 || side > side_max) {
            return false;
        }
    }
    return true;
}

const char* bad_motion_field(const BodyMotion& motion, const BodyProperties& properties) {
    constexpr std::int64_t kPositionMax = kBodyPositionMax.raw();
    constexpr std::int64_t kVelocityMax = convert<Velocity>(kBodySpeedMax).raw();
    for (const std::int64_t coordinate : motion.position) {
        if (coordinate > kPositionMax || coordinate < -kPositionMax) {
            return "position";
        }
    }
    if (!is_unit(motion.orientation)) {
        return "orientation";
    }
    if (!all_within(motion.linear_velocity, kVelocityMax)) {
        return "linear_velocity";
    }
    if (!all_within(motion.angular_velocity, kVelocityMax)) {
        return "angular_velocity";
    }
    if (!is_empty_or_near(motion, properties)) {
        return "fat_bounds";
    }
    for (const std::int32_t sum : motion.motion_sum) {
        if (sum < 0 || sum > kMotionSumMax) {
            return "motion_sum";
        }
    }
    return nullptr;
}

/// What make_body derives from shape and mode alone.
bool same_build(const BodyProperties& a, const BodyProperties& b) {
    return a.mode == b.mode && a.shape == b.shape && a.shape_index == b.shape_index &&
           a.bounding_radius == b.bounding_radius && a.gyration_radius == b.gyration_radius &&
           a.inverse_gyration_radius == b.inverse_gyration_radius &&
           std::equal(a.size, a.size + 3, b.size) &&
           std::equal(a.inverse_inertia, a.inverse_inertia + 3, b.inverse_inertia);
}

/// Makes a body of the same shape and mode and compares.
bool is_buildable(const BodyProperties& properties,
                  const WorldSettings& settings,
                  const ShapeLibrary& shapes) {
    if (properties.mode > static_cast<std::uint8_t>(BodyMode::dynamic) ||
        properties.shape > static_cast<std::uint8_t>(ShapeType::mesh)) {
        return false;
    }
    if (properties.shape >= static_cast<std::uint8_t>(ShapeType::hull) &&
        properties.shape_index >= shapes.count(static_cast<ShapeType>(properties.shape))) {
        return false;
    }
    const BodyReading reading = read_body({}, properties, shapes);
    BodyDefinition definition;
    definition.id = 1;
    definition.mode = reading.mode;
    definition.shape = reading.shape;
    definition.mass = 1;
    BodyRecord built{};
    return make_body(definition, settings, shapes, built.motion, built.properties).ok() &&
           same_build(built.properties, properties);
}

/// Of a row of body_kind that no body has.
bool is_free(const BodyProperties& kind) {
    constexpr BodyProperties kFree{};
    return std::memcmp(&kind, &kFree, sizeof(kFree)) == 0;
}

const char* bad_properties_field(const BodyProperties& properties) {
    const bool dynamic = properties.mode == static_cast<std::uint8_t>(BodyMode::dynamic);
    // 1 / kBodyMassMax and 1 / kBodyMassMin, Q24.40.
    constexpr std::int64_t kInverseMassMin = (std::int64_t{1} << 40U) / 1'000'000'000;
    constexpr std::int64_t kInverseMassMax = (std::int64_t{1} << 40U) * 1'000'001;
    if (dynamic
            ? properties.inverse_mass < kInverseMassMin || properties.inverse_mass > kInverseMassMax
            : properties.inverse_mass != 0) {
        return "inverse_mass";
    }
    if (properties.friction < 0 || properties.friction > convert<Coefficient>(kFrictionMax).raw()) {
        return "friction";
    }
    if (properties.restitution < 0 ||
        properties.restitution > convert<Coefficient>(kRestitutionMax).raw()) {
        return "restitution";
    }
    if (properties.can_sleep > 1) {
        return "can_sleep";
    }
    if (properties.sensor > 1) {
        return "sensor";
    }
    if (properties.layer >= kLayerCount) {
        return "layer";
    }
    constexpr auto kLastRule = static_cast<std::uint8_t>(CombineRule::maximum);
    if (properties.friction_rule > kLastRule || properties.restitution_rule > kLastRule) {
        return "friction_rule or restitution_rule";
    }
    // Of a body of parts, along its principal axes.
    if (!all_within(properties.surface_velocity, 2 * convert<Velocity>(kSurfaceSpeedMax).raw())) {
        return "surface_velocity";
    }
    if (properties.collision_mode > static_cast<std::uint8_t>(CollisionMode::speculative)) {
        return "collision_mode";
    }
    if (properties.substeps > kSubstepsMax) {
        return "substeps";
    }
    if (properties.zero_end != 0) {
        return "zero";
    }
    return nullptr;
}

/// A body that sleeps does not move. Where there are no levels of detail, nobody would thaw.
const char* bad_sleep_field(const BodySleep& sleep,
                            const BodyMotion& motion,
                            const BodyProperties& properties,
                            const LevelOfDetail& detail) {
    const bool is_fixed = properties.mode == static_cast<std::uint8_t>(BodyMode::fixed);
    const bool moves = !is_fixed && (!all_within(motion.linear_velocity, 0) ||
                                     !all_within(motion.angular_velocity, 0));
    const bool is_far = sleep.level > static_cast<std::uint8_t>(BodyLevel::asleep);
    if (sleep.level > static_cast<std::uint8_t>(BodyLevel::frozen) ||
        (level_of(sleep) == BodyLevel::asleep && moves) ||
        (is_far && (is_fixed || !detail.enabled))) {
        return "level";
    }
    constexpr unsigned kMovedMax = bit_of(MotionBound::touching) | bit_of(MotionBound::other);
    return sleep.moved > kMovedMax ? "moved" : nullptr;
}

/// The highest axis that collide() leaves in the cache: see ManifoldGeometry.
std::uint32_t axis_max(const DynamicsTables& tables, const Manifold& manifold) {
    constexpr auto kHull = static_cast<std::uint8_t>(ShapeType::hull);
    const bool may_have_hull = tables.properties[manifold.row_a].shape >= kHull ||
                               tables.properties[manifold.row_b].shape >= kHull;
    return may_have_hull ? 2 * kHullFacesMax : 15;
}

/// Longest arm from a body's centre to a contact point, Q9.22 m: what collide() keeps to, 1.25
/// bounding radii and half the speculative margin, and 1 mm for roundings. On a plane or
/// surface it is as long as the partner is deep in it.
std::int64_t arm_max(const DynamicsTables& tables, BodyRow row) {
    constexpr std::int64_t kSlack = (kSpeculativeMargin >> 1) + ((std::int64_t{1} << 22U) / 1000);
    constexpr std::int64_t kPlaneDepth = std::int64_t{500} << 22U;
    const BodyProperties& body = tables.properties[row];
    const std::int64_t radius = body.bounding_radius;
    return radius == 0 || is_surface(static_cast<ShapeType>(body.shape))
               ? kPlaneDepth
               : radius + (radius >> 2U) + kSlack;
}

/// In units of 16 raw, so that any lengths' squares add up: arm_max has slack enough.
bool is_within(const std::int64_t (&vector)[3], std::int64_t length) {
    constexpr std::uint32_t kUnitBits = 4;
    const std::int64_t longest = length >> kUnitBits;
    std::int64_t square = 0;
    for (const std::int64_t component : vector) {
        if (component > length || component < -length) {
            return false;
        }
        const std::int64_t coarse = component / (std::int64_t{1} << kUnitBits);
        square += coarse * coarse;
    }
    return square <= longest * longest;
}

const char* bad_point_field(const Manifold& manifold,
                            std::uint32_t point,
                            std::int64_t longest_a,
                            std::int64_t longest_b) {
    const std::int32_t* anchor_a = manifold.anchor_a + 3 * point;
    const std::int32_t* delta = manifold.centre_delta;
    if (!is_within({anchor_a[0], anchor_a[1], anchor_a[2]}, longest_a)) {
        return "anchor_a";
    }
    if (!is_within({std::int64_t{anchor_a[0]} - delta[0],
                    std::int64_t{anchor_a[1]} - delta[1],
                    std::int64_t{anchor_a[2]} - delta[2]},
                   longest_b)) {
        return "centre_delta";
    }
    return nullptr;
}

bool is_unused(const Manifold& manifold, std::uint32_t point) {
    const auto is_zero = [](std::int32_t value) { return value == 0; };
    return manifold.separation[point] == 0 && manifold.feature[point] == 0 &&
           std::all_of(manifold.anchor_a + 3 * point, manifold.anchor_a + 3 * point + 3, is_zero);
}

const char* bad_manifold_field(const DynamicsTables& tables, const Manifold& manifold) {
    if (manifold.row_a >= manifold.row_b || manifold.row_b >= tables.motion.count()) {
        return "row_b";
    }
    if (manifold.point_count > kManifoldPointsMax) {
        return "point_count";
    }
    if (manifold.axis > axis_max(tables, manifold)) {
        return "axis";
    }
    if (!is_unit(manifold.normal) || !is_unit(manifold.tangent)) {
        return "normal";
    }
    if (!is_unit(manifold.orientation_a) || !is_unit(manifold.orientation_b)) {
        return "orientation_a or orientation_b";
    }
    const std::int64_t longest_a = arm_max(tables, manifold.row_a);
    const std::int64_t longest_b = arm_max(tables, manifold.row_b);
    if (!all_within(manifold.separation, longest_a + longest_b)) {
        return "separation";
    }
    for (std::uint32_t point = 0; point < kManifoldPointsMax; ++point) {
        if (point >= manifold.point_count) {
            if (!is_unused(manifold, point)) {
                return "a point past point_count";
            }
        } else if (const char* field = bad_point_field(manifold, point, longest_a, longest_b);
                   field != nullptr) {
            return field;
        }
    }
    return all_zero(manifold.zero) ? nullptr : "zero";
}

/// Of a manifold of `point_count` points, 0 of a free row.
const char* bad_impulse_field(const ContactImpulse& impulse, std::uint32_t point_count) {
    // The solver caps a contact's normal impulses together, and friction at 4 x 480 m/s.
    constexpr std::int64_t kNormalMax = std::int64_t{960} << 20U;
    constexpr std::int64_t kFrictionMax = std::int64_t{1920} << 20U;
    const std::int64_t bound = point_count == 0 ? 0 : kFrictionMax;
    if (!all_within(impulse.friction, bound)) {
        return "friction";
    }
    if (!all_within({&impulse.twist, 1}, bound)) {
        return "twist";
    }
    std::int64_t sum = 0;
    for (std::uint32_t point = 0; point < kManifoldPointsMax; ++point) {
        if (impulse.normal[point] < 0 || (impulse.normal[point] != 0 && point >= point_count)) {
            return "normal";
        }
        sum += impulse.normal[point];
    }
    return sum > kNormalMax ? "normal" : nullptr;
}

} // namespace

Status check_globals(const Table<Globals>& globals) {
    if (globals.count() != 1) {
        return Error{"snapshot: section \"globals\" must have 1 row"};
    }
    return Success{};
}

Status check_players(const Table<Player>& players, std::span<const BodyId> pods) {
    if (players.count() != pods.size()) {
        return Error{"snapshot: " + std::to_string(players.count()) +
                     " players, but the match has " + std::to_string(pods.size()) + " slots"};
    }
    for (Slot slot = 0; slot < players.count(); ++slot) {
        const Player& player = players[slot];
        if (player.body != pods[slot]) {
            return bad("player", slot, "body");
        }
        if (player.shooting > 1) {
            return bad("player", slot, "shooting");
        }
        if (!all_zero(player.zero)) {
            return bad("player", slot, "zero");
        }
    }
    return Success{};
}

Status check_kinds(const DynamicsTables& tables,
                   const DynamicsTables* known,
                   Spawner& spawner,
                   const WorldSettings& settings,
                   const ShapeLibrary& shapes) {
    const std::uint32_t count = tables.motion.count();
    if (tables.lives.count() != count || tables.sleep.count() != count) {
        return Error{
            "snapshot: sections \"body\", \"body_life\" and \"body_sleep\" differ in rows"};
    }
    if (!spawner.check_kinds(tables)) {
        return Error{"snapshot: body_life: a body without a kind, or body_kind: one twice, or one "
                     "that no body has"};
    }
    for (std::uint32_t row = 0; row < tables.kinds.count(); ++row) {
        const BodyProperties& kind = tables.kinds[row];
        if (is_free(kind)) {
            continue;
        }
        const bool is_known =
            known != nullptr && row < known->kinds.count() && same_build(known->kinds[row], kind);
        if (!is_known && !is_buildable(kind, settings, shapes)) {
            return bad("body_kind", row, "mode, shape, index, size or inertia");
        }
        if (const char* field = bad_properties_field(kind); field != nullptr) {
            return bad("body_kind", row, field);
        }
    }
    return Success{};
}

Status check_bodies(const DynamicsTables& tables, const LevelOfDetail& detail) {
    for (BodyRow row = 0; row < tables.motion.count(); ++row) {
        const BodyMotion& motion = tables.motion[row];
        const BodyProperties& properties = tables.properties[row];
        if (motion.id == 0 || (row > 0 && tables.motion[row - 1].id >= motion.id)) {
            return bad("body", row, "id");
        }
        if (is_free(properties)) {
            return bad("body_life", row, "body_kind");
        }
        if (const char* field = bad_motion_field(motion, properties); field != nullptr) {
            return bad("body", row, field);
        }
        if (const char* field = bad_sleep_field(tables.sleep[row], motion, properties, detail);
            field != nullptr) {
            return bad("body_sleep", row, field);
        }
        const BodyRow spawner =
            spawner_of(motion.id) != 0 ? row_of(tables.motion, spawner_of(motion.id)) : kNoIndex;
        if (tables.lives[row].spawn_count > kSpawnCountMax) {
            return bad("body_life", row, "spawn_count");
        }
        if (spawner != kNoIndex &&
            static_cast<std::uint32_t>(motion.id) > tables.lives[spawner].spawn_count) {
            return bad("body_life", spawner, "spawn_count");
        }
    }
    return Success{};
}

Status check_joints(const DynamicsTables& tables) {
    for (std::uint32_t row = 0; row < tables.joints.count(); ++row) {
        const Joint& joint = tables.joints[row];
        if (joint.id == 0 || (row > 0 && tables.joints[row - 1].id >= joint.id)) {
            return bad("joint", row, "id");
        }
        if (const char* field = bad_joint_field(tables, joint); field != nullptr) {
            return bad("joint", row, field);
        }
    }
    return Success{};
}

Status check_contacts(const DynamicsTables& tables, Dynamics& dynamics) {
    constexpr Manifold kFree{};
    if (tables.impulses.count() != tables.manifolds.count()) {
        return Error{"snapshot: sections \"manifold\" and \"contact_impulse\" differ in rows"};
    }
    for (std::uint32_t row = 0; row < tables.manifolds.count(); ++row) {
        const Manifold& manifold = tables.manifolds[row];
        if (manifold.point_count == 0) {
            if (std::memcmp(&manifold, &kFree, sizeof(kFree)) != 0) {
                return bad("manifold", row, "a free row");
            }
        } else if (const char* field = bad_manifold_field(tables, manifold); field != nullptr) {
            return bad("manifold", row, field);
        }
        if (const char* field = bad_impulse_field(tables.impulses[row], manifold.point_count);
            field != nullptr) {
            return bad("contact_impulse", row, field);
        }
    }
    if (!dynamics.derive_pairs(tables)) {
        return Error{
            "snapshot: the bodies' fat_bounds make more pairs than settings.pair_capacity, "
            "or no pair, or one twice, for a manifold"};
    }
    return Success{};
}

} // namespace lockwind
