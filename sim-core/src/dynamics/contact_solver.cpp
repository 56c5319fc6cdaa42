#include "dynamics/contact_solver.h"

#include "dynamics/lanes.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/world_definition.h"

#include <algorithm>

namespace lockwind {

namespace {

constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);
constexpr auto kFixed = static_cast<std::uint8_t>(BodyMode::fixed);
/// Contacts that approach faster bounce, 1 m/s.
constexpr std::int32_t kBounceSpeed = kVelocityOne;

/// inverse_a / (inverse_a + inverse_b), Q3.28; the masses' ratio to one part in 2^33.
std::int32_t mass_share(std::int64_t inverse_a, std::int64_t inverse_b) {
    if (inverse_a == inverse_b) {
        return kCoefficientOne / 2;
    }
    auto a = static_cast<std::uint64_t>(inverse_a);
    auto b = static_cast<std::uint64_t>(inverse_b);
    while (((a | b) >> 34U) != 0) {
        a >>= 1U;
        b >>= 1U;
    }
    return static_cast<std::int32_t>((a << kCoefficientFraction) / (a + b));
}

/// The world-frame inverse inertia R diag(principal) R^T, Q5.26, upper triangle by rows.
void turn_inertia(const std::int32_t rotation[9],
                  const std::int32_t principal[3],
                  std::int32_t out[6]) {
    if (principal[0] == principal[1] && principal[1] == principal[2]) {
        const std::int32_t isotropic[6] = {principal[0], 0, 0, principal[0], 0, principal[0]};
        std::copy(isotropic, isotropic + 6, out);
        return;
    }
    int entry = 0;
    for (int row = 0; row < 3; ++row) {
        std::int32_t scaled[3];
        for (int axis = 0; axis < 3; ++axis) {
            scaled[axis] =
                round_unit(static_cast<std::int64_t>(rotation[3 * row + axis]) * principal[axis]);
        }
        for (int column = row; column < 3; ++column) {
            out[entry++] = round_unit(dot_wide(scaled, rotation + 3 * column));
        }
    }
}

std::int32_t saturate(std::int64_t value) {
    return raw_saturate<std::int32_t>(value);
}

/// radius_min / radius, Q3.28, below 4; 0 of a body without one.
std::int32_t radius_ratio(std::int32_t radius_min, std::int32_t radius) {
    if (radius <= 0) {
        return 0;
    }
    if (radius == radius_min) {
        return kCoefficientOne;
    }
    const std::int64_t ratio = (std::int64_t{radius_min} << kCoefficientFraction) / radius;
    return static_cast<std::int32_t>(std::min(ratio, std::int64_t{4} << kCoefficientFraction));
}

std::int32_t mean_friction(std::int32_t a, std::int32_t b) {
    if (a == b) {
        return a;
    }
    const auto product = static_cast<std::uint64_t>(a) * static_cast<std::uint64_t>(b);
    return static_cast<std::int32_t>(floor_sqrt(product));
}

} // namespace

ContactSolver::ContactSolver(const DynamicsSettings& settings, const ContactKernels& kernels)
    : constants_(make_step_constants(settings)), kernels_(kernels),
      overflow_kernels_(kernels_of<ScalarLanes>()), padding_row_(settings.body_capacity),
      colouring_(settings.body_capacity, settings.pair_capacity),
      layout_(settings.manifold_capacity), bodies_(std::size_t{settings.body_capacity} + 1),
      terms_(settings.body_capacity), courses_(settings.body_capacity),
      speed_bound_(settings.body_capacity) {
    dynamic_rows_.reserve(settings.body_capacity);
    kinematic_rows_.reserve(settings.body_capacity);
    impacts_.reserve(settings.manifold_capacity);
    hits_.reserve(settings.manifold_capacity);
}

