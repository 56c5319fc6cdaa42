#include "dynamics/narrow_phase.h"

#include "dynamics/pair_parts.h"
#include "dynamics/pairing.h"
#include "dynamics/solver_format.h"
#include "geometry/bounds.h"
#include "geometry/collide.h"
#include "geometry/compound.h"
#include "geometry/rotation.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/world_definition.h"

#include <algorithm>
#include <optional>

namespace lockwind {

namespace {

constexpr auto kFixed = static_cast<std::uint8_t>(BodyMode::fixed);
constexpr std::int64_t kDriftMax = 209715; // 50 mm, Q9.22: a manifold bears this much sliding

bool is_flat(ShapeType type) {
    return type == ShapeType::box || type == ShapeType::plane || type == ShapeType::hull ||
           is_surface(type);
}

/// Whether a body bears more motion between two looks: no part of it is round.
bool is_flat(const ShapeInstance& shape) {
    if (shape.type != ShapeType::compound) {
        return is_flat(shape.type);
    }
    const CompoundShape* children = shape.compound->children;
    return std::all_of(children,
                       children + shape.compound->child_count,
                       [](const CompoundShape& child) { return is_flat(child.type); });
}

/// The orientation that a frame's rotation stands for.
void copy_orientation(const BodyFrame& frame, std::int32_t out[4]) {
    constexpr std::int32_t kIdentity[4] = {0, 0, 0, kUnitOne};
    const bool turns = frame.shape.type != ShapeType::sphere;
    std::copy_n(turns ? frame.orientation : kIdentity, 4, out);
}

/// How far a body's turn since `orientation` has moved a point at `arm` from its centre, Q9.22 m.
class TurnSince {
public:
    TurnSince(const BodyFrame& frame, const std::int32_t orientation[4], bool turns)
        : now_(frame.rotation), turns_(turns) {
        rotation_matrix(orientation, then_);
    }
    void move(const std::int32_t arm[3], std::int64_t moved[3]) const {
        std::fill_n(moved, 3, 0);
        if (turns_) {
            std::int32_t local[3];
            std::int32_t now[3];
            inverse_rotate(then_, arm, local);
            rotate(now_, local, now);
            for (int axis = 0; axis < 3; ++axis) {
                moved[axis] = std::int64_t{now[axis]} - arm[axis];
            }
        }
    }

private:
    const std::int32_t* now_;
    std::int32_t then_[9];
    bool turns_;
};

/// A body's part, as a shape of its own.
class BodyPart {
public:
    BodyPart(const ShapeInstance& body, std::uint32_t part)
        : body_(body), part_(part), shape_(body) {
        if (body.type == ShapeType::compound) {
            child_.emplace(body, part);
            shape_ = child_->shape;
        } else {
            shape_.part = part;
        }
    }
    const ShapeInstance& shape() const { return shape_; }
    /// Q9.22 m, world axes, from the body's centre.
    const std::int32_t* offset() const {
        static constexpr std::int32_t kNone[3] = {0, 0, 0};
        return child_ ? child_->offset : kNone;
    }
    /// A point of the part's frame in the body's.
    void to_body(std::int32_t point[3]) const {
        if (child_) {
            std::int32_t world[3];
            rotate(shape_.rotation, point, world);
            for (int axis = 0; axis < 3; ++axis) {
                world[axis] =
                    raw_saturate<std::int32_t>(std::int64_t{world[axis]} + child_->offset[axis]);
            }
            inverse_rotate(body_.rotation, world, point);
        }
    }

