#include "dynamics/make_body.h"
#include "dynamics/step_constants.h"
#include "systems/motion.h"
#include "world/impl.h"

#include <algorithm>
#include <string>

namespace lockwind {

namespace {

BodyView view_of(const BodyMotion& motion,
                 const BodyProperties& properties,
                 const BodySleep& sleep,
                 const ShapeLibrary& shapes) {
    const BodyReading body = read_body(motion, properties, shapes);
    return {motion.id,
            body.mode,
            body.shape,
            body.position,
            body.orientation,
            body.linear_velocity,
            body.angular_velocity,
            body.mass,
            level_of(sleep) == BodyLevel::asleep,
            level_of(sleep)};
}

Vec3 clamped(const Vec3& value, Real limit) {
    return {std::clamp(value.x, -limit, limit),
            std::clamp(value.y, -limit, limit),
            std::clamp(value.z, -limit, limit)};
}

/// Impulse x inverse mass, m/s; saturated at what a velocity holds.
Vec3 velocity_change(const Vec3& impulse, InverseMass inverse_mass) {
    const Vec3 change{saturate_to<Real>(product(impulse.x, inverse_mass)),
                      saturate_to<Real>(product(impulse.y, inverse_mass)),
                      saturate_to<Real>(product(impulse.z, inverse_mass))};
    return clamped(change, 2 * kBodySpeedMax);
}

/// Change of angular velocity x gyration radius by an angular impulse / mass, m^2/s:
/// rho I^-1 L = R diag(m rho^2 / I) R^T (L / m) / rho.
Vec3 spin_change(const Vec3& angular_impulse_by_mass,
                 const BodyMotion& motion,
                 const BodyProperties& properties) {
    constexpr Real kLimit = 1'000'000;
    const RealQuat orientation = read_orientation(motion);
    Vec3 local = rotate(conjugate(orientation), clamped(angular_impulse_by_mass, kLimit));
    const auto scale = [&](int axis) {
        return convert<Real>(Fixed<std::int32_t, 26>::from_raw(properties.inverse_inertia[axis]));
    };
    local = clamped({local.x * scale(0), local.y * scale(1), local.z * scale(2)}, kLimit);
    const auto inverse_radius =
        convert<Real>(Fixed<std::int32_t, 24>::from_raw(properties.inverse_gyration_radius));
    return rotate(orientation, local) * inverse_radius;
}

bool is_dynamic(const BodyProperties& properties) {
    return properties.mode == static_cast<std::uint8_t>(BodyMode::dynamic);
}

} // namespace

std::uint32_t World::slot_count() const {
    return impl_->players().count();
}

Tick World::tick() const {
    return impl_->globals().tick;
}

std::span<const Event> World::events() const {
    return impl_->events.events();
}

WorldCounts World::counts() const {
    const DynamicsTables tables = impl_->tables();
    WorldCounts counts{};
    counts.bodies = tables.motion.count();
    for (BodyRow row = 0; row < counts.bodies; ++row) {
        counts.awake += is_awake(tables.sleep[row]) && is_dynamic(tables.properties[row]) ? 1 : 0;
    }
    counts.pairs = tables.pairs.count();
    for (const Pair& pair : tables.pairs.rows()) {
        counts.contacts += pair.point_count;
        counts.manifolds += pair.manifold != kNoIndex ? 1 : 0;
    }
    counts.joints = tables.joints.count();
    const Globals& globals = impl_->globals();
    counts.events_total = globals.events_total;
    counts.created_total = globals.created_total;
    counts.destroyed_total = globals.destroyed_total;
    return counts;
}

std::uint64_t World::event_hash() const {
    return impl_->globals().event_hash;
}

std::uint32_t World::body_count() const {
    return impl_->tables().motion.count();
}

BodyView World::body_at(BodyRow row) const {
    const DynamicsTables tables = impl_->tables();
    LOCKWIND_ASSERT(row < tables.motion.count());
    return view_of(tables.motion[row], tables.properties[row], tables.sleep[row], impl_->shapes);
}

std::optional<BodyView> World::body(BodyId id) const {
    const BodyRow row = row_of(impl_->tables().motion, id);
    return row == kNoIndex ? std::nullopt : std::optional(body_at(row));
}

std::optional<BodyView> World::pod(Slot slot) const {
    LOCKWIND_ASSERT(slot < slot_count());
    return body(impl_->players()[slot].body);
}

std::uint32_t World::score(Slot slot) const {
    LOCKWIND_ASSERT(slot < slot_count());
    return impl_->players()[slot].score;
}

bool World::apply_impulse(BodyId id, const Vec3& impulse, const Vec3& point) {
    const DynamicsTables tables = impl_->tables();
    const BodyRow row = row_of(tables.motion, id);
    if (row == kNoIndex || !is_dynamic(tables.properties[row])) {
        return false;
    }
    BodyMotion& motion = tables.motion[row];
    const BodyProperties& properties = tables.properties[row];
    const Vec3 change = velocity_change(impulse, InverseMass::from_raw(properties.inverse_mass));
    constexpr Real kReachMax = 65536;
    constexpr Real kPlaceMax = 1 << 30; // far beyond reach, and no difference to a place overflows
    const Vec3 arm = clamped(clamped(point, kPlaceMax) - read_position(motion), kReachMax);
    write_velocity(read_velocity(motion.linear_velocity) + change, motion.linear_velocity);
    write_velocity(read_velocity(motion.angular_velocity) +
                       spin_change(cross(arm, change), motion, properties),
                   motion.angular_velocity);
    wake_body(tables, row);
    impl_->versions.touch(section::kBody, row);
    impl_->versions.touch(section::kBodySleep, row);
    return true;
}

bool World::apply_force(BodyId id, const Vec3& force, const Vec3& point) {
    return apply_impulse(id, force / Real(impl_->settings.tick_rate_hz), point);
}

bool World::apply_torque(BodyId id, const Vec3& torque) {
    const DynamicsTables tables = impl_->tables();
    const BodyRow row = row_of(tables.motion, id);
    if (row == kNoIndex || !is_dynamic(tables.properties[row])) {
        return false;
    }
    BodyMotion& motion = tables.motion[row];
    const BodyProperties& properties = tables.properties[row];
    const auto inverse_mass = InverseMass::from_raw(properties.inverse_mass);
    const Vec3 impulse = torque / Real(impl_->settings.tick_rate_hz);
    const Vec3 by_mass{saturate_to<Real>(product(impulse.x, inverse_mass)),
                       saturate_to<Real>(product(impulse.y, inverse_mass)),
                       saturate_to<Real>(product(impulse.z, inverse_mass))};
    write_velocity(read_velocity(motion.angular_velocity) +
                       spin_change(by_mass, motion, properties),
                   motion.angular_velocity);
    wake_body(tables, row);
    impl_->versions.touch(section::kBody, row);
    impl_->versions.touch(section::kBodySleep, row);
    return true;
}

bool World::set_velocity(BodyId id, const Vec3& linear, const Vec3& angular) {
    const DynamicsTables tables = impl_->tables();
    const BodyRow row = row_of(tables.motion, id);
    if (row == kNoIndex ||
        tables.properties[row].mode == static_cast<std::uint8_t>(BodyMode::fixed)) {
        return false;
    }
    const WorldSettings& settings = impl_->settings;
    const auto radius = convert<Real>(Length::from_raw(tables.properties[row].gyration_radius));
    BodyMotion& motion = tables.motion[row];
    write_velocity(clamped(linear, settings.linear_speed_max), motion.linear_velocity);
    const Vec3 spin = clamped(angular, settings.angular_speed_max) * radius;
    write_velocity(clamped(spin, kSolverAngularSpeedMax), motion.angular_velocity);
    wake_body(tables, row);
    impl_->versions.touch(section::kBody, row);
    impl_->versions.touch(section::kBodySleep, row);
    return true;
}

Status World::create_body(const BodyDefinition& definition) {
    const DynamicsTables tables = impl_->tables();
    if (row_of(tables.motion, definition.id) != kNoIndex ||
        slot_of(impl_->players(), definition.id) != kNoIndex) {
        return Error{"body " + std::to_string(definition.id) + ": id is used already"};
    }
    BodyRecord body{};
    if (Status made =
            make_body(definition, impl_->settings, impl_->shapes, body.motion, body.properties);
        !made) {
        return made;
    }
    if (definition.mode != BodyMode::fixed && is_outside(body.motion, impl_->settings.bounds)) {
        return Error{"body " + std::to_string(definition.id) +
                     ": position lies outside of settings.bounds"};
    }
    impl_->query_index.drop();
    impl_->versions.touch_all();
    impl_->spawner.create(body);
    if (impl_->spawner.apply(tables) != StepFault::none) {
        return Error{"body " + std::to_string(definition.id) + ": settings.body_capacity of " +
                     std::to_string(impl_->capacities.body_capacity) + " is full"};
    }
    return Success{};
}

bool World::destroy_body(BodyId id) {
    const DynamicsTables tables = impl_->tables();
    const BodyRow row = row_of(tables.motion, id);
    if (row == kNoIndex) {
        return false;
    }
    impl_->query_index.drop();
    impl_->versions.touch_all();
    impl_->spawner.destroy(row);
    impl_->spawner.apply(tables);
    return true;
}

} // namespace lockwind
