#pragma once

#include "dynamics/contact.h"
#include "dynamics/contact_block.h"
#include "dynamics/lanes.h"

#include <algorithm>
#include <cstdint>

namespace lockwind {

/// Constants of a contact that need divisions or tables, by lane; made one by one.
struct PairTerms {
    const Manifold* manifold[kBlockLanes];
    const BodyTerms* body_a[kBlockLanes];
    const BodyTerms* body_b[kBlockLanes];
    std::int32_t centre_delta[3][kBlockLanes];     // Q9.22 m, now
    std::int32_t surface_velocity[3][kBlockLanes]; // Q11.20 m/s, world: B's less A's
    std::int32_t inverse_radius_min[kBlockLanes];  // Q7.24 1/m: of the smaller gyration radius
    std::int32_t lever_max[kBlockLanes];           // Q9.22 m: 7.5 of the smaller gyration radius
    std::int32_t overreach_a[kBlockLanes];         // 1 or 0, see Overreach
    std::int32_t overreach_b[kBlockLanes];
};

/// Fills the rows of a block from its contacts' manifolds and bodies: normal rows, their couplings,
/// the friction centre, two tangent rows and the twist row. The block's shares, friction, softness
/// and twist levers are already there. Rows that it still has from the tick before, made from the
/// same, stay: of bodies that rest, most do.
template <class L>
class BlockPreparation {
public:
    using Vector = typename L::Vector;

    BlockPreparation(const PairTerms& terms, RowInputs& inputs, ContactBlock& block, int first)
        : terms_(terms), inputs_(inputs), block_(block), first_(first),
          points_(static_cast<std::uint32_t>(L::kWidth == 1 ? block.point_count[first]
                                                            : block.point_count_max)),
          does_any_overreach_(any(terms.overreach_a) || any(terms.overreach_b)) {}

    void run(std::int32_t substep_rate, std::int32_t separation_max) {
        load();
        turn_back(rotation(body_a_), orientation_a_, normal_then_a_);
        turn_back(rotation(body_b_), orientation_b_, normal_then_b_);
        LOCKWIND_UNROLL
        for (std::uint32_t point = 0; point < points_; ++point) {
            make_separation(point, substep_rate, separation_max);
        }
        if (is_known()) {
            return;
        }
        make_axes();
        if (!block_.is_central) {
            LOCKWIND_UNROLL
            for (std::uint32_t point = 0; point < points_; ++point) {
                make_normal_row(point);
            }
        }
        // Contacts of one point have their friction there, and resist no twist.
        const bool has_patch = block_.point_count_max > 1;
        if (has_patch) {
            find_friction_centre();
            make_levers();
            make_twist_row();
        } else {
            std::copy_n(arm_a_[0], 3, centre_a_);
            std::copy_n(arm_b_[0], 3, centre_b_);
        }
        make_tangent_row(0);
        make_tangent_row(1);
    }

private:
    using Wide = typename L::Wide;
    struct Jacobian {
        Vector a[3];
        Vector b[3];
    };

    Vector lane(const std::int32_t (&lanes)[kBlockLanes]) const { return L::load(lanes + first_); }
    void set_lane(std::int32_t (&lanes)[kBlockLanes], Vector value) const {
        L::store(lanes + first_, value);
    }
    /// The lanes' four values from `source` of their manifolds on.
    template <class Source>
    void read_manifolds(Source&& source, Vector* out) const {
        L::gather_quad(
            first_, [&](int lane) { return source(*terms_.manifold[lane]); }, out);
    }
    /// The lanes' coordinates of all points; those past points_ are not read.
    template <class Source>
    void read_points(Source&& source, Vector* out) const {
        for (std::uint32_t entry = 0; entry < 3 * points_; entry += 4) {
            read_manifolds([&](const Manifold& m) { return source(m) + entry; }, out + entry);
        }
    }
    /// `value`, or 0 in the lanes that do not have this point.
    Vector of_point(std::uint32_t point, Vector value) const {
        if constexpr (L::kWidth == 1) {
            return value;
        }
        const Vector exists =
            L::subtract(lane(block_.point_count), L::set(static_cast<std::int32_t>(point)));
        return L::select_positive(exists, value, L::set(0));
    }

