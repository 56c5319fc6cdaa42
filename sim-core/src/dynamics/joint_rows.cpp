#include "dynamics/joint_rows.h"

#include "dynamics/turn.h"
#include "geometry/rotation.h"

#include "lockwind/overflow.h"
#include "lockwind/trig.h"

#include <algorithm>
#include <utility>

namespace lockwind {

namespace {

constexpr std::int64_t kOne = std::int64_t{1} << kRowFraction;
constexpr std::int64_t kShareOne = std::int64_t{1} << kShareFraction;
/// Bodies farther apart count as this far, m: keeps levers and offsets far inside 64 bits.
constexpr std::int64_t kDeltaMax = std::int64_t{500} << 32;

/// In the joint's frame: x is its main axis.
struct Axes {
    std::int64_t x[3]; // Q.30, world
    std::int64_t y[3];
    std::int64_t z[3];
};

void cross(const std::int64_t a[3], const std::int64_t b[3], int shift, std::int64_t out[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        const int next = (axis + 1) % 3;
        const int last = (axis + 2) % 3;
        out[axis] = round_exact(raw_subtract(wide_product<Int128>(a[next], b[last]),
                                             wide_product<Int128>(a[last], b[next])),
                                shift);
    }
}

std::int64_t dot(const std::int64_t a[3], const std::int64_t b[3], int shift) {
    return round_exact(dot_exact(a, b), shift);
}

Axes axes_of(const JointBody& body, const std::int64_t frame[9]) {
    Axes axes;
    std::int64_t* const world[3] = {axes.x, axes.y, axes.z};
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t local[3] = {frame[axis], frame[3 + axis], frame[6 + axis]};
        rotate(body.rotation, local, world[axis]);
    }
    return axes;
}

/// The turn from A's joint frame to B's, in A's joint frame, x y z w, Q.30.
void relative_turn(const Joint& joint,
                   const JointBody& a,
                   const JointBody& b,
                   std::int64_t turn[4]) {
    const auto compose = [](const JointBody& body, const std::int32_t frame[4], std::int64_t* out) {
        const std::int64_t of_body[4] = {
            body.orientation[0], body.orientation[1], body.orientation[2], body.orientation[3]};
        const std::int64_t of_frame[4] = {frame[0], frame[1], frame[2], frame[3]};
        multiply_quaternions(of_body, of_frame, out);
    };
    std::int64_t from[4];
    std::int64_t to[4];
    compose(a, joint.frame_a, from);
    compose(b, joint.frame_b, to);
    for (int axis = 0; axis < 3; ++axis) {
        from[axis] = -from[axis];
    }
    multiply_quaternions(from, to, turn);
}

Real to_real(std::int64_t unit) {
    return Real::from_raw(unit << (Real::kFraction - kRowFraction));
}

/// Radians in Q.30, in [-pi, pi].
std::int64_t to_radians(Angle angle) {
    return angle.radians().raw() >> (Real::kFraction - kRowFraction);
}

/// Turn about x of a relative turn, Q.30 rad.
std::int64_t twist_of(const std::int64_t turn[4]) {
    return to_radians(atan2_angle(to_real(turn[0]), to_real(turn[3])) * 2);
}

/// Appends rows.
class RowMaker {
public:
    RowMaker(const JointConstants& constants,
             const JointBody& a,
             const JointBody& b,
             JointRows& rows)
        : constants_(constants), a_(a), b_(b), rows_(rows), turn_a_(lever_of_angle(a)),
          turn_b_(lever_of_angle(b)) {}

