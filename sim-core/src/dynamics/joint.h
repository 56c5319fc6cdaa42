#pragma once

#include "lockwind/schema.h"
#include "lockwind/types.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace lockwind {

/// A joint between two bodies: row of section "joint", sorted by id. Its frame in a body has the
/// joint's main axis as x (hinge, slider, suspension, twist); a wheel spins about z.
///
/// Impulses are lambda_hat = lambda (1/m_a + 1/m_b) as those of contacts; rows of angles are
/// multiplied by a length that follows from the bodies (JointConstraint::scale), so that all are
/// m/s.
struct Joint {
    std::uint64_t id;
    std::int64_t target[3];       // Q31.32 m: where a grab draws its anchor
    std::int64_t motor_limit;     // Q31.32 N or N m: most that the motor, or a grab, may give
    std::int64_t break_force;     // Q31.32 N; 0 for never
    std::int64_t break_torque;    // Q31.32 N m; 0 for never
    std::int64_t row_impulse[6];  // Q31.32 m/s, of the rows that hold; in the order of JointRows
    std::int64_t axis_impulse[4]; // Q31.32 m/s, on the free axis: spring, motor, lower and upper
    std::int64_t swing_impulse;   // Q31.32 m/s, of the cone
    BodyRow row_a;                // kNoIndex of a grab
    BodyRow row_b;
    std::int32_t anchor_a[3];     // Q9.22 m, in A's frame
    std::int32_t anchor_b[3];     // Q9.22 m, in B's frame
    std::int32_t frame_a[4];      // Q2.30 x y z w, unit: from the joint's frame to A's
    std::int32_t frame_b[4];      // Q2.30
    std::int32_t length_limit[2]; // Q9.22 m: distance, or travel along the axis
    std::int32_t angle_limit[2];  // Q3.28 rad about the axis
    std::int32_t swing_limit;     // Q3.28 rad between the axes
    std::int32_t rest_length;     // Q9.22 m where the spring is slack
    std::int32_t rest_angle;      // Q3.28 rad
    std::int32_t motor_speed;     // Q11.20 m/s or rad/s
    std::int32_t spring_hertz;    // Q15.16 Hz
    std::int32_t spring_damping;  // Q11.20, damping ratio
    std::uint8_t kind;            // JointKind
    std::uint8_t has_limit;       // 0 or 1, as those below
    std::uint8_t has_motor;
    std::uint8_t has_spring;
    std::uint8_t collide_connected; // the two bodies meet as others do
    std::uint8_t zero[3];
};
static_assert(sizeof(Joint) == 256);

inline constexpr std::array kJointFields{
    LOCKWIND_FIELD(Joint, id, 0, "", ""),
    LOCKWIND_FIELD(Joint, target, 32, "m", "xyz"),
    LOCKWIND_FIELD(Joint, motor_limit, 32, "N, N m", ""),
    LOCKWIND_FIELD(Joint, break_force, 32, "N", ""),
    LOCKWIND_FIELD(Joint, break_torque, 32, "N m", ""),
    LOCKWIND_FIELD(Joint, row_impulse, 32, "m/s", ""),
    LOCKWIND_FIELD(Joint, axis_impulse, 32, "m/s", ""),
    LOCKWIND_FIELD(Joint, swing_impulse, 32, "m/s", ""),
    LOCKWIND_FIELD(Joint, row_a, 0, "", ""),
    LOCKWIND_FIELD(Joint, row_b, 0, "", ""),
    LOCKWIND_FIELD(Joint, anchor_a, 22, "m", "xyz"),
    LOCKWIND_FIELD(Joint, anchor_b, 22, "m", "xyz"),
    LOCKWIND_FIELD(Joint, frame_a, 30, "", "xyzw"),
    LOCKWIND_FIELD(Joint, frame_b, 30, "", "xyzw"),
    LOCKWIND_FIELD(Joint, length_limit, 22, "m", ""),
    LOCKWIND_FIELD(Joint, angle_limit, 28, "rad", ""),
    LOCKWIND_FIELD(Joint, swing_limit, 28, "rad", ""),
    LOCKWIND_FIELD(Joint, rest_length, 22, "m", ""),
    LOCKWIND_FIELD(Joint, rest_angle, 28, "rad", ""),
    LOCKWIND_FIELD(Joint, motor_speed, 20, "m/s, rad/s", ""),
    LOCKWIND_FIELD(Joint, spring_hertz, 16, "Hz", ""),
    LOCKWIND_FIELD(Joint, spring_damping, 20, "", ""),
    LOCKWIND_FIELD(Joint, kind, 0, "", ""),
    LOCKWIND_FIELD(Joint, has_limit, 0, "", ""),
    LOCKWIND_FIELD(Joint, has_motor, 0, "", ""),
    LOCKWIND_FIELD(Joint, has_spring, 0, "", ""),
    LOCKWIND_FIELD(Joint, collide_connected, 0, "", ""),
    LOCKWIND_FIELD(Joint, zero, 0, "", ""),
};

} // namespace lockwind
