#include "dynamics/foresight.h"

#include "dynamics/solver_format.h"
#include "dynamics/step_constants.h"
#include "geometry/collide.h"
#include "geometry/convex_core.h"
#include "geometry/shape_distance.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/world_definition.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);
constexpr auto kSpeculative = static_cast<std::uint8_t>(CollisionMode::speculative);
constexpr int kFiner = 32 - kLengthFraction;
/// 70 m, Q9.22: with 4 m more of bounds, a pair's centres still are within centre_delta()'s format.
constexpr std::int32_t kRadiusMax = 70 << kLengthFraction;

/// Q11.20 m/s -> Q9.22 m a tick.
std::int64_t way_of(std::int64_t speed, std::int64_t tick_rate) {
    return (speed << (kLengthFraction - kVelocityFraction)) / tick_rate;
}

} // namespace

Foresight::Foresight(const DynamicsSettings& settings) : tick_rate_(settings.tick_rate_hz) {
    const StepConstants constants = make_step_constants(settings);
    // A body with a contact is held to kSolverLinearSpeedMax.
    const auto speed = convert<Velocity>(kSolverLinearSpeedMax).raw();
    reach_max_ = static_cast<std::int32_t>(
        std::min<std::int64_t>(constants.separation_max, way_of(speed, tick_rate_)));
}

std::int32_t Foresight::reach(const DynamicsTables& tables, BodyRow row) const {
    const BodyProperties& body = tables.properties[row];
    if (body.collision_mode != kSpeculative || body.mode != kDynamic ||
        body.bounding_radius > kRadiusMax || level_of(tables.sleep[row]) != BodyLevel::full) {
        return 0;
    }
    const std::uint64_t speed = floor_sqrt(squared_length(tables.motion[row].linear_velocity));
    const std::int64_t way = way_of(static_cast<std::int64_t>(speed) + 1, tick_rate_);
    return way <= kSpeculativeMargin / 2 || way > reach_max_ ? 0 : static_cast<std::int32_t>(way);
}

Bounds Foresight::extended(const Bounds& tight, const BodyMotion& motion) const {
    Bounds bounds = tight;
    for (int axis = 0; axis < 3; ++axis) {
        constexpr int kCoarser = kLengthFraction - kBoundsFraction;
        const std::int64_t way = way_of(motion.linear_velocity[axis], tick_rate_) >> kCoarser;
        if (way < 0) {
            bounds.low[axis] = raw_saturate<std::int32_t>(bounds.low[axis] + way);
        } else {
            bounds.high[axis] = raw_saturate<std::int32_t>(bounds.high[axis] + way + 1);
        }
    }
    return bounds;
}

std::int64_t
Foresight::closing(const BodyMotion& a, const BodyMotion& b, const std::int32_t normal[3]) const {
    std::int64_t speed = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t relative =
            std::int64_t{a.linear_velocity[axis]} - b.linear_velocity[axis];
        speed += round_unit_wide(relative * normal[axis]);
    }
    return way_of(speed, tick_rate_);
}

void foresee(const ShapeInstance& a,
             const ShapeInstance& b,
             std::int32_t delta[3],
             std::int64_t way_max,
             Foreseen& out) {
    out.geometry.point_count = 0;
    // shape_distance takes a half space second, and tells the way from second to first.
    const bool swapped = a.type == ShapeType::plane;
    ConvexCore core_a;
    ConvexCore core_b;
    make_core(swapped ? b : a, core_a);
    make_core(swapped ? a : b, core_b);
    std::int64_t from_second[3];
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t fine = std::int64_t{delta[axis]} << kFiner;
        from_second[axis] = swapped ? fine : -fine;
    }
    ShapeDistance found{};
    shape_distance(core_a, core_b, from_second, found);
    out.way = found.separation >> kFiner;
    if (found.overlapping || out.way > way_max) {
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        out.normal[axis] = swapped ? found.normal[axis] : -found.normal[axis];
        delta[axis] -= scale(static_cast<std::int32_t>(out.way), out.normal[axis]);
    }
    collide(a, b, delta, ManifoldCache{}, out.geometry);
}

} // namespace lockwind