    /// Along a world direction; `offset` in m, Q.32.
    void add_place(const std::int64_t direction[3], std::int64_t offset) {
        JointRow& row = next(offset);
        std::copy(direction, direction + 3, row.linear);
        std::fill(row.axis, row.axis + 3, 0);
        lever(rows_.lever_a, direction, -a_.inverse_gyration_radius, row.angular_a);
        lever(rows_.lever_b, direction, b_.inverse_gyration_radius, row.angular_b);
    }
    /// About a world axis (length 1 to 3); `angle` in rad, Q.30.
    void add_angle(const std::int64_t axis[3], std::int64_t angle) {
        JointRow& row = next(round_exact(wide_product<Int128>(angle, constants_.scale), 20));
        angles_ = count_;
        std::fill(row.linear, row.linear + 3, 0);
        std::copy(axis, axis + 3, row.axis);
        for (int index = 0; index < 3; ++index) {
            row.angular_a[index] = -round_exact(wide_product<Int128>(axis[index], turn_a_), 30);
            row.angular_b[index] = round_exact(wide_product<Int128>(axis[index], turn_b_), 30);
        }
    }
    void add_point() {
        for (int axis = 0; axis < 3; ++axis) {
            std::int64_t direction[3] = {};
            direction[axis] = kOne;
            add_place(direction, rows_.gap[axis]);
        }
    }
    void hold() {
        rows_.held = count_;
        rows_.held_angles = angles_;
    }
    void finish() { rows_.free = count_ - rows_.held; }

private:
    /// scale / gyration radius, Q.30; 0 of a fixed body.
    std::int64_t lever_of_angle(const JointBody& body) const {
        return round_exact(wide_product<Int128>(constants_.scale, body.inverse_gyration_radius),
                           16);
    }
    static void lever(const std::int64_t arm[3],
                      const std::int64_t direction[3],
                      std::int64_t inverse_radius,
                      std::int64_t out[3]) {
        if (inverse_radius == 0) {
            std::fill(out, out + 3, 0);
            return;
        }
        std::int64_t moment[3]; // Q.32 m
        cross(arm, direction, 30, moment);
        for (int axis = 0; axis < 3; ++axis) {
            out[axis] = round_exact(wide_product<Int128>(moment[axis], inverse_radius), 26);
        }
    }
    JointRow& next(std::int64_t offset) {
        rows_.offset[count_] = offset;
        return rows_.row[count_++];
    }