    /// Whether one of this preparation's lanes is set.
    bool any(const std::int32_t (&lanes)[kBlockLanes]) const {
        return std::any_of(lanes + first_, lanes + first_ + L::kWidth, [](std::int32_t lane) {
            return lane != 0;
        });
    }

    static Wide add_dot(Wide sum, const Vector a[3], const Vector b[3]) {
        return L::add_product(
            L::add_product(L::add_product(sum, a[0], b[0]), a[1], b[1]), a[2], b[2]);
    }
    template <int Shift>
    static Vector dot(const Vector a[3], const Vector b[3]) {
        return L::template round<Shift>(add_dot(L::template start<Shift>(), a, b));
    }
    static void cross(const Vector a[3], const Vector b[3], Vector out[3]) {
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            const int next = (axis + 1) % 3;
            const int last = (axis + 2) % 3;
            const Wide sum = L::add_product(L::template start<kUnitFraction>(), a[next], b[last]);
            out[axis] =
                L::template round<kUnitFraction>(L::add_product(sum, L::negate(a[last]), b[next]));
        }
    }
    /// (arm / gyration radius) x direction, Q3.28.
    static void lever_row(const Vector arm[3],
                          Vector inverse_radius,
                          const Vector direction[3],
                          Vector out[3]) {
        Vector scaled[3];
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            scaled[axis] = L::template multiply<kLengthFraction + kEffectiveMassFraction -
                                                kCoefficientFraction>(arm[axis], inverse_radius);
        }
        cross(scaled, direction, out);
    }
    /// inverse inertia x row x share
    static void respond(const Vector inertia[6], const Vector row[3], Vector share, Vector out[3]) {
        constexpr int kIndex[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
        if constexpr (L::kWidth == 1) {
            // Cubes, spheres and fixed bodies: the products that are 0 are left out.
            if ((inertia[1] | inertia[2] | inertia[4]) == 0) {
                LOCKWIND_UNROLL
                for (int axis = 0; axis < 3; ++axis) {
                    out[axis] = L::template multiply<kCoefficientFraction>(
                        L::template multiply<kInertiaFraction>(inertia[kIndex[axis][axis]],
                                                               row[axis]),
                        share);
                }
                return;
            }
        }
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            Wide sum = L::template start<kInertiaFraction>();
            LOCKWIND_UNROLL
            for (int column = 0; column < 3; ++column) {
                sum = L::add_product(sum, inertia[kIndex[axis][column]], row[column]);
            }
            out[axis] = L::template multiply<kCoefficientFraction>(
                L::template round<kInertiaFraction>(sum), share);
        }
    }
    /// 1 / K in Q3.28 of K - linear in Q7.24; `sum` has the angular part in Q8.56.
    static Vector effective_mass(std::int32_t linear, Wide sum) {
        constexpr int kShift = 2 * kCoefficientFraction - kEffectiveMassFraction;
        // Below 1/8 the quotient would leave Q3.28.
        const Vector least = L::set((1 << (kEffectiveMassFraction - 3)) + 1);
        const Vector k = L::add(L::set(linear), L::template round<kShift>(sum));
        return L::template reciprocal<kEffectiveMassFraction + kCoefficientFraction>(
            L::maximum(k, least));
    }

    /// How fast a row's impulse of one drives another, Q8.56; without what the linear parts add.
    Wide couple(const Jacobian& jacobian, const ContactBlock::Row& row, Wide sum) const {
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            sum = L::add_product(sum, jacobian.a[axis], lane(row.response_a[axis]));
            sum = L::add_product(sum, jacobian.b[axis], lane(row.response_b[axis]));
        }
        return sum;
    }

    // The parts of BodyTerms.
    static const Vector* rotation(const Vector* body) { return body; }
    static const Vector* inertia(const Vector* body) { return body + 9; }
    static Vector inverse_radius(const Vector* body) { return body[15]; }

    void load();
    void turn_back(const Vector rotation[9], const Vector orientation[4], Vector out[3]) const;
    void make_separation(std::uint32_t point, std::int32_t rate, std::int32_t separation_max);
    bool is_known();
    void make_axes();
    void fill_row(const Jacobian& jacobian, ContactBlock::Row& row);
    void hold_arm(const Vector body[kBodyTermCount],
                  Vector overreach,
                  const Vector along[3],
                  Vector arm[3]) const;
    void hold_coupling(const ContactBlock::Row& other, Jacobian& jacobian) const;
    Jacobian jacobian_of(const Vector arm_a[3], const Vector arm_b[3], const Vector along[3]) const;
    void make_normal_row(std::uint32_t point);
    void find_friction_centre();
    void make_levers();
    void make_tangent_row(int which);
    void make_twist_row();

    const PairTerms& terms_;
    RowInputs& inputs_;
    ContactBlock& block_;
    int first_;
    std::uint32_t points_;
    bool does_any_overreach_;

    Vector axes_[3][4]; // normal, first tangent, second tangent, Q2.30; xyz and what lies behind
    Vector delta_when_made_[4];
    Vector separation_when_made_[kBlockPoints];
    Vector orientation_a_[4];
    Vector orientation_b_[4];
    Vector normal_then_a_[3]; // the normal, turned with A from now back to then
    Vector normal_then_b_[3];
    Vector anchor_a_[3 * kBlockPoints];
    Vector share_a_;
    Vector share_b_;
    Vector body_a_[kBodyTermCount];
    Vector body_b_[kBodyTermCount];
    Vector arm_a_[kBlockPoints][3]; // Q9.22 m, world, as when the manifold was made
    Vector arm_b_[kBlockPoints][3];
    Vector weight_[kBlockPoints]; // in the friction centre, Q3.28
    Vector centre_a_[3];
    Vector centre_b_[3];
};

