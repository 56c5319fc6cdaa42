#pragma once

#include "dynamics/contact_block.h"
#include "dynamics/lanes.h"
#include "dynamics/step_constants.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace lockwind {

/// Push-out speed of overlapping bodies is at most 3 m/s.
inline constexpr std::int32_t kPushOutSpeedMax = 3 * kVelocityOne;
/// A gap counts for at most 960 m/s as s / h: no body closes it in a substep.
inline constexpr std::int32_t kSeparationMax = 960 * kVelocityOne;

/// A contact's normal impulse in a substep / reduced mass is at most 960 m/s: what a closing speed
/// of that takes, and what bears 24,000 times the mass of the lighter partner at 240 substeps a
/// second.
inline constexpr std::int32_t kImpulseMax = 960 * kVelocityOne;
/// Of that, 480 m/s count for friction, so that a coefficient of 4 stays in the format.
inline constexpr std::int32_t kFrictionLoadMax = 480 * kVelocityOne;

/// Where a body is wild, speeds count for at most this, so that a separation or an impulse more
/// fits the format.
inline constexpr std::int32_t kRowSpeedMax = 1080 * kVelocityOne;
/// The same of what a coefficient of up to 8 is to multiply: a twist, the first tangent's impulse;
/// and of what bears on a lever of up to 7.5.
inline constexpr std::int32_t kTwistSpeedMax = 128 * kVelocityOne;
inline constexpr std::int32_t kLeverLoadMax = 256 * kVelocityOne;

/// Separating speeds of a block's points, Q11.20 m/s.
struct alignas(64) PointSpeeds {
    std::int32_t at[kBlockPoints][kBlockLanes];
};

/// The passes over one block's lanes from `first`, for contacts of kPoints points; in wider lanes,
/// contacts that have fewer bear null rows. kHolds: contacts of wild bodies are held within the
/// formats where many forces together might leave them. kCentral: normal forces turn no body; their
/// rows are (-n, 0, n, 0), with a mass of one, and are not read.
template <class L, std::uint32_t kPoints, bool kHolds, bool kCentral = false>
class BlockSolver {
    static_assert(!kCentral || kPoints == 1);

public:
    using Vector = typename L::Vector;
    using Wide = typename L::Wide;

    BlockSolver(ContactBlock& block, SolverBody* bodies, int first, Halves halves)
        : block_(block), bodies_(bodies), first_(first),
          half_(L::template start<kCoefficientFraction>(halves)) {}

    /// Applies the impulses that the contacts brought from the tick before.
    [[gnu::always_inline]] void warm_start() {
        read_velocities();
        Vector impulse[kPoints];
        LOCKWIND_UNROLL
        for (std::uint32_t point = 0; point < kPoints; ++point) {
            impulse[point] = lane(block_.point[point].impulse);
        }
        apply_normal(impulse);
        apply_tangent(lane(block_.friction_impulse[0]), lane(block_.friction_impulse[1]));
        if constexpr (kPoints > 1) {
            apply_twist(lane(block_.twist_impulse));
        }
        write_velocities();
    }

    /// Normal rows with their soft bias.
    [[gnu::always_inline]] void solve() {
        read_velocities<kTurns>();
        const Wide along = speed_along(linear_);
        Vector applied[kPoints];
        LOCKWIND_UNROLL
        for (std::uint32_t point = 0; point < kPoints; ++point) {
            const ContactBlock::Point& p = block_.point[point];
            const Vector separation = lane(p.separation);
            const Vector old = lane(p.impulse);
            const Vector v = coupled_speed(speed_at(point, along, angular_), applied, point);
            const Vector open = L::add(v, separation);
            const Vector bias =
                L::maximum(scale(separation, factor(block_.bias_rate)), L::set(-kPushOutSpeedMax));
            const Vector pressed = L::add(scale(v, factor(block_.mass_scale)), bias);
            const Vector lost =
                L::add(answer(L::select_positive(separation, open, pressed), p.row),
                       L::select_positive(
                           separation, L::set(0), scale(old, factor(block_.impulse_scale))));
            applied[point] = accumulate(point, old, lost);
        }
        apply_normal(applied);
        write_velocities<kTurns>();
    }

