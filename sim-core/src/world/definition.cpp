#include "world/definition.h"

#include "dynamics/definition_checker.h"
#include "dynamics/step_constants.h"

#include <algorithm>
#include <string>
#include <vector>

namespace lockwind {

namespace {

constexpr Real kGravityMax = 1000.0;
constexpr Real kLinearSpeedLimit = 1000.0;
constexpr Real kAngularSpeedLimit = 1000.0;
constexpr Real kBoundsMax = 16000.0;
constexpr Real kSleepSpeedMax = 10.0;
constexpr Real kSleepSecondsMax = 60.0;
constexpr Real kDetailDistanceMax = 16000.0;

bool outside(const Vec3& position, Real bounds) {
    return abs(position.x) > bounds || abs(position.y) > bounds || abs(position.z) > bounds;
}

Status check_settings(const WorldSettings& settings) {
    const LevelOfDetail& detail = settings.level_of_detail;
    DefinitionChecker checker("settings");
    checker.count("tick_rate_hz", settings.tick_rate_hz, kWorldTickRateHzMin, kWorldTickRateHzMax);
    checker.count("substeps", settings.substeps, 1, kSubstepsMax);
    checker.vector_range("gravity", settings.gravity, kGravityMax, " m/s^2");
    checker.range("linear_speed_max", settings.linear_speed_max, 1, kLinearSpeedLimit, " m/s");
    checker.range("angular_speed_max", settings.angular_speed_max, 1, kAngularSpeedLimit, " rad/s");
    checker.range("sleep_speed", settings.sleep_speed, 0, kSleepSpeedMax, " m/s");
    checker.range("sleep_seconds", settings.sleep_seconds, 0, kSleepSecondsMax, " s");
    checker.range("bounds", settings.bounds, 1, kBoundsMax, " m");
    checker.require(settings.bounds_policy <= BoundsPolicy::error, "bounds_policy", "is unknown");
    checker.range("level_of_detail.full_within", detail.full_within, 1, kDetailDistanceMax, " m");
    checker.range("level_of_detail.simplified_within",
                  detail.simplified_within,
                  detail.full_within,
                  kDetailDistanceMax,
                  " m");
    checker.count(
        "level_of_detail.simplified_substeps", detail.simplified_substeps, 1, kSubstepsMax);
    if (checker.failed()) {
        return checker.error();
    }
    if (settings.body_capacity > kBodyCapacityMax || settings.pair_capacity > kPairCapacityMax ||
        settings.manifold_capacity > kPairCapacityMax ||
        settings.joint_capacity > kJointCapacityMax) {
        return Error{"settings: body_capacity and joint_capacity must be at most " +
                     std::to_string(kBodyCapacityMax) +
                     ", pair_capacity and manifold_capacity at most " +
                     std::to_string(kPairCapacityMax)};
    }
    return Success{};
}

Status check_joints(const WorldDefinition& definition, std::uint32_t capacity) {
    std::vector<JointId> ids;
    for (const JointDefinition& joint : definition.joints) {
        ids.push_back(joint.id);
    }
    std::sort(ids.begin(), ids.end());
    const auto twin = std::adjacent_find(ids.begin(), ids.end());
    if (twin != ids.end()) {
        return Error{"joint " + std::to_string(*twin) + ": id is used twice"};
    }
    if (ids.size() > capacity) {
        return Error{"settings: joint_capacity of " + std::to_string(capacity) +
                     " is too small for the scene's " + std::to_string(ids.size()) + " joints"};
    }
    return Success{};
}

std::uint32_t plane_count(const WorldDefinition& definition) {
    const auto is_plane = [](const BodyDefinition& body) {
        return body.shape.type == ShapeType::plane;
    };
    return static_cast<std::uint32_t>(
        std::count_if(definition.bodies.begin(), definition.bodies.end(), is_plane));
}

/// The most children that a compound has, at least 1.
std::uint64_t parts_max(const WorldDefinition& definition) {
    std::size_t most = 1;
    for (const CompoundDefinition& compound : definition.compounds) {
        most = std::max(most, compound.children.size());
    }
    return most;
}

/// Rows that a body has with the triangles below it, for a guess of the capacities.
std::uint64_t triangles_near(const WorldDefinition& definition) {
    const bool has_surface = !definition.height_fields.empty() || !definition.meshes.empty();
    return has_surface ? 64 : 0;
}

/// Rounded up: of a time above 0 at least one tick.
std::uint32_t sleep_ticks(const WorldSettings& settings) {
    const Real ticks = settings.sleep_seconds * Real(settings.tick_rate_hz);
    return static_cast<std::uint32_t>((ticks.raw() + Real(1).raw() - 1) >> Real::kFraction);
}

/// Balls alive at once: one a cooldown during a lifetime, the first and the one being made.
std::uint64_t balls_max(const PodDefinition& pod) {
    return pod.ball_lifetime_ticks / std::max(pod.ball_cooldown_ticks, 1U) + 2;
}

} // namespace

Status check_definition(const WorldDefinition& definition) {
    if (Status status = check_settings(definition.settings); !status) {
        return status;
    }
    if (definition.pods.size() > kSlotsMax) {
        return Error{"pods: " + std::to_string(definition.pods.size()) + ", but at most " +
                     std::to_string(kSlotsMax) + " can play"};
    }
    std::vector<BodyId> ids;
    for (const BodyDefinition& body : definition.bodies) {
        const bool moves = body.mode != BodyMode::fixed;
        if (moves && outside(body.position, definition.settings.bounds)) {
            return Error{"body " + std::to_string(body.id) +
                         ": position lies outside of settings.bounds"};
        }
        ids.push_back(body.id);
    }
    std::sort(ids.begin(), ids.end());
    const auto twin = std::adjacent_find(ids.begin(), ids.end());
    if (twin != ids.end()) {
        return Error{"body " + std::to_string(*twin) + ": id is used twice"};
    }
    const DynamicsSettings dynamics = dynamics_settings(definition);
    if (definition.bodies.size() > dynamics.body_capacity) {
        return Error{"settings: body_capacity of " + std::to_string(dynamics.body_capacity) +
                     " is too small for the scene's " + std::to_string(definition.bodies.size()) +
                     " bodies"};
    }
    return check_joints(definition, dynamics.joint_capacity);
}

DynamicsSettings dynamics_settings(const WorldDefinition& definition) {
    const WorldSettings& settings = definition.settings;
    DynamicsSettings dynamics;
    dynamics.tick_rate_hz = settings.tick_rate_hz;
    dynamics.substeps = settings.substeps;
    dynamics.gravity = settings.gravity;
    dynamics.linear_speed_max = settings.linear_speed_max;
    dynamics.angular_speed_max = settings.angular_speed_max;
    dynamics.sleep_speed = settings.sleep_speed;
    dynamics.sleep_ticks = sleep_ticks(settings);
    dynamics.level_of_detail = settings.level_of_detail;
    std::uint64_t bodies = definition.bodies.size() + 8;
    for (const PodDefinition& pod : definition.pods) {
        bodies += balls_max(pod);
    }
    const auto derived = [](std::uint32_t given, std::uint64_t wanted, std::uint32_t limit) {
        return given != 0 ? given
                          : static_cast<std::uint32_t>(std::min<std::uint64_t>(wanted, limit));
    };
    dynamics.body_capacity = derived(settings.body_capacity, bodies, kBodyCapacityMax);
    const std::uint64_t capacity = dynamics.body_capacity;
    const std::uint64_t parts = parts_max(definition);
    const std::uint64_t triangles = triangles_near(definition);
    dynamics.pair_capacity =
        derived(settings.pair_capacity,
                capacity * (24 * parts + plane_count(definition) + triangles) * parts + 256,
                kPairCapacityMax);
    dynamics.manifold_capacity = derived(settings.manifold_capacity,
                                         capacity * (12 + triangles / 4) * parts + 256,
                                         kPairCapacityMax);
    dynamics.joint_capacity =
        derived(settings.joint_capacity, definition.joints.size() + 64, kJointCapacityMax);
    return dynamics;
}

} // namespace lockwind