template <class L>
void BlockPreparation<L>::load() {
    read_manifolds([](const Manifold& m) { return m.normal; }, axes_[0]);
    read_manifolds([](const Manifold& m) { return m.tangent; }, axes_[1]);
    read_manifolds([](const Manifold& m) { return m.centre_delta; }, delta_when_made_);
    read_manifolds([](const Manifold& m) { return m.separation; }, separation_when_made_);
    read_manifolds([](const Manifold& m) { return m.orientation_a; }, orientation_a_);
    read_manifolds([](const Manifold& m) { return m.orientation_b; }, orientation_b_);
    read_points([](const Manifold& m) { return m.anchor_a; }, anchor_a_);
    share_a_ = lane(block_.share_a);
    share_b_ = lane(block_.share_b);
    LOCKWIND_UNROLL
    for (int entry = 0; entry < kBodyTermCount; entry += 4) {
        L::gather_quad(
            first_, [&](int lane) { return terms_.body_a[lane]->entry + entry; }, body_a_ + entry);
        L::gather_quad(
            first_, [&](int lane) { return terms_.body_b[lane]->entry + entry; }, body_b_ + entry);
    }
}

/// The normal as it lay when the manifold was made, to a body that has turned with it since: into
/// the body's frame as it is, and out of the frame as it was. With it an anchor of then tells how
/// high it is now, without being turned itself.
template <class L>
void BlockPreparation<L>::turn_back(const Vector rotation[9],
                                    const Vector orientation[4],
                                    Vector out[3]) const {
    Vector local[3];
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        const Vector column[3] = {rotation[axis], rotation[3 + axis], rotation[6 + axis]};
        local[axis] = dot<kUnitFraction>(column, axes_[0]);
    }
    // v + 2 (w (q x v) + q x (q x v)); doubled by the shift.
    Vector side[3];
    cross(orientation, local, side);
    constexpr int kShift = kUnitFraction - 1;
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        const int next = (axis + 1) % 3;
        const int last = (axis + 2) % 3;
        Wide sum = L::add_product(L::template start<kShift>(), local[axis], L::set(1 << kShift));
        sum = L::add_product(sum, orientation[3], side[axis]);
        sum = L::add_product(sum, orientation[next], side[last]);
        sum = L::add_product(sum, L::negate(orientation[last]), side[next]);
        out[axis] = L::template round<kShift>(sum);
    }
}