void ContactSolver::read_terms(const BodyFrame& frame,
                               const BodyProperties& body,
                               BodyTerms& terms) const {
    std::copy(frame.rotation, frame.rotation + 9, terms.rotation());
    const bool moves = body.mode != kFixed;
    terms.inverse_gyration_radius() = moves ? body.inverse_gyration_radius : 0;
    if (body.mode == kDynamic) {
        turn_inertia(frame.rotation, body.inverse_inertia, terms.inverse_inertia());
    } else {
        std::fill_n(terms.inverse_inertia(), 6, 0);
    }
}

void ContactSolver::read_bodies(const DynamicsTables& tables, const BodyFrames& frames) {
    dynamic_rows_.clear();
    kinematic_rows_.clear();
    const std::uint32_t count = tables.motion.count();
    for (BodyRow row = 0; row < count; ++row) {
        const BodyMotion& motion = tables.motion[row];
        const BodyProperties& body = tables.properties[row];
        read_terms(frames[row], body, terms_[row]);
        SolverBody& solver = bodies_[row];
        solver = SolverBody{};
        courses_[row].travel = BodyTravel{};
        speed_bound_[row] = 0;
        if (body.mode == kFixed) {
            continue;
        }
        const std::int32_t linear_max = constants_.linear_speed_max;
        const std::int32_t angular_max = angular_speed_max(constants_, body.gyration_radius);
        std::int64_t bound = 0;
        for (int axis = 0; axis < 3; ++axis) {
            solver.linear[axis] = std::clamp(motion.linear_velocity[axis], -linear_max, linear_max);
            solver.angular[axis] =
                std::clamp(motion.angular_velocity[axis], -angular_max, angular_max);
            bound += magnitude(std::int64_t{solver.linear[axis]});
            // No point of a body is farther out than 8 gyration radii.
            bound += 8 * magnitude(std::int64_t{solver.angular[axis]});
        }
        speed_bound_[row] = saturate(bound >> 1);
        if (body.mode == kDynamic) {
            dynamic_rows_.push_back(row);
            courses_[row].angular_speed_max = angular_speed_max(constants_, body.gyration_radius);
            continue;
        }
        kinematic_rows_.push_back(row);
        for (int axis = 0; axis < 3; ++axis) {
            solver.linear_moved[axis] = solver.linear[axis];
            solver.angular_moved[axis] = solver.angular[axis];
            courses_[row].travel.linear[axis] =
                std::int64_t{solver.linear[axis]} * constants_.substeps;
            courses_[row].travel.angular[axis] =
                std::int64_t{solver.angular[axis]} * constants_.substeps;
        }
    }
}