    /// Whether a contact is another child's to tell: what slides over the seam between two must
    /// not be stopped by it. The point (the body's frame) lies `lift` (Q9.22 m) off the surface
    /// along the outward normal (Q2.30, world).
    bool is_at_seam(const std::int32_t point[3],
                    const std::int32_t outwards[3],
                    std::int32_t lift) const {
        if (!child_) {
            return false;
        }
        std::int32_t normal[3];
        std::int32_t surface[3];
        inverse_rotate(body_.rotation, outwards, normal);
        for (int axis = 0; axis < 3; ++axis) {
            surface[axis] = point[axis] - scale(lift, normal[axis]);
        }
        return lockwind::is_at_seam(*body_.compound, part_, surface, normal);
    }

private:
    const ShapeInstance& body_;
    std::uint32_t part_;
    std::optional<CompoundPart> child_;
    ShapeInstance shape_;
};

/// Damaged rows must not lead outside.
bool has_part(const ShapeInstance& shape, std::uint32_t part) {
    return is_surface(shape.type) ? part < shape.surface->triangle_count()
                                  : part < child_count(shape);
}

/// Whether the triangle's bounds, in its own frame, and the other part's are apart.
bool is_apart_from_triangle(const ShapeInstance& surface,
                            const ShapeInstance& other,
                            const std::int32_t delta[3]) {
    std::int32_t half_extents[3];
    std::int32_t centre[3];
    bounds_half_extents(other, half_extents);
    inverse_rotate(surface.rotation, delta, centre);
    for (int axis = 0; axis < 3; ++axis) {
        std::int64_t reach = kSpeculativeMargin;
        for (int row = 0; row < 3; ++row) {
            reach += scale(half_extents[row], magnitude(surface.rotation[3 * row + axis])) + 1;
        }
        std::int32_t places[3];
        for (std::uint32_t corner = 0; corner < 3; ++corner) {
            places[corner] = surface.surface->corner(surface.part, corner)[axis];
        }
        const auto [low, high] = std::minmax({places[0], places[1], places[2]});
        if (centre[axis] < low - reach || centre[axis] > high + reach) {
            return true;
        }
    }
    return false;
}

bool are_parts_apart(const ShapeInstance& a, const ShapeInstance& b, const std::int32_t delta[3]) {
    if (!is_bounded(a.type) || !is_bounded(b.type)) {
        return false;
    }
    if (is_surface(b.type)) {
        const std::int32_t back[3] = {-delta[0], -delta[1], -delta[2]};
        return is_apart_from_triangle(b, a, back);
    }
    if (is_surface(a.type)) {
        return is_apart_from_triangle(a, b, delta);
    }
    std::int32_t extents[2][3];
    bounds_half_extents(a, extents[0]);
    bounds_half_extents(b, extents[1]);
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t reach =
            std::int64_t{extents[0][axis]} + extents[1][axis] + kSpeculativeMargin;
        if (magnitude(std::int64_t{delta[axis]}) > reach) {
            return true;
        }
    }
    return false;
}

/// One look at a pair.
class PairLook {
public:
    PairLook(const DynamicsTables& tables,
             const BodyFrames& frames,
             const Foresight& foresight,
             ManifoldSlots& slots)
        : tables_(tables), frames_(frames), foresight_(foresight), slots_(slots) {}

    /// Looks for what the two will meet within `reach`, too. False where the manifold table is
    /// full. The pair then does not touch.
    bool visit(Pair& pair, std::int32_t reach);
    /// Whether the last visit gave the pair a manifold for this tick alone.
    bool is_foreseen() const { return is_foreseen_; }
    /// The pair does not touch.
    void release(Pair& pair);

private:
    bool is_still(const Pair& pair) const;
    bool are_apart(const Pair& pair, const std::int32_t delta[3]) const;
    void touch(const Pair& pair, const std::int32_t delta[3], ManifoldGeometry& geometry) const;
    bool meets_ahead(const Pair& pair,
                     std::int32_t reach,
                     std::int32_t delta[3],
                     ManifoldGeometry& geometry) const;
    void collide_parts(const Pair& pair,
                       const std::int32_t delta[3],
                       const ManifoldCache& cache,
                       ManifoldGeometry& geometry) const;
    void write_manifold(const Pair& pair,
                        const std::int32_t delta[3],
                        const ManifoldGeometry& geometry) const;