/// How far apart the surfaces are now, as a velocity that closes it in a substep; and the arms.
template <class L>
void BlockPreparation<L>::make_separation(std::uint32_t point,
                                          std::int32_t rate,
                                          std::int32_t separation_max) {
    const Vector* anchor_a = anchor_a_ + 3 * point;
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        arm_a_[point][axis] = anchor_a[axis];
        // 0 in the lanes that do not have this point, so that all its arms are 0.
        arm_b_[point][axis] =
            L::subtract(arm_a_[point][axis], of_point(point, delta_when_made_[axis]));
    }
    Wide apart = L::template start<kUnitFraction>();
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        apart = L::add_product(apart, axes_[0][axis], lane(terms_.centre_delta[axis]));
        apart = L::add_product(apart, normal_then_b_[axis], arm_b_[point][axis]);
        apart = L::add_product(apart, normal_then_a_[axis], L::negate(arm_a_[point][axis]));
    }
    const Vector base = separation_when_made_[point];
    // Bounded before the change of unit, which multiplies by up to 960.
    const Vector separation = L::clamp(L::add(base, L::template round<kUnitFraction>(apart)),
                                       L::set(-separation_max),
                                       L::set(separation_max));
    set_lane(block_.point[point].separation,
             L::template multiply<kLengthFraction - kVelocityFraction>(separation, L::set(rate)));
    // Weight clamp(2 - separation / 20 mm, 1/16, 1): open points bear little friction.
    const Vector open = L::clamp(separation, L::set(0), L::set(2 * kSpeculativeMargin));
    const Vector weight = L::subtract(L::set(2 * kCoefficientOne),
                                      L::template multiply<1>(open, L::set(50 * 64 * 2)));
    weight_[point] =
        of_point(point, L::clamp(weight, L::set(kCoefficientOne / 16), L::set(kCoefficientOne)));
}

/// Whether the block has the rows of these contacts; notes what they are made from. A single
/// point's contact is made anew in every tick, as round shapes have it, and not worth the look.
template <class L>
bool BlockPreparation<L>::is_known() {
    Vector difference = L::set(0);
    std::uint32_t entry = 0;
    const auto look = [&](Vector input) {
        std::int32_t(&known)[kBlockLanes] = inputs_.entry[entry++];
        difference = L::add_difference(difference, input, lane(known));
        set_lane(known, input);
    };
    const auto look_at = [&](const Vector* inputs, std::uint32_t count) {
        LOCKWIND_UNROLL
        for (std::uint32_t index = 0; index < count; ++index) {
            look(inputs[index]);
        }
    };
    look(L::set(static_cast<std::int32_t>(points_)));
    if (points_ == 1) {
        return false;
    }
    look(lane(block_.point_count));
    look_at(axes_[0], 3);
    look_at(axes_[1], 3);
    look_at(delta_when_made_, 3);
    look_at(anchor_a_, 3 * points_);
    look_at(weight_, points_);
    look_at(body_a_ + 9, 7); // inertia and radius
    look_at(body_b_ + 9, 7);
    look(share_a_);
    look(lane(block_.twist_lever_a));
    look(lane(block_.twist_lever_b));
    look(lane(terms_.inverse_radius_min));
    look(lane(terms_.lever_max));
    look(lane(terms_.overreach_a));
    look(lane(terms_.overreach_b));
    LOCKWIND_UNROLL
    for (const auto& surface : terms_.surface_velocity) {
        look(lane(surface));
    }
    return L::is_zero(difference);
}