    /// After the position step: moves the separations on, removes what the bias added to the
    /// velocities, then twist and friction.
    [[gnu::always_inline]] void relax() {
        read_velocities();
        const Wide along = speed_along(linear_);
        Velocities linear_moved;
        Velocities angular_moved;
        read_moved(linear_moved, angular_moved);
        const Wide along_moved = speed_along(linear_moved);
        Vector applied[kPoints];
        Vector load = L::set(0);
        Vector twist_load = L::set(0);
        LOCKWIND_UNROLL
        for (std::uint32_t point = 0; point < kPoints; ++point) {
            ContactBlock::Point& p = block_.point[point];
            // What adds up over the substeps must stay in the format, with a speed more.
            const Vector separation =
                L::clamp(L::add(lane(p.separation), speed_at(point, along_moved, angular_moved)),
                         L::set(-kSeparationMax),
                         L::set(kSeparationMax));
            L::store(p.separation + first_, separation);
            const Vector old = lane(p.impulse);
            const Vector v = coupled_speed(speed_at(point, along, angular_), applied, point);
            const Vector lost = answer(L::add(v, L::maximum(separation, L::set(0))), p.row);
            applied[point] = accumulate(point, old, lost);
            const Vector now = L::add(old, applied[point]);
            load = L::add(load, now);
            if constexpr (kPoints > 1) { // one point has no lever
                twist_load =
                    L::add(twist_load, loaded(scale(held(now, kLeverLoadMax), factor(p.lever))));
            }
        }
        apply_normal(applied);
        const Factor friction = factor(block_.friction);
        if constexpr (kPoints > 1) {
            relax_twist(friction_limit(twist_load, friction));
        }
        relax_friction(friction_limit(load, friction));
        write_velocities();
    }

    /// Separating speeds of the points at the bodies' present velocities; of those that a contact
    /// does not have, anything.
    void read_speeds(PointSpeeds& out) {
        read_velocities();
        const Wide along = speed_along(linear_);
        LOCKWIND_UNROLL
        for (std::uint32_t point = 0; point < kPoints; ++point) {
            L::store(out.at[point] + first_, speed_at(point, along, angular_));
        }
    }

    /// Brings one point to a separating speed by an impulse that leaves `carried` + impulse >= 0;
    /// returns the impulse. Scalar lanes only.
    std::int32_t reach_speed(int point, std::int32_t target, std::int32_t carried) {
        read_velocities();
        const std::int32_t speed =
            speed_at(static_cast<std::uint32_t>(point), speed_along(linear_), angular_);
        const std::int32_t missing = held(
            L::subtract(speed, std::clamp(target, -kSeparationMax, kSeparationMax)), kRowSpeedMax);
        const std::int32_t lost = answer(missing, block_.point[point].row);
        std::int32_t applied[kPoints] = {};
        applied[point] = L::subtract(L::maximum(L::subtract(carried, lost), 0), carried);
        apply_normal(applied);
        write_velocities();
        return applied[point];
    }

private:
    using Factor = typename L::Factor;
    /// Whether normal rows need the angular velocities; what holds them holds all at once.
    static constexpr bool kTurns = !kCentral || kHolds;

    struct Velocities {
        Vector a[4]; // xyz and the row's filling
        Vector b[4];
    };

    SolverBody& body_a(int lane) const { return bodies_[block_.row_a[lane]]; }
    SolverBody& body_b(int lane) const { return bodies_[block_.row_b[lane]]; }

    [[gnu::always_inline]] Vector lane(const std::int32_t (&lanes)[kBlockLanes]) const {
        return L::load(lanes + first_);
    }
    [[gnu::always_inline]] Factor factor(const std::int32_t (&lanes)[kBlockLanes]) const {
        return L::load_factor(lanes + first_);
    }
    template <class Coefficient>
    Vector scale(Vector velocity, const Coefficient& coefficient) const {
        return finish(L::add_product(start(), velocity, coefficient));
    }

    /// A normal row's impulse against a speed.
    [[gnu::always_inline]] Vector answer(Vector speed, const ContactBlock::Row& row) const {
        if constexpr (kCentral) {
            return speed;
        } else {
            return scale(speed, factor(row.mass));
        }
    }

    /// Positive where one of the two bodies is wild.
    [[gnu::always_inline]] Vector wild() const {
        return L::maximum(L::maximum(linear_.a[kWildEntry], linear_.b[kWildEntry]), L::set(0));
    }
    /// Within +-most, of a contact that has a wild body.
    [[gnu::always_inline]] Vector held(Vector value, std::int32_t most) const {
        if constexpr (!kHolds) {
            return value;
        }
        using Limits = std::numeric_limits<std::int32_t>;
        const Vector is_wild = wild();
        return L::clamp(value,
                        L::select_positive(is_wild, L::set(-most), L::set(Limits::min())),
                        L::select_positive(is_wild, L::set(most), L::set(Limits::max())));
    }