    const DynamicsTables& tables_;
    const BodyFrames& frames_;
    const Foresight& foresight_;
    ManifoldSlots& slots_;
    bool is_foreseen_ = false;
};

bool is_touching(const Pair& pair) {
    return pair.point_count != 0;
}

/// Q9.22 m: how far a body's turn may move a contact point before its manifold is made anew: an
/// eighth of the bounding radius; a very slender one's long axis must not leave the body by that.
std::int64_t turn_bound(const BodyProperties& body) {
    return body.bounding_radius >> (is_very_slender(body) ? 5 : 3);
}

/// True where no contact point has drifted or turned enough for its manifold to be made anew.
/// Keeping it is what lets tall stacks stand: the solver's rows then stay exactly the same.
bool PairLook::is_still(const Pair& pair) const {
    const BodyFrame& frame_a = frames_[pair.row_a];
    const BodyFrame& frame_b = frames_[pair.row_b];
    if (!is_touching(pair) || !is_flat(frame_a.shape) || !is_flat(frame_b.shape)) {
        return false;
    }
    const Manifold& manifold = tables_.manifolds[pair.manifold];
    std::int32_t delta[3];
    pair_delta(frame_a, frame_b, tables_.motion[pair.row_a], tables_.motion[pair.row_b], delta);
    // A fixed body does not turn.
    const BodyProperties& a = tables_.properties[pair.row_a];
    const BodyProperties& b = tables_.properties[pair.row_b];
    const TurnSince turn_of_a(frame_a, manifold.orientation_a, a.mode != kFixed);
    const TurnSince turn_of_b(frame_b, manifold.orientation_b, b.mode != kFixed);
    const std::int64_t turn_bound_a = turn_bound(a);
    const std::int64_t turn_bound_b = turn_bound(b);
    for (std::uint32_t point = 0; point < pair.point_count; ++point) {
        const std::int32_t* anchor_a = manifold.anchor_a + 3 * point;
        std::int32_t anchor_b[3];
        for (int axis = 0; axis < 3; ++axis) {
            anchor_b[axis] = raw_subtract(anchor_a[axis], manifold.centre_delta[axis]);
        }
        std::int64_t turn_a[3];
        std::int64_t turn_b[3];
        turn_of_a.move(anchor_a, turn_a);
        turn_of_b.move(anchor_b, turn_b);
        std::int64_t square = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t drift = std::int64_t{delta[axis]} - manifold.centre_delta[axis] +
                                       turn_b[axis] - turn_a[axis];
            if (magnitude(drift) > kDriftMax || magnitude(turn_a[axis]) > turn_bound_a ||
                magnitude(turn_b[axis]) > turn_bound_b) {
                return false;
            }
            square += drift * drift;
        }
        if (square > kDriftMax * kDriftMax) {
            return false;
        }
    }
    return true;
}

bool PairLook::are_apart(const Pair& pair, const std::int32_t delta[3]) const {
    const BodyFrame& a = frames_[pair.row_a];
    const BodyFrame& b = frames_[pair.row_b];
    if (!is_bounded(a.shape.type) || !is_bounded(b.shape.type)) {
        return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t reach =
            std::int64_t{a.half_extents[axis]} + b.half_extents[axis] + kSpeculativeMargin;
        if (magnitude(std::int64_t{delta[axis]}) > reach) {
            return true;
        }
    }
    return false;
}

void PairLook::release(Pair& pair) {
    if (is_touching(pair)) {
        slots_.free(tables_, pair.manifold);
    }
    pair.manifold = kNoIndex;
    pair.point_count = 0;
}

/// Turns the friction impulse (f_0 t_0 + f_1 t_1) into the frame of the new normal and tangent.
void turn_friction(const Manifold& manifold,
                   const std::int32_t normal[3],
                   const std::int32_t tangent[3],
                   std::int32_t friction[2]) {
    std::int32_t old_second[3];
    std::int32_t new_second[3];
    cross_units(manifold.normal, manifold.tangent, old_second);
    cross_units(normal, tangent, new_second);
    const std::int64_t first = friction[0];
    const std::int64_t second = friction[1];
    const auto turned = [&](const std::int32_t axis[3]) {
        const std::int64_t along = round_unit(dot_wide(manifold.tangent, axis));
        const std::int64_t across = round_unit(dot_wide(old_second, axis));
        return static_cast<std::int32_t>(round_unit_wide(first * along + second * across));
    };
    friction[0] = turned(tangent);
    friction[1] = turned(new_second);
}