template <class L>
void BlockPreparation<L>::make_axes() {
    cross(axes_[0], axes_[1], axes_[2]);
    const auto narrow = [](Vector unit) {
        constexpr int kShift = kUnitFraction - kCoefficientFraction;
        return L::template shift_right<kShift>(L::add(unit, L::set(1 << (kShift - 1))));
    };
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        set_lane(block_.normal[axis], narrow(axes_[0][axis]));
        set_lane(block_.tangent[0][axis], narrow(axes_[1][axis]));
        set_lane(block_.tangent[1][axis], narrow(axes_[2][axis]));
    }
}

/// Shortens the arm of a body that may overreach until |arm| / radius and |response| are at most
/// 7.74, so that no sum of a row's products leaves the formats. It stays a row of such a body, J
/// and M^-1 J^T of a shorter arm, which gives no energy. Bodies that lie deep in each other, or
/// have turned since their manifold was made, have longer ones; others keep theirs to the bit.
template <class L>
void BlockPreparation<L>::hold_arm(const Vector body[kBodyTermCount],
                                   Vector overreach,
                                   const Vector along[3],
                                   Vector arm[3]) const {
    constexpr int kProbe = 14;                                    // binary places
    constexpr int kSquare = 11;                                   // of squares
    constexpr std::int32_t kInverseSquare = kCoefficientOne / 60; // 1 / 7.74^2
    const Vector most = L::set((512 << kProbe) - 1);
    const auto bounded = [&](Vector value) { return L::clamp(value, L::negate(most), most); };
    Vector scaled[3];
    Vector row[3];
    Vector response[3];
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        scaled[axis] =
            bounded(L::template multiply<kLengthFraction + kEffectiveMassFraction - kProbe>(
                arm[axis], inverse_radius(body)));
    }
    cross(scaled, along, row);
    respond(inertia(body), row, L::set(kCoefficientOne), response);
    LOCKWIND_UNROLL
    for (Vector& entry : response) {
        entry = bounded(entry);
    }
    const Vector square = L::maximum(dot<2 * kProbe - kSquare>(scaled, scaled),
                                     dot<2 * kProbe - kSquare>(response, response));
    const Vector excess = L::template multiply<kCoefficientFraction>(
        L::select_positive(overreach, square, L::set(0)), L::set(kInverseSquare));
    const Vector ratio =
        L::root(L::add_product(L::zero(), excess, L::set(1 << (2 * kProbe - kSquare))));
    const Vector shorter =
        L::template reciprocal<kProbe + kUnitFraction>(L::maximum(ratio, L::set(1 << kProbe)));
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        arm[axis] = L::template multiply<kUnitFraction>(arm[axis], shorter);
    }
}

/// Shortens the arms of bodies that may overreach until the row's coupling with another is at most
/// 6.9, one more being a normal row's linear part.
template <class L>
void BlockPreparation<L>::hold_coupling(const ContactBlock::Row& other, Jacobian& jacobian) const {
    constexpr int kShift = 2 * kCoefficientFraction - kEffectiveMassFraction;
    constexpr std::int32_t kMost = std::int64_t{69} * (1 << kEffectiveMassFraction) / 10;
    const Vector coupling =
        L::template round<kShift>(couple(jacobian, other, L::template start<kShift>()));
    const Vector size = L::maximum(coupling, L::negate(coupling));
    const Vector overreach = L::add(lane(terms_.overreach_a), lane(terms_.overreach_b));
    const Vector excess =
        L::select_positive(overreach, L::subtract(size, L::set(kMost)), L::set(0));
    const Vector inverse = L::template reciprocal<kEffectiveMassFraction + kUnitFraction>(
        L::maximum(size, L::set(kMost)));
    const Vector shorter =
        L::select_positive(excess,
                           L::template multiply<kEffectiveMassFraction>(inverse, L::set(kMost)),
                           L::set(kUnitOne));
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        jacobian.a[axis] = L::template multiply<kUnitFraction>(jacobian.a[axis], shorter);
        jacobian.b[axis] = L::template multiply<kUnitFraction>(jacobian.b[axis], shorter);
    }
}

