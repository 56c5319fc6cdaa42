#include "dynamics/sweep.h"

#include "dynamics/pair_parts.h"
#include "dynamics/pairing.h"
#include "dynamics/solver_format.h"
#include "dynamics/turn.h"
#include "geometry/compound.h"
#include "geometry/pair_kernels.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/trig.h"
#include "lockwind/world_definition.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr auto kFixed = static_cast<std::uint8_t>(BodyMode::fixed);
constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);
constexpr auto kPlane = static_cast<std::uint8_t>(ShapeType::plane);
constexpr auto kDiscrete = static_cast<std::uint8_t>(CollisionMode::discrete);
constexpr auto kContinuous = static_cast<std::uint8_t>(CollisionMode::continuous);
constexpr int kFiner = 32 - kLengthFraction;

/// Whether its ways end at what they meet.
bool is_continuous(const DynamicsTables& tables, BodyRow row) {
    const BodyProperties& body = tables.properties[row];
    return body.collision_mode != kDiscrete && body.mode == kDynamic &&
           level_of(tables.sleep[row]) != BodyLevel::simplified;
}

/// The turn from one orientation to another, Q.30 rad: the shorter one; unless it is long and
/// against the spin, for that is what a fast spinner's looks like.
void turn_between(const std::int32_t from[4],
                  const std::int32_t to[4],
                  const std::int32_t spin[3],
                  std::int64_t turn[3]) {
    const std::int64_t back[4] = {-std::int64_t{from[0]},
                                  -std::int64_t{from[1]},
                                  -std::int64_t{from[2]},
                                  std::int64_t{from[3]}};
    const std::int64_t there[4] = {to[0], to[1], to[2], to[3]};
    std::int64_t change[4];
    multiply_quaternions(there, back, change);
    if (change[3] < 0) {
        for (std::int64_t& part : change) {
            part = -part;
        }
    }
    const auto real = [](std::int64_t unit) { return Real::from_raw(unit << 2); };
    const Vec3 axis{real(change[0]), real(change[1]), real(change[2])};
    const Real sine = length(axis);
    if (sine.raw() < 16) {
        std::fill(turn, turn + 3, 0);
        return;
    }
    Real angle = (atan2_angle(sine, real(change[3])) * 2).radians();
    const Vec3 unit = normalized(axis);
    std::int64_t along = 0;
    const Real parts[3] = {unit.x, unit.y, unit.z};
    for (int index = 0; index < 3; ++index) {
        along += (parts[index].raw() >> 16) * spin[index];
    }
    constexpr Real kLongest = 3.99; // that turns of a tick may have, rad
    const Real other = kPi * 2 - angle;
    if (along < 0 && other < kLongest) {
        angle = -other;
    }
    for (int index = 0; index < 3; ++index) {
        turn[index] = (parts[index] * angle).raw() >> 2;
    }
}

/// Calls visit(path) with the path of each part; of a surface, which does not move, of each
/// triangle that lies near.
template <class Visit>
void for_each_part(const ShapePath& path, const Bounds& near, Visit&& visit) {
    if (!is_composite(path.shape.type)) {
        visit(path);
        return;
    }
    ShapePath of_part = path;
    const auto visit_part = [&](std::uint32_t part) {
        of_part.shape.part = part;
        visit(of_part);
    };
    if (path.shape.type == ShapeType::compound) {
        for (std::uint32_t child = 0; child < path.shape.compound->child_count; ++child) {
            visit_part(child);
        }
        return;
    }
    BodyMotion place{};
    std::copy(path.start, path.start + 3, place.position);
    std::copy(path.orientation, path.orientation + 4, place.orientation);
    path.shape.surface->tree().visit(OverlapProbe(bounds_in_frame(near, place)), visit_part);
}

} // namespace

Sweep::Sweep(const DynamicsSettings& settings)
    : foresight_(settings), starts_(settings.body_capacity), moved_(settings.body_capacity),
      ends_(settings.body_capacity), joined_(settings.joint_capacity) {
    shortened_.reserve(settings.body_capacity);
}

void Sweep::remember(const DynamicsTables& tables, const Activity& activity) {
    has_any_ = std::any_of(activity.rows().begin(), activity.rows().end(), [&](BodyRow row) {
        return is_continuous(tables, row);
    });
    if (!has_any_) {
        return;
    }
    std::fill(moved_.begin(), moved_.end(), std::uint8_t{0});
    for (const BodyRow row : activity.rows()) {
        if (tables.properties[row].mode == kFixed) {
            continue;
        }
        const BodyMotion& motion = tables.motion[row];
        moved_[row] = 1;
        std::copy(motion.position, motion.position + 3, starts_[row].position);
        std::copy(motion.orientation, motion.orientation + 4, starts_[row].orientation);
        starts_[row].level = foresight_.reach(tables, row) != 0 ? 1 : 0;
        ends_[row] = kSweepTimeEnd;
    }
}

/// Whether it has moved, or a point of it by its turn, by more than half of its least half width:
/// what is slower cannot have passed anything that it does not touch at the start or the end.
bool Sweep::is_fast(const DynamicsTables& tables, const BodyFrames& frames, BodyRow row) const {
    const BodyMotion& motion = tables.motion[row];
    const BodyProperties& body = tables.properties[row];
    std::int64_t farthest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        farthest = std::max(
            farthest, magnitude(raw_subtract(motion.position[axis], starts_[row].position[axis])));
    }
    std::int64_t turned = 0; // Q2.30, twice the sine of half the turn, or so
    for (int index = 0; index < 4; ++index) {
        turned = std::max(
            turned,
            magnitude(std::int64_t{motion.orientation[index]} - starts_[row].orientation[index]));
    }
    const std::int64_t swept = (4 * turned * body.bounding_radius) >> (30 - kFiner);
    const std::int64_t allowed = std::int64_t{girth_of(frames[row].shape).shortest} << (kFiner - 1);
    return std::max(farthest, swept) > allowed;
}