void PairLook::write_manifold(const Pair& pair,
                              const std::int32_t delta[3],
                              const ManifoldGeometry& geometry) const {
    Manifold& manifold = tables_.manifolds[pair.manifold];
    ContactImpulse& impulse = tables_.impulses[pair.manifold];
    const Manifold old = manifold;
    const ContactImpulse borne = impulse;
    impulse = ContactImpulse{};
    std::copy(borne.friction, borne.friction + 2, impulse.friction);
    std::int32_t tangent[3];
    if (!is_touching(pair)) {
        tangent_of(geometry.normal, tangent);
    } else if (std::equal(geometry.normal, geometry.normal + 3, old.normal)) {
        std::copy(old.tangent, old.tangent + 3, tangent);
    } else {
        tangent_of(geometry.normal, tangent);
        turn_friction(old, geometry.normal, tangent, impulse.friction);
    }
    // A single point bears no twist.
    impulse.twist = geometry.point_count > 1 ? borne.twist : 0;
    manifold = Manifold{};
    manifold.row_a = pair.row_a;
    manifold.row_b = pair.row_b;
    manifold.child = pair.child;
    std::copy(geometry.normal, geometry.normal + 3, manifold.normal);
    std::copy(tangent, tangent + 3, manifold.tangent);
    std::copy(delta, delta + 3, manifold.centre_delta);
    copy_orientation(frames_[pair.row_a], manifold.orientation_a);
    copy_orientation(frames_[pair.row_b], manifold.orientation_b);
    manifold.axis_separation = geometry.axis_separation;
    manifold.point_count = static_cast<std::uint8_t>(geometry.point_count);
    manifold.axis = static_cast<std::uint8_t>(geometry.axis);
    std::uint32_t unmatched = (1U << pair.point_count) - 1;
    for (std::uint32_t point = 0; point < geometry.point_count; ++point) {
        const ManifoldPoint& fresh = geometry.points[point];
        manifold.separation[point] = fresh.separation;
        manifold.feature[point] = fresh.feature;
        rotate(frames_[pair.row_a].rotation, fresh.local_a, manifold.anchor_a + 3 * point);
        for (std::uint32_t former = 0; former < pair.point_count; ++former) {
            const std::uint32_t bit = 1U << former;
            if ((unmatched & bit) != 0 && old.feature[former] == fresh.feature) {
                impulse.normal[point] = borne.normal[former];
                unmatched &= ~bit;
                break;
            }
        }
    }
}

void PairLook::collide_parts(const Pair& pair,
                             const std::int32_t delta[3],
                             const ManifoldCache& cache,
                             ManifoldGeometry& geometry) const {
    const ShapeInstance& shape_a = frames_[pair.row_a].shape;
    const ShapeInstance& shape_b = frames_[pair.row_b].shape;
    geometry.point_count = 0;
    geometry.axis = 0;
    const PartIndices parts = parts_of(pair.child, is_surface(shape_b.type));
    if (!has_part(shape_a, parts.a) || !has_part(shape_b, parts.b)) {
        return;
    }
    const BodyPart a(shape_a, parts.a);
    const BodyPart b(shape_b, parts.b);
    std::int32_t between[3];
    for (int axis = 0; axis < 3; ++axis) {
        between[axis] = raw_saturate<std::int32_t>(std::int64_t{delta[axis]} + b.offset()[axis] -
                                                   a.offset()[axis]);
    }
    if (are_parts_apart(a.shape(), b.shape(), between)) {
        return;
    }
    collide(a.shape(), b.shape(), between, cache, geometry);
    if (geometry.point_count == 0) {
        return; // nor is there a normal
    }
    const std::int32_t* normal = geometry.normal;
    const std::int32_t back[3] = {-normal[0], -normal[1], -normal[2]};
    std::uint32_t kept = 0;
    for (std::uint32_t index = 0; index < geometry.point_count; ++index) {
        ManifoldPoint& point = geometry.points[index];
        a.to_body(point.local_a);
        b.to_body(point.local_b);
        const std::int32_t lift = point.separation >> 1;
        if (!a.is_at_seam(point.local_a, normal, lift) &&
            !b.is_at_seam(point.local_b, back, lift)) {
            geometry.points[kept++] = point;
        }
    }
    geometry.point_count = kept;
}