template <class L>
typename BlockPreparation<L>::Jacobian BlockPreparation<L>::jacobian_of(
    const Vector arm_a[3], const Vector arm_b[3], const Vector along[3]) const {
    Vector held_a[3] = {arm_a[0], arm_a[1], arm_a[2]};
    Vector held_b[3] = {arm_b[0], arm_b[1], arm_b[2]};
    if (does_any_overreach_) {
        hold_arm(body_a_, lane(terms_.overreach_a), along, held_a);
        hold_arm(body_b_, lane(terms_.overreach_b), along, held_b);
    }
    Jacobian jacobian;
    lever_row(held_a, inverse_radius(body_a_), along, jacobian.a);
    LOCKWIND_UNROLL
    for (Vector& entry : jacobian.a) {
        entry = L::negate(entry);
    }
    lever_row(held_b, inverse_radius(body_b_), along, jacobian.b);
    return jacobian;
}

template <class L>
void BlockPreparation<L>::fill_row(const Jacobian& jacobian, ContactBlock::Row& row) {
    Jacobian response;
    respond(inertia(body_a_), jacobian.a, share_a_, response.a);
    respond(inertia(body_b_), jacobian.b, share_b_, response.b);
    constexpr int kShift = 2 * kCoefficientFraction - kEffectiveMassFraction;
    Wide sum = add_dot(L::template start<kShift>(), jacobian.a, response.a);
    sum = add_dot(sum, jacobian.b, response.b);
    set_lane(row.mass, effective_mass(1 << kEffectiveMassFraction, sum));
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        set_lane(row.jacobian_a[axis], jacobian.a[axis]);
        set_lane(row.jacobian_b[axis], jacobian.b[axis]);
        set_lane(row.response_a[axis], response.a[axis]);
        set_lane(row.response_b[axis], response.b[axis]);
    }
}

template <class L>
void BlockPreparation<L>::make_normal_row(std::uint32_t point) {
    Jacobian jacobian = jacobian_of(arm_a_[point], arm_b_[point], axes_[0]);
    for (std::uint32_t other = 0; does_any_overreach_ && other < point; ++other) {
        hold_coupling(block_.point[other].row, jacobian);
    }
    fill_row(jacobian, block_.point[point].row);
    if constexpr (L::kWidth > 1) {
        // Without mass a row never gains an impulse.
        std::int32_t(&mass)[kBlockLanes] = block_.point[point].row.mass;
        set_lane(mass, of_point(point, lane(mass)));
    }
    LOCKWIND_UNROLL
    for (std::uint32_t other = 0; other < point; ++other) {
        const Wide sum =
            couple(jacobian, block_.point[other].row, L::template start<kCoefficientFraction>());
        const int index = coupling_index(static_cast<int>(point), static_cast<int>(other));
        set_lane(block_.coupling[index],
                 L::add(L::set(kCoefficientOne), L::template round<kCoefficientFraction>(sum)));
    }
}