void ContactSolver::read_pair(const DynamicsTables& tables,
                              const BodyFrames& frames,
                              ContactBlock& block,
                              int lane,
                              PairTerms& terms) const {
    const BodyRow row_a = block.row_a[lane];
    const BodyRow row_b = block.row_b[lane];
    const BodyProperties& a = tables.properties[row_a];
    const BodyProperties& b = tables.properties[row_b];
    const Manifold& manifold = tables.manifolds[block.manifold[lane]];
    terms.manifold[lane] = &manifold;
    terms.body_a[lane] = &terms_[row_a];
    terms.body_b[lane] = &terms_[row_b];
    std::int32_t delta[3];
    pair_delta(frames[row_a], frames[row_b], tables.motion[row_a], tables.motion[row_b], delta);
    for (int axis = 0; axis < 3; ++axis) {
        terms.centre_delta[axis][lane] = delta[axis];
    }
    const bool a_moves = a.mode == kDynamic;
    const bool b_moves = b.mode == kDynamic;
    block.share_a[lane] = a_moves && b_moves ? mass_share(a.inverse_mass, b.inverse_mass)
                                             : (a_moves ? kCoefficientOne : 0);
    block.share_b[lane] = kCoefficientOne - block.share_a[lane];
    block.friction[lane] = mean_friction(a.friction, b.friction);
    const bool a_is_smaller = a_moves && (!b_moves || a.gyration_radius <= b.gyration_radius);
    const BodyProperties& smaller = a_is_smaller ? a : b;
    block.twist_lever_a[lane] =
        a.mode == kFixed ? 0 : -radius_ratio(smaller.gyration_radius, a.gyration_radius);
    block.twist_lever_b[lane] =
        b.mode == kFixed ? 0 : radius_ratio(smaller.gyration_radius, b.gyration_radius);
    terms.inverse_radius_min[lane] = smaller.inverse_gyration_radius;
    terms.lever_max[lane] = saturate(std::int64_t{smaller.gyration_radius} * 15 / 2);
    const Softness& softness =
        a_moves && b_moves ? constants_.dynamic_softness : constants_.static_softness;
    block.mass_scale[lane] = softness.mass_scale;
    block.impulse_scale[lane] = softness.impulse_scale;
    block.bias_rate[lane] = softness.bias_rate;
    block.impulse_max[lane] = kImpulseMax / block.point_count[lane];
    for (int point = 0; point < block.point_count_max; ++point) {
        const bool exists = point < block.point_count[lane];
        block.point[point].impulse[lane] = exists ? manifold.normal_impulse[point] : 0;
    }
    block.friction_impulse[0][lane] = manifold.friction_impulse[0];
    block.friction_impulse[1][lane] = manifold.friction_impulse[1];
    block.twist_impulse[lane] = manifold.twist_impulse;
}

/// Lanes without a contact are a contact of nothing with nothing.
void ContactSolver::fill_padding(ContactBlock& block, PairTerms& terms) const {
    static constexpr Manifold kNothing{};
    static constexpr BodyTerms kNoBody{};
    for (int lane = block.lane_count; lane < kBlockLanes; ++lane) {
        block.row_a[lane] = padding_row_;
        block.row_b[lane] = padding_row_;
        block.point_count[lane] = 0;
        terms.manifold[lane] = &kNothing;
        terms.body_a[lane] = &kNoBody;
        terms.body_b[lane] = &kNoBody;
        for (int axis = 0; axis < 3; ++axis) {
            terms.centre_delta[axis][lane] = 0;
        }
        terms.inverse_radius_min[lane] = 0;
        terms.lever_max[lane] = 0;
        block.share_a[lane] = 0;
        block.share_b[lane] = 0;
        block.friction[lane] = 0;
        block.twist_lever_a[lane] = 0;
        block.twist_lever_b[lane] = 0;
        block.mass_scale[lane] = 0;
        block.impulse_scale[lane] = 0;
        block.bias_rate[lane] = 0;
        block.impulse_max[lane] = 0;
        for (ContactBlock::Point& point : block.point) {
            point.impulse[lane] = 0;
        }
        block.friction_impulse[0][lane] = 0;
        block.friction_impulse[1][lane] = 0;
        block.twist_impulse[lane] = 0;
    }
}

void ContactSolver::prepare(const DynamicsTables& tables, const BodyFrames& frames) {
    PairTerms terms{};
    for (ContactBlock& block : layout_.blocks()) {
        for (int lane = 0; lane < block.lane_count; ++lane) {
            read_pair(tables, frames, block, lane, terms);
        }
        fill_padding(block, terms);
        kernels_.prepare(terms, constants_.substep_rate, constants_.separation_max, block);
    }
}

void ContactSolver::find_impacts() {
    impacts_.clear();
    const std::span<ContactBlock> blocks = layout_.blocks();
    for (std::uint32_t index = 0; index < blocks.size(); ++index) {
        ContactBlock& block = blocks[index];
        for (int lane = 0; lane < block.lane_count; ++lane) {
            const std::int64_t bound =
                std::int64_t{speed_bound_[block.row_a[lane]]} + speed_bound_[block.row_b[lane]];
            if (bound < kBounceSpeed / 2) {
                continue;
            }
            Impact impact{block.pair[lane], index, lane, {}, {}, 0};
            visit_lanes<ScalarLanes>(block, bodies_.data(), lane, [&](auto& solver) {
                solver.read_speeds(impact.approach);
            });
            if (*std::min_element(impact.approach, impact.approach + kBlockPoints) <
                -kBounceSpeed) {
                impacts_.push_back(impact);
            }
        }
    }
}