/// Where the two are; point_count 0 where they do not touch.
void PairLook::touch(const Pair& pair,
                     const std::int32_t delta[3],
                     ManifoldGeometry& geometry) const {
    ManifoldCache cache;
    cache.axis = pair.axis;
    cache.touching = is_touching(pair);
    cache.axis_separation =
        is_touching(pair) ? tables_.manifolds[pair.manifold].axis_separation : 0;
    if (pair.child == 0) {
        collide(frames_[pair.row_a].shape, frames_[pair.row_b].shape, delta, cache, geometry);
    } else {
        collide_parts(pair, delta, cache, geometry);
    }
}

/// Whether the two would meet in this tick if nothing else happened; `delta` is then from where.
bool PairLook::meets_ahead(const Pair& pair,
                           std::int32_t reach,
                           std::int32_t delta[3],
                           ManifoldGeometry& geometry) const {
    if (reach == 0 || pair.child != 0 || // parts are swept
        is_sensing(tables_.properties[pair.row_a], tables_.properties[pair.row_b])) {
        return false;
    }
    Foreseen ahead;
    foresee(frames_[pair.row_a].shape, frames_[pair.row_b].shape, delta, reach, ahead);
    geometry = ahead.geometry;
    return geometry.point_count != 0 && foresight_.closing(tables_.motion[pair.row_a],
                                                           tables_.motion[pair.row_b],
                                                           ahead.normal) +
                                                kSpeculativeMargin >
                                            ahead.way;
}

bool PairLook::visit(Pair& pair, std::int32_t reach) {
    is_foreseen_ = false;
    if (is_still(pair)) {
        return true;
    }
    std::int32_t delta[3];
    pair_delta(frames_[pair.row_a],
               frames_[pair.row_b],
               tables_.motion[pair.row_a],
               tables_.motion[pair.row_b],
               delta);
    ManifoldGeometry geometry;
    geometry.point_count = 0;
    if (!are_apart(pair, delta)) {
        touch(pair, delta, geometry);
        pair.axis = static_cast<std::uint8_t>(geometry.axis);
    }
    if (geometry.point_count == 0) {
        release(pair);
        is_foreseen_ = meets_ahead(pair, reach, delta, geometry);
        if (!is_foreseen_) {
            return true;
        }
    }
    if (!is_touching(pair)) {
        const std::uint32_t slot = slots_.take(tables_);
        if (slot == kNoIndex) {
            is_foreseen_ = false;
            return false;
        }
        pair.manifold = slot;
    }
    slots_.note_change(pair.manifold);
    write_manifold(pair, delta, geometry);
    pair.point_count = static_cast<std::uint8_t>(geometry.point_count);
    return true;
}

/// Damaged rows must not lead outside the tables.
bool is_sound(const Pair& pair, const DynamicsTables& tables) {
    if (pair.row_b >= tables.motion.count() || pair.row_a >= pair.row_b) {
        return false;
    }
    if (pair.point_count == 0) {
        return true;
    }
    return pair.point_count <= kManifoldPointsMax && pair.manifold < tables.manifolds.count();
}

bool has_plane_only(const Pair& pair, const BodyFrames& frames) {
    return !is_bounded(frames[pair.row_a].shape.type) && !is_bounded(frames[pair.row_b].shape.type);
}

} // namespace

void tangent_of(const std::int32_t normal[3], std::int32_t tangent[3]) {
    // The two components that leave out the smaller of x, z: their square sum is at least 1/3.
    constexpr std::int32_t kInverseRoot3 = 619925132; // Q2.30
    const bool leave_out_x = magnitude(normal[0]) < kInverseRoot3;
    const int first = leave_out_x ? 1 : 0;
    const int second = leave_out_x ? 2 : 1;
    const std::int64_t a = normal[second];
    const std::int64_t b = -std::int64_t{normal[first]};
    const auto length =
        static_cast<std::int64_t>(floor_sqrt(static_cast<std::uint64_t>(a * a + b * b)));
    const std::int64_t inverse = (std::int64_t{1} << 62) / std::max(length, std::int64_t{1});
    std::fill(tangent, tangent + 3, 0);
    tangent[first] = static_cast<std::int32_t>((a * inverse) >> 32);
    tangent[second] = static_cast<std::int32_t>((b * inverse) >> 32);
}

