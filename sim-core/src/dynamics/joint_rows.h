#pragma once

#include "dynamics/joint.h"
#include "dynamics/joint_block.h"
#include "dynamics/joint_bodies.h"
#include "dynamics/step_constants.h"

#include "lockwind/world_definition.h"

#include <cstdint>

namespace lockwind {

/// J = (-linear, angular_a, linear, angular_b): the speed at which B leaves A along the row.
struct JointRow {
    std::int64_t linear[3];    // Q.30, world; 0 of a row of an angle
    std::int64_t angular_a[3]; // Q.30, of angular velocity x gyration radius
    std::int64_t angular_b[3];
    std::int64_t response_a[3]; // Q.30: share x inverse inertia x angular_a
    std::int64_t response_b[3];
    std::int64_t axis[3]; // Q.30, world: of a row of an angle; else 0
};

/// What follows from a joint and its bodies for a whole tick.
struct JointConstants {
    JointKind kind;
    std::int64_t share_a; // Q.40: 1/m_a of 1/m_a + 1/m_b
    std::int64_t share_b;
    std::int64_t inverse_mass; // Q24.40 1/kg: 1/m_a + 1/m_b
    std::int64_t scale;        // Q.22 m: rows of angles are multiplied by it
    std::int64_t angle_part;  // Q.36: what 1/inertia about the anchors is of that about the centres
    std::int64_t anchor_a[3]; // Q.32 m, in A's frame
    std::int64_t anchor_b[3];
    std::int64_t frame_a[9]; // Q.30: the joint's axes in A's frame, by rows
    std::int64_t frame_b[9];
    std::int64_t delta[3]; // Q.32 m, from centre A to centre B at the tick's start; at most 500 m
};

/// A joint's rows where its bodies are now. First those that hold, rows of angles before those of
/// places; then the free axes.
struct JointRows {
    int held;
    int held_angles; // of these
    int free;
    JointRow row[kJointRowsMax];
    std::int64_t offset[kJointRowsMax]; // Q.32 m: what a held row is off; of a free axis its place
    std::int64_t lever_a[3];            // Q.32 m, world, from centre A to where rows of places act
    std::int64_t lever_b[3];
    std::int64_t gap[3]; // Q.32 m, world, from A's anchor to B's
};

JointConstants make_joint_constants(const Joint& joint, const JointBody& a, const JointBody& b);

void make_joint_rows(const Joint& joint,
                     const JointConstants& constants,
                     const JointBody& a,
                     const JointBody& b,
                     JointRows& rows);

/// The rows' responses, and K, its lower triangle.
void fill_joint_block(const JointConstants& constants,
                      const JointBody& a,
                      const JointBody& b,
                      JointRows& rows,
                      JointBlock& block);

} // namespace lockwind