void ContactSolver::note_impacts() {
    for (Impact& impact : impacts_) {
        const ContactBlock& block = layout_.blocks()[impact.block];
        std::int64_t load = 0;
        for (int point = 0; point < block.point_count[impact.lane]; ++point) {
            const std::int32_t impulse = block.point[point].impulse[impact.lane];
            impact.impulse_max[point] = std::max(impact.impulse_max[point], impulse);
            load += impulse;
        }
        impact.load_max = std::max(impact.load_max, saturate(load));
    }
}

void ContactSolver::integrate_velocities(std::uint32_t substep) {
    const std::int32_t* gravity = constants_.gravity[substep];
    for (const BodyRow row : dynamic_rows_) {
        SolverBody& body = bodies_[row];
        Course& course = courses_[row];
        for (int axis = 0; axis < 3; ++axis) {
            // What the contacts did in the substep before is this one's warm start.
            const std::int32_t linear_change =
                substep == 0 ? 0 : raw_subtract(body.linear[axis], course.linear_free[axis]);
            const std::int32_t angular_change =
                substep == 0 ? 0 : raw_subtract(body.angular[axis], course.angular_free[axis]);
            course.linear_free[axis] = raw_add(body.linear[axis], gravity[axis]);
            course.angular_free[axis] = body.angular[axis];
            body.linear[axis] = raw_add(course.linear_free[axis], linear_change);
            body.angular[axis] = raw_add(course.angular_free[axis], angular_change);
        }
    }
}

void ContactSolver::integrate_positions() {
    const std::int32_t linear_max = constants_.linear_speed_max;
    for (const BodyRow row : dynamic_rows_) {
        SolverBody& body = bodies_[row];
        Course& course = courses_[row];
        const std::int32_t angular_max = course.angular_speed_max;
        for (int axis = 0; axis < 3; ++axis) {
            body.linear[axis] = std::clamp(body.linear[axis], -linear_max, linear_max);
            body.angular[axis] = std::clamp(body.angular[axis], -angular_max, angular_max);
            body.linear_moved[axis] = body.linear[axis];
            body.angular_moved[axis] = body.angular[axis];
            course.travel.linear[axis] += body.linear[axis];
            course.travel.angular[axis] += body.angular[axis];
        }
    }
}

void ContactSolver::write_manifolds(const DynamicsTables& tables) {
    for (const ContactBlock& block : layout_.blocks()) {
        for (int lane = 0; lane < block.lane_count; ++lane) {
            Manifold& manifold = tables.manifolds[block.manifold[lane]];
            for (int point = 0; point < block.point_count[lane]; ++point) {
                manifold.normal_impulse[point] = block.point[point].impulse[lane];
            }
            manifold.friction_impulse[0] = block.friction_impulse[0][lane];
            manifold.friction_impulse[1] = block.friction_impulse[1][lane];
            manifold.twist_impulse = block.twist_impulse[lane];
        }
    }
}

void ContactSolver::write_bodies(const DynamicsTables& tables, std::uint32_t tick) {
    for (const BodyRow row : dynamic_rows_) {
        BodyMotion& motion = tables.motion[row];
        const BodyProperties& body = tables.properties[row];
        std::copy(bodies_[row].linear, bodies_[row].linear + 3, motion.linear_velocity);
        std::copy(bodies_[row].angular, bodies_[row].angular + 3, motion.angular_velocity);
        move_body(constants_, courses_[row].travel, body, tick, motion);
        clamp_velocities(constants_, body, motion);
    }
    for (const BodyRow row : kinematic_rows_) {
        move_body(
            constants_, courses_[row].travel, tables.properties[row], tick, tables.motion[row]);
    }
}

