#pragma once

#include "base/table.h"
#include "dynamics/activity.h"
#include "dynamics/dynamics.h"
#include "dynamics/make_body.h"
#include "dynamics/make_joint.h"

#include "lockwind/world_definition.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <vector>

namespace lockwind {

/// All that a Dynamics reads and writes: its tables and the tick.
struct DynamicsState {
    std::vector<BodyMotion> motion;
    std::vector<BodyProperties> properties;
    std::vector<BodySleep> sleep;
    std::vector<Pair> pairs;
    std::vector<Manifold> manifolds;
    std::vector<ContactImpulse> impulses;
    std::vector<Joint> joints;
    std::uint32_t motion_count = 0;
    std::uint32_t properties_count = 0;
    std::uint32_t sleep_count = 0;
    std::uint32_t pair_count = 0;
    std::uint32_t manifold_count = 0;
    std::uint32_t impulse_count = 0;
    std::uint32_t joint_count = 0;
    std::uint32_t tick = 0;
};

/// Same state, and the same pairs; the axis of a pair that does not touch is only a cache.
inline bool same_bits(const DynamicsState& a, const DynamicsState& b) {
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() &&
               std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
    };
    const auto same_pair = [](const Pair& x, const Pair& y) {
        return x.row_a == y.row_a && x.row_b == y.row_b && x.manifold == y.manifold &&
               x.point_count == y.point_count && (x.point_count == 0 || x.axis == y.axis);
    };
    return a.tick == b.tick && a.motion_count == b.motion_count && a.pair_count == b.pair_count &&
           a.manifold_count == b.manifold_count && a.joint_count == b.joint_count &&
           same(a.motion, b.motion) && same(a.properties, b.properties) && same(a.sleep, b.sleep) &&
           std::equal(a.pairs.begin(), a.pairs.end(), b.pairs.begin(), b.pairs.end(), same_pair) &&
           same(a.manifolds, b.manifolds) && same(a.impulses, b.impulses) &&
           same(a.joints, b.joints);
}

/// A Dynamics over tables in vectors, for tests: no world, no players, no despawning.
class DynamicsBench {
public:
    explicit DynamicsBench(WorldSettings settings = {}, std::uint32_t capacity = 256)
        : settings_(settings), capacity_(capacity),
          pair_capacity_(settings.pair_capacity != 0 ? settings.pair_capacity : 16 * capacity),
          manifold_capacity_(settings.manifold_capacity != 0 ? settings.manifold_capacity
                                                             : 8 * capacity) {
        state_.motion.resize(capacity);
        state_.properties.resize(capacity);
        state_.sleep.resize(capacity);
        state_.pairs.resize(pair_capacity());
        state_.manifolds.resize(manifold_capacity());
        state_.impulses.resize(manifold_capacity());
        state_.joints.resize(capacity);
        for (BodyRow row = 0; row < capacity; ++row) {
            lives_.push_back({row, 0, 0}); // each body is a kind of its own
        }
        renew();
    }

    std::uint32_t pair_capacity() const { return pair_capacity_; }
    std::uint32_t manifold_capacity() const { return manifold_capacity_; }

    /// Bodies sleep after so many ticks; without this never.
    void let_sleep(std::uint32_t ticks) {
        sleep_ticks_ = ticks;
        renew();
    }
    /// A Dynamics that remembers nothing.
    void renew() { dynamics_ = std::make_unique<Dynamics>(dynamics_settings()); }

    DynamicsSettings dynamics_settings() const {
        DynamicsSettings settings;
        settings.tick_rate_hz = settings_.tick_rate_hz;
        settings.substeps = settings_.substeps;
        settings.gravity = settings_.gravity;
        settings.linear_speed_max = settings_.linear_speed_max;
        settings.angular_speed_max = settings_.angular_speed_max;
        settings.sleep_speed = settings_.sleep_speed;
        settings.sleep_ticks = sleep_ticks_;
        settings.body_capacity = capacity_;
        settings.pair_capacity = pair_capacity();
        settings.manifold_capacity = manifold_capacity();
        settings.joint_capacity = capacity_;
        return settings;
    }

    BodyRow add(BodyDefinition definition) {
        const BodyRow row = state_.motion_count++;
        ++state_.properties_count;
        ++state_.sleep_count;
        definition.id = row + 1;
        const Status made =
            make_body(definition, settings_, {}, state_.motion[row], state_.properties[row]);
        EXPECT_TRUE(made.ok()) << made.error().message;
        return row;
    }

