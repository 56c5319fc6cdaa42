#pragma once

#include "dynamics/activity.h"
#include "dynamics/body_frame.h"
#include "dynamics/body_integration.h"
#include "dynamics/contact_block.h"
#include "dynamics/dynamics.h"
#include "dynamics/step_constants.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Which arms of contacts may take a body's rows out of their formats: none, those an eighth longer
/// than its bounding radius, as deep contacts have them, or any.
enum class Overreach : std::uint8_t { never, deep, always };

/// The bodies of a tick while its substeps run: read from the arena, moved, written back. All
/// members are scratch of one tick.
class SolverBodies {
public:
    explicit SolverBodies(std::uint32_t capacity);

    void read(const StepConstants& constants,
              const DynamicsTables& tables,
              const BodyFrames& frames,
              const Activity& activity);
    /// Slows a body that something touches or holds to what the rows' format allows.
    void hold_back(const StepConstants& constants, BodyRow row);
    /// Gravity, and what the contacts did in the substep before: that is a later substep's warm
    /// start.
    void integrate_velocities(const StepConstants& constants, std::uint32_t substep);
    void integrate_positions();
    /// Changes velocities, Q11.20 m/s, by what is not to be repeated in the next substep: what
    /// turns with the bodies, as joints do, starts anew there.
    void give(BodyRow row, const std::int64_t linear[3], const std::int64_t angular[3]);
    /// A body is wild from where it moves, or a contact brings an impulse, of 64 m/s to the tick's
    /// end: its contacts are then held within the formats.
    void mark_wild(BodyRow row) {
        bodies_[row].linear[kWildEntry] = 1;
        is_any_wild_ = true;
    }
    bool is_any_wild() const { return is_any_wild_; }
    /// The body's orientation at the tick's end, of one that is followed substep by substep;
    /// `orientation` must live until write().
    void set_orientation(BodyRow row, const std::int32_t* orientation) {
        orientations_[row] = orientation;
    }
    /// What is dynamic; places, too.
    void write(const StepConstants& constants, const DynamicsTables& tables);
    /// What is kinematic. Once a tick: it may touch bodies of several classes of substeps.
    void write_kinematic(const StepConstants& constants, const DynamicsTables& tables);
    /// A change of velocities, Q11.20 m/s, from the arena's to those that bodies have here.
    struct Bounce {
        BodyRow row;
        std::int32_t linear[3];
        std::int32_t angular[3];
    };
    void add_bounces(const DynamicsTables& tables, std::vector<Bounce>& bounces) const;

    /// The arena's velocities as they are now, and back: what happens after the substeps counts
    /// from them.
    void read_velocities(const DynamicsTables& tables);
    void write_velocities(const StepConstants& constants, const DynamicsTables& tables);

    /// By row, of those that are awake and their partners; one more at rest, of the lanes without
    /// a contact; it is that of kNoIndex too.
    SolverBody* bodies() { return bodies_.data(); }
    BodyRow padding_row() const { return padding_row_; }
    SolverBody& body(BodyRow row) { return bodies_[row == kNoIndex ? padding_row_ : row]; }
    const SolverBody& body(BodyRow row) const {
        return bodies_[row == kNoIndex ? padding_row_ : row];
    }
    const BodyTerms& terms(BodyRow row) const { return terms_[row]; }
    Overreach overreach(BodyRow row) const { return overreach_[row]; }
    /// Q11.20 m/s at the tick's start, of any point of the body.
    std::int32_t speed_bound(BodyRow row) const { return speed_bound_[row]; }

private:
    // Apart, because each is gone over in every substep, and never with the others.
    /// Velocities before the contacts' impulses of a substep.
    struct FreeVelocity {
        std::int32_t linear[3];
        std::int32_t angular[3];
    };
    /// What the positions' steps add up.
    struct Course {
        BodyTravel travel;
        std::int32_t linear_speed_max;
        std::int32_t angular_speed_max;
    };

    /// Returns whether it is.
    bool mark_if_wild(BodyRow row);
    void integrate_wild(const std::int32_t* gravity, bool is_first, BodyRow row);
    void read_body(const StepConstants& constants,
                   const BodyMotion& motion,
                   const BodyProperties& body,
                   BodyRow row);

    BodyRow padding_row_;
    std::vector<SolverBody> bodies_;
    std::vector<BodyTerms> terms_;
    std::vector<FreeVelocity> free_;
    std::vector<Course> courses_;
    std::vector<const std::int32_t*> orientations_; // see set_orientation(); else null
    std::vector<std::int32_t> speed_bound_;
    std::vector<Overreach> overreach_;
    std::vector<BodyRow> dynamic_rows_;
    std::vector<BodyRow> kinematic_rows_;
    bool is_any_wild_ = false;
};

} // namespace lockwind