NarrowPhase::NarrowPhase(const DynamicsSettings& settings)
    : foresight_(settings), gates_(settings.body_capacity), joined_(settings.joint_capacity) {
    foreseen_.reserve(settings.manifold_capacity);
    changed_.reserve(settings.pair_capacity);
}

void NarrowPhase::read_gates(const DynamicsTables& tables,
                             const BodyFrames& frames,
                             std::span<const BodyRow> rows) {
    for (const BodyRow row : rows) {
        gates_[row] = {
            tables.sleep[row].moved, is_flat(frames[row].shape), foresight_.reach(tables, row)};
    }
}

bool NarrowPhase::needs_look(const Pair& pair) const {
    const Gate& a = gates_[pair.row_a];
    const Gate& b = gates_[pair.row_b];
    const bool bears_more = is_touching(pair) && a.flat && b.flat;
    const MotionBound bound = bears_more ? MotionBound::touching : MotionBound::other;
    return ((a.moved | b.moved) & bit_of(bound)) != 0 || (a.reach | b.reach) != 0;
}

/// How far ahead the two are to be looked for, Q9.22 m.
std::int32_t NarrowPhase::reach_of(const Pair& pair) const {
    const std::int64_t both = std::int64_t{gates_[pair.row_a].reach} + gates_[pair.row_b].reach;
    return static_cast<std::int32_t>(std::min(both, std::int64_t{foresight_.reach_max()}));
}

StepFault NarrowPhase::run(const DynamicsTables& tables,
                           const BodyFrames& frames,
                           const Activity& activity,
                           ManifoldSlots& slots,
                           std::vector<ContactChange>& changes) {
    joined_.read(tables.joints);
    read_gates(tables, frames, activity.rows());
    read_gates(tables, frames, activity.partners());
    PairLook look(tables, frames, foresight_, slots);
    foreseen_.clear();
    changed_.clear();
    StepFault fault = StepFault::none;
    for (const std::uint32_t index : activity.pairs()) {
        Pair& pair = tables.pairs[index];
        if (!is_sound(pair, tables)) {
            continue;
        }
        const Pair before = pair;
        bool touches = false;
        if (joined_.has(pair.row_a, pair.row_b)) {
            look.release(pair);
        } else if (!needs_look(pair) || has_plane_only(pair, frames)) {
            continue;
        } else {
            if (!look.visit(pair, reach_of(pair))) {
                fault = StepFault::manifolds_full;
            }
            touches = is_touching(pair) && !look.is_foreseen();
            if (look.is_foreseen()) {
                foreseen_.push_back(index);
            }
        }
        // What is foreseen is forgotten within the tick, and may look here as it did before.
        const bool is_foreseen = is_touching(pair) && !touches;
        if (pair != before || is_foreseen) {
            changed_.push_back(index);
        }
        if (touches != is_touching(before)) {
            changes.push_back({pair.row_a, pair.row_b, touches});
        }
    }
    for (const BodyRow row : activity.rows()) {
        tables.sleep[row].moved = 0;
    }
    slots.trim(tables);
    if (fault != StepFault::none) {
        foreseen_.clear(); // no phase follows
    }
    return fault;
}

void NarrowPhase::forget_foreseen(const DynamicsTables& tables, ManifoldSlots& slots) {
    if (foreseen_.empty()) {
        return;
    }
    slots.read(tables.manifolds);
    for (const std::uint32_t index : foreseen_) {
        Pair& pair = tables.pairs[index];
        if (!is_sound(pair, tables) || !is_touching(pair)) {
            continue;
        }
        slots.free(tables, pair.manifold);
        pair.manifold = kNoIndex;
        pair.point_count = 0;
    }
    slots.trim(tables);
    foreseen_.clear();
}

} // namespace lockwind