void ContactSolver::run(ContactKernels::Pass ContactKernels::*pass) {
    const std::span<ContactBlock> blocks = layout_.blocks();
    (kernels_.*pass)(blocks.first(layout_.overflow_first()), bodies_.data());
    (overflow_kernels_.*pass)(blocks.subspan(layout_.overflow_first()), bodies_.data());
}

void ContactSolver::solve(const DynamicsTables& tables,
                          std::uint32_t tick,
                          const BodyFrames& frames) {
    hits_.clear();
    read_bodies(tables, frames);
    colouring_.run(tables);
    layout_.run(tables, colouring_.contacts());
    prepare(tables, frames);
    find_impacts();
    for (std::uint32_t substep = 0; substep < constants_.substeps; ++substep) {
        integrate_velocities(substep);
        if (substep == 0) {
            run(&ContactKernels::warm_start);
        }
        run(&ContactKernels::solve);
        integrate_positions();
        run(&ContactKernels::relax);
        note_impacts();
    }
    write_manifolds(tables);
    write_bodies(tables, tick);
}

/// Newton's impact law, row by row: the separating speed becomes restitution x approach speed. The
/// impulse is not kept for the next tick's warm start.
void ContactSolver::bounce(const DynamicsTables& tables, Impact& impact) {
    ContactBlock& block = layout_.blocks()[impact.block];
    const BodyRow rows[2] = {block.row_a[impact.lane], block.row_b[impact.lane]};
    const std::int64_t restitution =
        std::max(tables.properties[rows[0]].restitution, tables.properties[rows[1]].restitution);
    if (restitution <= 0) {
        return;
    }
    for (int point = 0; point < block.point_count[impact.lane]; ++point) {
        if (impact.approach[point] >= -kBounceSpeed || impact.impulse_max[point] == 0) {
            continue;
        }
        const auto target = static_cast<std::int32_t>(
            -round_shift(restitution * impact.approach[point], kCoefficientFraction));
        visit_lanes<ScalarLanes>(block, bodies_.data(), impact.lane, [&](auto& solver) {
            impact.impulse_max[point] +=
                solver.reach_speed(point, target, impact.impulse_max[point]);
        });
    }
}

void ContactSolver::restitution(const DynamicsTables& tables) {
    if (impacts_.empty()) {
        return;
    }
    // The arena's velocities count, not what the solver left in its own.
    for (const std::vector<BodyRow>* rows : {&dynamic_rows_, &kinematic_rows_}) {
        for (const BodyRow row : *rows) {
            const BodyMotion& motion = tables.motion[row];
            std::copy(motion.linear_velocity, motion.linear_velocity + 3, bodies_[row].linear);
            std::copy(motion.angular_velocity, motion.angular_velocity + 3, bodies_[row].angular);
        }
    }
    for (Impact& impact : impacts_) {
        bounce(tables, impact);
    }
    for (const BodyRow row : dynamic_rows_) {
        BodyMotion& motion = tables.motion[row];
        std::copy(bodies_[row].linear, bodies_[row].linear + 3, motion.linear_velocity);
        std::copy(bodies_[row].angular, bodies_[row].angular + 3, motion.angular_velocity);
        clamp_velocities(constants_, tables.properties[row], motion);
    }
    list_hits(tables);
}

void ContactSolver::list_hits(const DynamicsTables& tables) {
    std::sort(impacts_.begin(), impacts_.end(), [](const Impact& x, const Impact& y) {
        return x.pair < y.pair;
    });
    for (const Impact& impact : impacts_) {
        if (impact.load_max > kBounceSpeed) {
            const Pair& pair = tables.pairs[impact.pair];
            hits_.push_back({pair.row_a, pair.row_b, impact.load_max});
        }
    }
}

} // namespace lockwind