    const JointConstants& constants_;
    const JointBody& a_;
    const JointBody& b_;
    JointRows& rows_;
    std::int64_t turn_a_;
    std::int64_t turn_b_;
    int count_ = 0;
    int angles_ = 0; // rows of angles that come first
};

/// Two rows that keep B's axis p on A's; (p, q, r) is right-handed. p_a x p_b is the turn that is
/// off.
void add_parallel(RowMaker& maker,
                  const std::int64_t q_a[3],
                  const std::int64_t r_a[3],
                  const std::int64_t p_b[3]) {
    maker.add_angle(q_a, -dot(p_b, r_a, 30));
    maker.add_angle(r_a, dot(p_b, q_a, 30));
}

/// Three rows that keep B's frame on A's.
void add_same_turn(RowMaker& maker, const Axes& axes, const std::int64_t turn[4]) {
    const std::int64_t sign = turn[3] < 0 ? -2 : 2;
    maker.add_angle(axes.x, sign * turn[0]);
    maker.add_angle(axes.y, sign * turn[1]);
    maker.add_angle(axes.z, sign * turn[2]);
}

/// Rows of places act on A where B's anchor is: their directions turn with A.
void move_lever(JointRows& rows) {
    for (int axis = 0; axis < 3; ++axis) {
        rows.lever_a[axis] += rows.gap[axis];
    }
}

void add_distance(RowMaker& maker, const Joint& joint, JointRows& rows) {
    const Vec3 gap{
        Real::from_raw(rows.gap[0]), Real::from_raw(rows.gap[1]), Real::from_raw(rows.gap[2])};
    const std::int64_t distance = length(gap).raw();
    std::int64_t direction[3] = {0, kOne, 0}; // of coinciding anchors
    if (distance > (std::int64_t{1} << 16)) {
        const Vec3 unit = normalized(gap);
        direction[0] = unit.x.raw() >> 2;
        direction[1] = unit.y.raw() >> 2;
        direction[2] = unit.z.raw() >> 2;
    }
    const bool is_rod = joint.has_spring == 0 && joint.length_limit[0] == joint.length_limit[1];
    if (is_rod) {
        maker.add_place(direction, distance - (std::int64_t{joint.length_limit[0]} << 10));
        maker.hold();
    } else {
        maker.hold();
        maker.add_place(direction, distance);
    }
}

void add_hinge(RowMaker& maker,
               const Joint& joint,
               const JointBody& a,
               const JointBody& b,
               const Axes& axes_a,
               const Axes& axes_b) {
    add_parallel(maker, axes_a.y, axes_a.z, axes_b.x);
    maker.add_point();
    maker.hold();
    std::int64_t angle = 0;
    if (joint.has_limit != 0 || joint.has_spring != 0) {
        std::int64_t turn[4];
        relative_turn(joint, a, b, turn);
        angle = twist_of(turn);
    }
    maker.add_angle(axes_a.x, angle);
}

void add_slider(RowMaker& maker,
                const Joint& joint,
                const JointBody& a,
                const JointBody& b,
                const Axes& axes,
                JointRows& rows) {
    std::int64_t turn[4];
    relative_turn(joint, a, b, turn);
    move_lever(rows);
    add_same_turn(maker, axes, turn);
    maker.add_place(axes.y, dot(axes.y, rows.gap, 30));
    maker.add_place(axes.z, dot(axes.z, rows.gap, 30));
    maker.hold();
    maker.add_place(axes.x, dot(axes.x, rows.gap, 30));
}

void add_wheel(RowMaker& maker, const Axes& axes_a, const Axes& axes_b, JointRows& rows) {
    move_lever(rows);
    add_parallel(maker, axes_a.x, axes_a.y, axes_b.z);
    maker.add_place(axes_a.y, dot(axes_a.y, rows.gap, 30));
    maker.add_place(axes_a.z, dot(axes_a.z, rows.gap, 30));
    maker.hold();
    maker.add_place(axes_a.x, dot(axes_a.x, rows.gap, 30));
    maker.add_angle(axes_a.z, 0);
}

/// The twist's rate is omega . (x_a + x_b) / (1 + x_a . x_b); the swing's is omega . n, n the
/// direction of x_a x x_b.
void add_cone(RowMaker& maker,
              const Joint& joint,
              const JointBody& a,
              const JointBody& b,
              const Axes& axes_a,
              const Axes& axes_b) {
    maker.add_point();
    maker.hold();
    std::int64_t turn[4];
    relative_turn(joint, a, b, turn);
    const std::int64_t cosine = dot(axes_a.x, axes_b.x, 30);
    const std::int64_t sum = std::max(kOne + cosine, kOne / 4); // beyond 139 degrees: no longer
    std::int64_t twist_axis[3];
    for (int axis = 0; axis < 3; ++axis) {
        twist_axis[axis] = multiply_divide(axes_a.x[axis] + axes_b.x[axis], kOne, sum);
    }
    maker.add_angle(twist_axis, twist_of(turn));
    std::int64_t normal[3];
    cross(axes_a.x, axes_b.x, 30, normal);
    const Vec3 swing{to_real(normal[0]), to_real(normal[1]), to_real(normal[2])};
    const Real sine = length(swing);
    std::int64_t swing_axis[3];
    std::copy(axes_a.y, axes_a.y + 3, swing_axis); // of no swing: any
    if (sine.raw() > (std::int64_t{1} << 14)) {
        const Vec3 unit = normalized(swing);
        swing_axis[0] = unit.x.raw() >> 2;
        swing_axis[1] = unit.y.raw() >> 2;
        swing_axis[2] = unit.z.raw() >> 2;
    }
    maker.add_angle(swing_axis, to_radians(atan2_angle(sine, to_real(cosine))));
}

/// Q.32 1/m^2: 1 / radius^2 by shares, the radius that of the body's gyration; towards that about
/// its anchor where the arm is longer than four of them.
std::int64_t mean_inverse_square(const JointConstants& constants,
                                 const JointBody& a,
                                 const JointBody& b,
                                 bool counts_arm) {
    constexpr std::int64_t kUnity = std::int64_t{1} << 32;
    const auto part = [&](std::int64_t share, std::int64_t inverse, const std::int64_t anchor[3]) {
        std::int64_t square = (inverse * inverse) >> 16;
        if (counts_arm) {
            const std::int64_t arm = round_exact(dot_exact(anchor, anchor), 36); // Q.32 m^2
            const std::int64_t longer = round_exact(wide_product<Int128>(arm, square), 32);
            square = multiply_divide(square, kUnity, kUnity + longer);
        }
        return round_exact(wide_product<Int128>(square, share), kShareFraction);
    };
    const std::int64_t sum =
        part(constants.share_a, a.inverse_gyration_radius, constants.anchor_a) +
        part(constants.share_b, b.inverse_gyration_radius, constants.anchor_b);
    return std::max<std::int64_t>(sum, 1);
}

/// 1 / scale^2 = the mean of 1 / radius^2: the response of an angle is then a mean of the bodies'
/// inverse inertias, of order one.
void fill_scale(const JointBody& a, const JointBody& b, JointConstants& constants) {
    const std::int64_t inverse = mean_inverse_square(constants, a, b, false);
    const UInt128 one = UInt128{0, 1} << 76;
    const UInt128 square = divide_wide(one, static_cast<std::uint64_t>(inverse)); // Q.44
    constants.scale = static_cast<std::int64_t>(floor_sqrt128(square));
    constants.angle_part = multiply_divide(
        mean_inverse_square(constants, a, b, true), std::int64_t{1} << kResponseFraction, inverse);
}

std::int64_t share_of(std::int64_t inverse_mass, std::int64_t sum) {
    return sum > 0 ? multiply_divide(inverse_mass, kShareOne, sum) : 0;
}

void read_frame(const std::int32_t frame[4], std::int64_t out[9]) {
    std::int32_t matrix[9];
    rotation_matrix(frame, matrix);
    std::copy(matrix, matrix + 9, out);
}

} // namespace