Sweep::Reach Sweep::reach_of(const DynamicsTables& tables, BodyRow row) const {
    const BodyMotion& motion = tables.motion[row];
    const std::int64_t radius =
        (std::int64_t{tables.properties[row].bounding_radius} << kFiner) + kSweepGapMost;
    Reach reach{};
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t end = motion.position[axis];
        const std::int64_t start = moved_[row] != 0 ? starts_[row].position[axis] : end;
        reach.low[axis] = std::min(start, end) - radius;
        reach.high[axis] = std::max(start, end) + radius;
    }
    return reach;
}

ShapePath
Sweep::path_of(const DynamicsTables& tables, const BodyFrames& frames, BodyRow row) const {
    const BodyMotion& motion = tables.motion[row];
    ShapePath path{};
    path.shape = frames[row].shape;
    const bool moves = moved_[row] != 0;
    const Pose& start = starts_[row];
    for (int axis = 0; axis < 3; ++axis) {
        path.start[axis] = moves ? start.position[axis] : motion.position[axis];
        path.way[axis] = raw_subtract(motion.position[axis], path.start[axis]);
    }
    const std::int32_t* orientation = moves ? start.orientation : motion.orientation;
    std::copy(orientation, orientation + 4, path.orientation);
    if (moves) {
        turn_between(start.orientation, motion.orientation, motion.angular_velocity, path.turn);
    }
    return path;
}

void Sweep::shorten(BodyRow row, std::int64_t time) {
    if (ends_[row] == kSweepTimeEnd) {
        shortened_.push_back(row);
    }
    ends_[row] = std::min(ends_[row], time);
}

Bounds Sweep::bounds_of(const Reach& reach) {
    Bounds bounds{};
    for (int axis = 0; axis < 3; ++axis) {
        bounds.low[axis] =
            raw_saturate<std::int32_t>((reach.low[axis] >> (32 - kBoundsFraction)) - 1);
        bounds.high[axis] =
            raw_saturate<std::int32_t>((reach.high[axis] >> (32 - kBoundsFraction)) + 1);
    }
    return bounds;
}

/// All parts of the one with all of the other that lie `near` its way. The first touch counts; one
/// that is near at the start counts for the whole body, so that what slides over a surface is not
/// stopped by its next triangle.
SweepResult Sweep::meet(const ShapePath& own,
                        const ShapePath& its,
                        const Bounds& near,
                        std::int64_t& time) const {
    SweepResult result = SweepResult::apart;
    for_each_part(own, near, [&](const ShapePath& own_part) {
        for_each_part(its, near, [&](const ShapePath& its_part) {
            if (result == SweepResult::near_at_start) {
                return;
            }
            std::int64_t found = 0;
            const SweepResult part = shape_sweep(own_part, its_part, found);
            if (part == SweepResult::met) {
                time = result == SweepResult::met ? std::min(time, found) : found;
            }
            result = part == SweepResult::apart ? result : part;
        });
    });
    return result;
}

void Sweep::sweep(const DynamicsTables& tables, BodyFrames& frames, BodyRow row) {
    const BodyProperties& body = tables.properties[row];
    const bool meets_all = body.collision_mode == kContinuous;
    const Reach reach = reach_of(tables, row);
    ShapePath path = path_of(tables, frames, row);
    path.level = starts_[row].level;
    const Bounds near = bounds_of(reach);
    for (BodyRow other = 0; other < tables.motion.count(); ++other) {
        const BodyProperties& its = tables.properties[other];
        const bool moves = its.mode == kDynamic && moved_[other] != 0;
        if (other == row || (moves && !meets_all) || is_sensing(body, its) ||
            !may_meet(body, its)) {
            continue;
        }
        if (its.shape != kPlane) {
            const Reach its_reach = reach_of(tables, other);
            bool apart = false;
            for (int axis = 0; axis < 3; ++axis) {
                apart = apart || reach.low[axis] > its_reach.high[axis] ||
                        reach.high[axis] < its_reach.low[axis];
            }
            if (apart) {
                continue;
            }
        }
        if (joined_.has(std::min(row, other), std::max(row, other))) {
            continue;
        }
        frames.refresh(tables, {&other, 1}); // it may be one that nobody touches
        const ShapePath its_path = path_of(tables, frames, other);
        std::int64_t time = 0;
        ShapePath own_path = path;
        SweepResult result = meet(own_path, its_path, near, time);
        while (result == SweepResult::near_at_start && own_path.level < kSweepLevelMost) {
            ++own_path.level;
            result = meet(own_path, its_path, near, time);
        }
        if (result == SweepResult::met) {
            shorten(row, time);
            if (moves) {
                shorten(other, time);
            }
        }
    }
}

void Sweep::end_ways(const DynamicsTables& tables, const BodyFrames& frames) {
    for (const BodyRow row : shortened_) {
        const ShapePath path = path_of(tables, frames, row);
        BodyMotion& motion = tables.motion[row];
        place_on_path(path, ends_[row], motion.position);
        turn_on_path(path, ends_[row], motion.orientation);
    }
}

void Sweep::run(const DynamicsTables& tables, BodyFrames& frames, const Activity& activity) {
    if (!has_any_) {
        return;
    }
    joined_.read(tables.joints);
    shortened_.clear();
    for (const BodyRow row : activity.rows()) {
        if (is_continuous(tables, row) && is_fast(tables, frames, row)) {
            sweep(tables, frames, row);
        }
    }
    end_ways(tables, frames);
}

} // namespace lockwind