template <class L>
void BlockPreparation<L>::find_friction_centre() {
    Vector total = L::set(0);
    LOCKWIND_UNROLL
    for (std::uint32_t point = 0; point < points_; ++point) {
        total = L::add(total, weight_[point]);
    }
    // A lane without a contact has no weight: it must not divide by 0.
    const Vector least = L::set(kCoefficientOne / 16);
    const Vector inverse = L::template reciprocal<54>(L::maximum(total, least)); // Q5.26
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        Wide sum_a = L::template start<kCoefficientFraction>();
        Wide sum_b = sum_a;
        LOCKWIND_UNROLL
        for (std::uint32_t point = 1; point < points_; ++point) {
            const Vector part = L::template multiply<26>(weight_[point], inverse);
            sum_a = L::add_product(sum_a, part, L::subtract(arm_a_[point][axis], arm_a_[0][axis]));
            sum_b = L::add_product(sum_b, part, L::subtract(arm_b_[point][axis], arm_b_[0][axis]));
        }
        centre_a_[axis] = L::add(arm_a_[0][axis], L::template round<kCoefficientFraction>(sum_a));
        centre_b_[axis] = L::add(arm_b_[0][axis], L::template round<kCoefficientFraction>(sum_b));
    }
}

/// How far each point's normal force can resist twist: its distance from the friction centre.
template <class L>
void BlockPreparation<L>::make_levers() {
    const Vector inverse_radius = lane(terms_.inverse_radius_min);
    const Vector longest = lane(terms_.lever_max);
    const Vector bound = L::set((8 << kLengthFraction) - 1);
    LOCKWIND_UNROLL
    for (std::uint32_t point = 0; point < points_; ++point) {
        Vector from_centre[3];
        LOCKWIND_UNROLL
        for (int axis = 0; axis < 3; ++axis) {
            from_centre[axis] = L::clamp(
                L::subtract(arm_a_[point][axis], centre_a_[axis]), L::negate(bound), bound);
        }
        const Vector distance = L::root(add_dot(L::zero(), from_centre, from_centre));
        const Vector lever =
            L::template multiply<kLengthFraction + kEffectiveMassFraction - kCoefficientFraction>(
                L::minimum(distance, longest), inverse_radius);
        set_lane(block_.point[point].lever, of_point(point, lever));
    }
}

template <class L>
void BlockPreparation<L>::make_tangent_row(int which) {
    Jacobian jacobian = jacobian_of(centre_a_, centre_b_, axes_[1 + which]);
    if (which == 1) {
        const ContactBlock::Row& first = block_.tangent_row[0];
        if (does_any_overreach_) {
            hold_coupling(first, jacobian);
        }
        const Wide sum = couple(jacobian, first, L::template start<kCoefficientFraction>());
        set_lane(block_.tangent_coupling, L::template round<kCoefficientFraction>(sum));
    }
    fill_row(jacobian, block_.tangent_row[which]);
    const Vector surface[3] = {lane(terms_.surface_velocity[0]),
                               lane(terms_.surface_velocity[1]),
                               lane(terms_.surface_velocity[2])};
    set_lane(block_.surface_speed[which], dot<kUnitFraction>(axes_[1 + which], surface));
}

template <class L>
void BlockPreparation<L>::make_twist_row() {
    const Vector lever_a = lane(block_.twist_lever_a);
    const Vector lever_b = lane(block_.twist_lever_b);
    Jacobian jacobian;
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        jacobian.a[axis] = L::template multiply<kUnitFraction>(lever_a, axes_[0][axis]);
        jacobian.b[axis] = L::template multiply<kUnitFraction>(lever_b, axes_[0][axis]);
    }
    Jacobian response;
    respond(inertia(body_a_), jacobian.a, share_a_, response.a);
    respond(inertia(body_b_), jacobian.b, share_b_, response.b);
    constexpr int kShift = 2 * kCoefficientFraction - kEffectiveMassFraction;
    Wide sum = add_dot(L::template start<kShift>(), jacobian.a, response.a);
    sum = add_dot(sum, jacobian.b, response.b);
    set_lane(block_.twist_mass, effective_mass(0, sum));
    LOCKWIND_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
        set_lane(block_.twist_response_a[axis], response.a[axis]);
        set_lane(block_.twist_response_b[axis], response.b[axis]);
    }
}

} // namespace lockwind