JointConstants make_joint_constants(const Joint& joint, const JointBody& a, const JointBody& b) {
    JointConstants constants{};
    constants.kind = static_cast<JointKind>(joint.kind);
    constants.inverse_mass = a.inverse_mass + b.inverse_mass;
    constants.share_a = share_of(a.inverse_mass, constants.inverse_mass);
    constants.share_b = constants.inverse_mass > 0 ? kShareOne - constants.share_a : 0;
    for (int axis = 0; axis < 3; ++axis) {
        constants.anchor_a[axis] = std::int64_t{joint.anchor_a[axis]} << 10;
        constants.anchor_b[axis] = std::int64_t{joint.anchor_b[axis]} << 10;
        constants.delta[axis] =
            std::clamp(raw_subtract(b.start[axis], a.start[axis]), -kDeltaMax, kDeltaMax);
    }
    fill_scale(a, b, constants);
    read_frame(joint.frame_a, constants.frame_a);
    read_frame(joint.frame_b, constants.frame_b);
    return constants;
}

void make_joint_rows(const Joint& joint,
                     const JointConstants& constants,
                     const JointBody& a,
                     const JointBody& b,
                     JointRows& rows) {
    rotate(a.rotation, constants.anchor_a, rows.lever_a);
    rotate(b.rotation, constants.anchor_b, rows.lever_b);
    for (int axis = 0; axis < 3; ++axis) {
        rows.gap[axis] = constants.delta[axis] + b.moved[axis] - a.moved[axis] +
                         rows.lever_b[axis] - rows.lever_a[axis];
    }
    const Axes axes_a = axes_of(a, constants.frame_a);
    const Axes axes_b = axes_of(b, constants.frame_b);
    RowMaker maker(constants, a, b, rows);
    switch (constants.kind) {
    case JointKind::ball:
    case JointKind::grab:
        maker.add_point();
        maker.hold();
        break;
    case JointKind::distance:
        add_distance(maker, joint, rows);
        break;
    case JointKind::hinge:
        add_hinge(maker, joint, a, b, axes_a, axes_b);
        break;
    case JointKind::slider:
        add_slider(maker, joint, a, b, axes_a, rows);
        break;
    case JointKind::fixed: {
        std::int64_t turn[4];
        relative_turn(joint, a, b, turn);
        add_same_turn(maker, axes_a, turn);
        maker.add_point();
        maker.hold();
        break;
    }
    case JointKind::wheel:
        add_wheel(maker, axes_a, axes_b, rows);
        break;
    case JointKind::cone_twist:
        add_cone(maker, joint, a, b, axes_a, axes_b);
        break;
    }
    maker.finish();
}

namespace {

/// inverse inertia x row x share, Q.30.
void respond(const JointBody& body,
             const std::int64_t angular[3],
             std::int64_t share,
             std::int64_t out[3]) {
    const std::int64_t* i = body.inverse_inertia;
    const std::int64_t rows[3][3] = {{i[0], i[1], i[2]}, {i[1], i[3], i[4]}, {i[2], i[4], i[5]}};
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t whole = round_exact(dot_exact(rows[axis], angular), 26);
        out[axis] = round_exact(wide_product<Int128>(whole, share), kShareFraction);
    }
}

} // namespace

void fill_joint_block(const JointConstants& constants,
                      const JointBody& a,
                      const JointBody& b,
                      JointRows& rows,
                      JointBlock& block) {
    block.reset(rows.held, rows.free);
    for (int column = 0; column < block.count(); ++column) {
        JointRow& other = rows.row[column];
        respond(a, other.angular_a, constants.share_a, other.response_a);
        respond(b, other.angular_b, constants.share_b, other.response_b);
        for (int index = column; index < block.count(); ++index) {
            const JointRow& row = rows.row[index];
            // The shares of linear motion add up to 1.
            const Int128 sum = raw_add(raw_add(dot_exact(row.linear, other.linear),
                                               dot_exact(row.angular_a, other.response_a)),
                                       dot_exact(row.angular_b, other.response_b));
            block.set_entry(index, column, round_exact(sum, 2 * kRowFraction - kResponseFraction));
        }
    }
}

} // namespace lockwind