    /// finish() of a sum, within +-kRowSpeedMax of a contact that has a wild body.
    [[gnu::always_inline]] Vector held_finish(Wide sum) const {
        if constexpr (!kHolds) {
            return finish(sum);
        } else if constexpr (L::kWidth == 1) { // so that nothing is made that leaves the format
            return wild() > 0 ? L::template round_within<kCoefficientFraction>(sum, kRowSpeedMax)
                              : finish(sum);
        } else {
            return L::select_positive(
                wild(),
                L::template round_within<kCoefficientFraction>(sum, kRowSpeedMax),
                finish(sum));
        }
    }
    /// What Coulomb's law allows under a load.
    [[gnu::always_inline]] Vector friction_limit(Vector load, const Factor& friction) const {
        return held(scale(loaded(load), friction), kImpulseMax);
    }
    static Vector loaded(Vector load) { return L::minimum(load, L::set(kFrictionLoadMax)); }
    Wide start() const { return half_; }
    static Vector finish(Wide sum) { return L::template round<kCoefficientFraction>(sum); }

    template <bool kAngular = true>
    [[gnu::always_inline]] void read_velocities() {
        L::gather_quad(
            first_, [&](int lane) { return body_a(lane).linear; }, linear_.a);
        L::gather_quad(
            first_, [&](int lane) { return body_b(lane).linear; }, linear_.b);
        if constexpr (kAngular) {
            L::gather_quad(
                first_, [&](int lane) { return body_a(lane).angular; }, angular_.a);
            L::gather_quad(
                first_, [&](int lane) { return body_b(lane).angular; }, angular_.b);
        }
        if constexpr (kHolds) {
            hold_velocities();
        }
    }
    [[gnu::always_inline]] void hold(Velocities& velocities, std::int32_t most) const {
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            velocities.a[axis] = held(velocities.a[axis], most);
            velocities.b[axis] = held(velocities.b[axis], most);
        }
    }
    [[gnu::always_inline]] void hold_velocities() {
        hold(linear_, kLinearHeld);
        hold(angular_, kAngularHeld);
    }
    /// What a wild body throws is wild from here on.
    [[gnu::always_inline]] void pass_wildness_on() {
        const Vector is_wild = wild();
        linear_.a[kWildEntry] =
            L::select_positive(lane(block_.share_a), is_wild, linear_.a[kWildEntry]);
        linear_.b[kWildEntry] =
            L::select_positive(lane(block_.share_b), is_wild, linear_.b[kWildEntry]);
    }
    template <bool kAngular = true>
    [[gnu::always_inline]] void write_velocities() {
        if constexpr (kHolds) {
            hold_velocities();
            pass_wildness_on();
        }
        L::scatter_quad(first_, linear_.a, [&](int lane) { return body_a(lane).linear; });
        L::scatter_quad(first_, linear_.b, [&](int lane) { return body_b(lane).linear; });
        if constexpr (kAngular) {
            L::scatter_quad(first_, angular_.a, [&](int lane) { return body_a(lane).angular; });
            L::scatter_quad(first_, angular_.b, [&](int lane) { return body_b(lane).angular; });
        }
    }

    /// The linear velocities' part of J v, the same of all points.
    [[gnu::always_inline]] Wide speed_along(const Velocities& linear) const {
        Wide along = start();
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            along = L::add_product(
                along, L::subtract(linear.b[axis], linear.a[axis]), factor(block_.normal[axis]));
        }
        return along;
    }
    /// A point's separating speed J v, held to kRowSpeedMax.
    [[gnu::always_inline]] Vector
    speed_at(std::uint32_t point, Wide along, const Velocities& angular) const {
        if constexpr (!kCentral) {
            const ContactBlock::Row& row = block_.point[point].row;
            LOCKWIND_UNROLL
            for (int axis = 0; axis < 3; ++axis) {
                along = L::add_product(along, angular.a[axis], factor(row.jacobian_a[axis]));
                along = L::add_product(along, angular.b[axis], factor(row.jacobian_b[axis]));
            }
        }
        return held_finish(along);
    }
    /// The velocities that moved the bodies: their J v is the change of s / h.
    [[gnu::always_inline]] void read_moved(Velocities& linear, Velocities& angular) const {
        L::gather_quad(
            first_, [&](int lane) { return body_a(lane).linear_moved; }, linear.a);
        L::gather_quad(
            first_, [&](int lane) { return body_b(lane).linear_moved; }, linear.b);
        if constexpr (!kCentral) {
            L::gather_quad(
                first_, [&](int lane) { return body_a(lane).angular_moved; }, angular.a);
            L::gather_quad(
                first_, [&](int lane) { return body_b(lane).angular_moved; }, angular.b);
        }
    }

    /// A point's speed after what the points before it applied.
    Vector
    coupled_speed(Vector speed, const Vector (&applied)[kPoints], std::uint32_t point) const {
        if (point == 0) {
            return speed;
        }
        Wide sum = start();
        LOCKWIND_UNROLL
        for (std::uint32_t other = 0; other < point; ++other) {
            const int index = coupling_index(static_cast<int>(point), static_cast<int>(other));
            sum = L::add_product(sum, applied[other], factor(block_.coupling[index]));
        }
        return held(L::add(speed, held_finish(sum)), kRowSpeedMax);
    }
    [[gnu::always_inline]] Vector accumulate(std::uint32_t point, Vector old, Vector lost) {
        const Vector now = L::clamp(L::subtract(old, lost), L::set(0), lane(block_.impulse_max));
        L::store(block_.point[point].impulse + first_, now);
        return L::subtract(now, old);
    }

    /// Applies impulses at once, or in parts of which none leaves the formats: a wild body is held
    /// after each.
    template <std::uint32_t kCount, class Apply>
    [[gnu::always_inline]] void apply(const Vector (&impulses)[kCount], Apply&& add) {
        if constexpr (!kHolds) {
            add(impulses);
            return;
        }
        const Vector is_wild = wild();
        Vector rest[kCount];
        std::copy_n(impulses, kCount, rest);
        for (int left = 16; left > 0; --left) {
            Vector part[kCount];
            for (std::uint32_t index = 0; index < kCount; ++index) {
                const Vector sixteenth = L::template shift_right<4>(impulses[index]);
                part[index] =
                    left == 1 ? rest[index] : L::select_positive(is_wild, sixteenth, rest[index]);
                rest[index] = L::subtract(rest[index], part[index]);
            }
            add(part);
            hold_velocities();
        }
    }
    [[gnu::always_inline]] void apply_normal(const Vector (&impulses)[kPoints]) {
        apply(
            impulses, [&](const Vector(&part)[kPoints]) __attribute__((always_inline)) {
                add_normal(part);
            });
    }
    [[gnu::always_inline]] void apply_tangent(Vector first, Vector second) {
        const Vector impulses[2] = {first, second};
        apply(
            impulses, [&](const Vector(&part)[2]) __attribute__((always_inline)) {
                add_tangent(part[0], part[1]);
            });
    }
    [[gnu::always_inline]] void apply_twist(Vector impulse) {
        const Vector impulses[1] = {impulse};
        apply(
            impulses, [&](const Vector(&part)[1]) __attribute__((always_inline)) {
                add_twist(part[0]);
            });
    }

    /// Changes the linear velocities by what along(share, out) makes of a body's share.
    template <class Along>
    [[gnu::always_inline]] void push(Along&& along) {
        Vector change[3];
        along(factor(block_.share_b), change);
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            linear_.b[axis] = L::add(linear_.b[axis], change[axis]);
        }
        // Equal masses are frequent, and one lane is not to be multiplied twice.
        if (L::kWidth > 1 || block_.share_a[first_] != block_.share_b[first_]) {
            along(factor(block_.share_a), change);
        }
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            linear_.a[axis] = L::subtract(linear_.a[axis], change[axis]);
        }
    }

    [[gnu::always_inline]] void add_normal(const Vector (&impulse)[kPoints]) {
        Vector total = impulse[0];
        LOCKWIND_UNROLL
        for (std::uint32_t point = 1; point < kPoints; ++point) {
            total = L::add(total, impulse[point]);
        }
        push([&](const Factor& share, Vector(&out)[3]) __attribute__((always_inline)) {
            const Vector part = scale(total, share);
            LOCKWIND_UNROLL
            for (int axis = 0; axis < 3; ++axis) {
                out[axis] = scale(part, factor(block_.normal[axis]));
            }
        });
        if constexpr (!kCentral) {
            turn(impulse);
        }
    }

    /// The angular part of normal impulses.
    [[gnu::always_inline]] void turn(const Vector (&impulse)[kPoints]) {
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            Wide sum_a = start();
            Wide sum_b = start();
            LOCKWIND_UNROLL
            for (std::uint32_t point = 0; point < kPoints; ++point) {
                const ContactBlock::Row& row = block_.point[point].row;
                sum_a = L::add_product(sum_a, impulse[point], factor(row.response_a[axis]));
                sum_b = L::add_product(sum_b, impulse[point], factor(row.response_b[axis]));
            }
            angular_.a[axis] = L::add(angular_.a[axis], finish(sum_a));
            angular_.b[axis] = L::add(angular_.b[axis], finish(sum_b));
        }
    }

    [[gnu::always_inline]] void add_tangent(Vector first, Vector second) {
        const ContactBlock::Row& row_0 = block_.tangent_row[0];
        const ContactBlock::Row& row_1 = block_.tangent_row[1];
        const auto sum_of = [this](Vector x, const Factor& by_x, Vector y, const Factor& by_y) {
            return finish(L::add_product(L::add_product(start(), x, by_x), y, by_y));
        };
        push([&](const Factor& share, Vector(&out)[3]) __attribute__((always_inline)) {
            const Vector parts[2] = {scale(first, share), scale(second, share)};
            LOCKWIND_UNROLL
            for (int axis = 0; axis < 3; ++axis) {
                out[axis] = sum_of(parts[0],
                                   factor(block_.tangent[0][axis]),
                                   parts[1],
                                   factor(block_.tangent[1][axis]));
            }
        });
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            angular_.a[axis] = L::add(
                angular_.a[axis],
                sum_of(
                    first, factor(row_0.response_a[axis]), second, factor(row_1.response_a[axis])));
            angular_.b[axis] = L::add(
                angular_.b[axis],
                sum_of(
                    first, factor(row_0.response_b[axis]), second, factor(row_1.response_b[axis])));
        }
    }

    [[gnu::always_inline]] void add_twist(Vector impulse) {
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            angular_.a[axis] =
                L::add(angular_.a[axis], scale(impulse, factor(block_.twist_response_a[axis])));
            angular_.b[axis] =
                L::add(angular_.b[axis], scale(impulse, factor(block_.twist_response_b[axis])));
        }
    }

    [[gnu::always_inline]] void relax_twist(Vector limit) {
        Wide spin_a = start();
        Wide spin_b = start();
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            const Factor normal = factor(block_.normal[axis]);
            spin_a = L::add_product(spin_a, angular_.a[axis], normal);
            spin_b = L::add_product(spin_b, angular_.b[axis], normal);
        }
        const Vector speed =
            held(held_finish(L::add_product(
                     L::add_product(start(), finish(spin_a), factor(block_.twist_lever_a)),
                     finish(spin_b),
                     factor(block_.twist_lever_b))),
                 kTwistSpeedMax);
        const Vector old = lane(block_.twist_impulse);
        const Vector now = L::clamp(
            L::subtract(old, scale(speed, factor(block_.twist_mass))), L::negate(limit), limit);
        L::store(block_.twist_impulse + first_, now);
        apply_twist(L::subtract(now, old));
    }

    [[gnu::always_inline]] void relax_friction(Vector limit) {
        Wide sum[2] = {start(), start()};
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            const Vector sliding = L::subtract(linear_.b[axis], linear_.a[axis]);
            LOCKWIND_UNROLL
            for (int which = 0; which < 2; ++which) {
                const ContactBlock::Row& row = block_.tangent_row[which];
                sum[which] =
                    L::add_product(sum[which], sliding, factor(block_.tangent[which][axis]));
                sum[which] =
                    L::add_product(sum[which], angular_.a[axis], factor(row.jacobian_a[axis]));
                sum[which] =
                    L::add_product(sum[which], angular_.b[axis], factor(row.jacobian_b[axis]));
            }
        }
        const Vector old_0 = lane(block_.friction_impulse[0]);
        const Vector old_1 = lane(block_.friction_impulse[1]);
        const Vector speed_0 =
            held(L::add(held_finish(sum[0]), lane(block_.surface_speed[0])), kRowSpeedMax);
        const Vector lost_0 = scale(speed_0, factor(block_.tangent_row[0].mass));
        // The first row's impulse changes the second one's speed.
        const Vector alone_1 =
            held(L::add(held_finish(sum[1]), lane(block_.surface_speed[1])), kImpulseMax);
        const Vector speed_1 =
            held(L::subtract(alone_1,
                             scale(held(lost_0, kTwistSpeedMax), factor(block_.tangent_coupling))),
                 kRowSpeedMax);
        Vector now_0 = L::subtract(old_0, lost_0);
        Vector now_1 = L::subtract(old_1, scale(speed_1, factor(block_.tangent_row[1].mass)));
        L::clamp_to_cone(now_0, now_1, limit);
        L::store(block_.friction_impulse[0] + first_, now_0);
        L::store(block_.friction_impulse[1] + first_, now_1);
        apply_tangent(L::subtract(now_0, old_0), L::subtract(now_1, old_1));
    }

    ContactBlock& block_;
    SolverBody* bodies_;
    int first_;
    Wide half_; // see Halves
    Velocities linear_;
    Velocities angular_;
};

} // namespace lockwind