    /// Between bodies that the definition names by row + 1, their ids here.
    std::uint32_t add(JointDefinition definition) {
        const std::uint32_t row = state_.joint_count++;
        definition.id = row + 1;
        const auto row_of = [](BodyId id) {
            return id == 0 ? kNoIndex : static_cast<BodyRow>(id - 1);
        };
        const Status made = make_joint(definition,
                                       tables(),
                                       {},
                                       row_of(definition.body_a),
                                       row_of(definition.body_b),
                                       state_.joints[row]);
        EXPECT_TRUE(made.ok()) << made.error().message;
        return row;
    }

    DynamicsTables tables() {
        return {{state_.motion.data(), &state_.motion_count, capacity_},
                {state_.properties.data(), &state_.properties_count, capacity_},
                {lives_.data(), &state_.motion_count, capacity_},
                {state_.sleep.data(), &state_.sleep_count, capacity_},
                {state_.pairs.data(), &state_.pair_count, pair_capacity()},
                {state_.manifolds.data(), &state_.manifold_count, manifold_capacity()},
                {state_.impulses.data(), &state_.impulse_count, manifold_capacity()},
                {state_.joints.data(), &state_.joint_count, capacity_}};
    }

    void step() {
        ++state_.tick;
        ASSERT_EQ(dynamics_->broad_phase(tables()), StepFault::none);
        ASSERT_EQ(dynamics_->narrow_phase(tables()), StepFault::none);
        dynamics_->wake(tables());
        dynamics_->solve(tables());
        dynamics_->restitution(tables());
        dynamics_->sleep(tables());
    }
    void run(int ticks) {
        for (int tick = 0; tick < ticks; ++tick) {
            step();
        }
    }

    /// At all pairs, in the next narrow phase.
    void look_again() {
        for (BodySleep& sleep : tables().sleep.rows()) {
            sleep.moved = bit_of(MotionBound::touching) | bit_of(MotionBound::other);
        }
    }
    void drop_derived() {
        dynamics_->drop_caches();
        EXPECT_TRUE(dynamics_->derive_pairs(tables()));
    }

    /// Who is awake now.
    Activity activity() {
        Activity activity(dynamics_settings());
        activity.read_rows(tables().sleep);
        activity.read_pairs(tables().pairs);
        activity.read_joints(tables().joints);
        return activity;
    }

    Dynamics& dynamics() { return *dynamics_; }
    DynamicsState& state() { return state_; }
    Joint& joint(std::uint32_t row) { return state_.joints[row]; }
    BodyMotion& motion(BodyRow row) { return state_.motion[row]; }
    BodyProperties& properties(BodyRow row) { return state_.properties[row]; }

    double position(BodyRow row, int axis) const {
        return std::ldexp(static_cast<double>(state_.motion[row].position[axis]), -32);
    }
    double velocity(BodyRow row, int axis) const {
        return std::ldexp(state_.motion[row].linear_velocity[axis], -20);
    }
    /// rad/s
    double spin(BodyRow row, int axis) const {
        const double radius = std::ldexp(state_.properties[row].gyration_radius, -22);
        return std::ldexp(state_.motion[row].angular_velocity[axis], -20) / radius;
    }
    double speed(BodyRow row) const {
        return std::hypot(velocity(row, 0), velocity(row, 1), velocity(row, 2));
    }

private:
    WorldSettings settings_;
    std::uint32_t sleep_ticks_ = 0;
    std::vector<BodyLife> lives_;
    std::uint32_t capacity_;
    std::uint32_t pair_capacity_;
    std::uint32_t manifold_capacity_;
    DynamicsState state_;
    std::unique_ptr<Dynamics> dynamics_;
};

inline Real real(double value) {
    return Real::from_raw(std::llround(std::ldexp(value, 32)));
}
inline Vec3 vec(double x, double y, double z) {
    return {real(x), real(y), real(z)};
}

inline BodyDefinition ball(double radius, const Vec3& position) {
    BodyDefinition body;
    body.shape.type = ShapeType::sphere;
    body.shape.radius = real(radius);
    body.position = position;
    return body;
}
inline BodyDefinition box(double x, double y, double z, const Vec3& position) {
    BodyDefinition body;
    body.shape.type = ShapeType::box;
    body.shape.half_extents = vec(x, y, z);
    body.position = position;
    return body;
}
inline BodyDefinition cube(double half, const Vec3& position) {
    return box(half, half, half, position);
}
inline BodyDefinition fixed(BodyDefinition body) {
    body.mode = BodyMode::fixed;
    return body;
}
/// A half space below height 0, tilted about z by `angle` (rad): it rises towards +x.
inline BodyDefinition ground(double angle = 0) {
    BodyDefinition body;
    body.mode = BodyMode::fixed;
    body.shape.type = ShapeType::plane;
    body.orientation = {0, 0, real(std::sin(angle / 2)), real(std::cos(angle / 2))};
    return body;
}

} // namespace lockwind
