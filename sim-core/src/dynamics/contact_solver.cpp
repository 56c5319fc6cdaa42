#include "dynamics/contact_solver.h"

#include "dynamics/lanes.h"
#include "dynamics/pairing.h"
#include "geometry/rotation.h"

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

/// Q7.24 1/m, of a radius of at least 1/127 m / 4.
std::int32_t inverse_radius(std::int32_t radius) {
    return saturate((std::int64_t{1} << (kLengthFraction + kEffectiveMassFraction)) / radius);
}

/// World, Q11.20 m/s. A sphere's frame does not turn with it: its surface velocity is the world's.
void read_surface(const BodyFrame& frame, const BodyProperties& body, std::int32_t out[3]) {
    const std::int32_t* local = body.surface_velocity;
    if ((local[0] | local[1] | local[2]) == 0) {
        std::fill_n(out, 3, 0);
    } else {
        rotate(frame.rotation, local, out);
    }
}

/// Q9.22 m: the length, at most `radius`, by which a twist row is scaled so that its response on a
/// body stays below 7.5.
std::int32_t twist_radius(std::int32_t radius,
                          const BodyProperties& body,
                          const BodyTerms& terms,
                          const std::int32_t normal[3]) {
    if (body.mode != kDynamic || !is_very_slender(body)) {
        return radius;
    }
    const std::int32_t* i = terms.inverse_inertia();
    const std::int32_t rows[3][3] = {{i[0], i[1], i[2]}, {i[1], i[3], i[4]}, {i[2], i[4], i[5]}};
    std::int64_t response = 1;
    for (const auto& row : rows) {
        response = std::max(response, magnitude(round_unit_wide(dot_wide(row, normal))));
    }
    constexpr std::int64_t kMost = std::int64_t{15} << (kInertiaFraction - 1);
    return static_cast<std::int32_t>(
        std::min<std::int64_t>(radius, kMost * body.gyration_radius / response));
}

/// Arms are at most as much longer than the body as the contact is deep.
bool may_overreach(Overreach overreach, const BodyProperties& body, const Manifold& manifold) {
    if (overreach != Overreach::deep) {
        return overreach == Overreach::always;
    }
    const std::int64_t lowest = *std::min_element(manifold.separation, manifold.separation + 4);
    return -8 * lowest > body.bounding_radius;
}

/// What a contact's lane is made from.
struct PairReader {
    const StepConstants& constants;
    const DynamicsTables& tables;
    const BodyFrames& frames;
    SolverBodies& bodies;

    void read(ContactBlock& block, int lane, PairTerms& terms) const;

private:
    void
    read_twist(const Manifold& manifold, ContactBlock& block, int lane, PairTerms& terms) const;
};

void PairReader::read(ContactBlock& block, int lane, PairTerms& terms) const {
    const BodyRow row_a = block.row_a[lane];
    const BodyRow row_b = block.row_b[lane];
    const BodyProperties& a = tables.properties[row_a];
    const BodyProperties& b = tables.properties[row_b];
    const ContactImpulse& impulse = tables.impulses[block.manifold[lane]];
    const Manifold& manifold = tables.manifolds[block.manifold[lane]];
    terms.manifold[lane] = &manifold;
    terms.body_a[lane] = &bodies.terms(row_a);
    terms.body_b[lane] = &bodies.terms(row_b);
    std::int32_t delta[3];
    pair_delta(frames[row_a], frames[row_b], tables.motion[row_a], tables.motion[row_b], delta);
    for (int axis = 0; axis < 3; ++axis) {
        terms.centre_delta[axis][lane] = delta[axis];
    }
    std::int32_t surface_a[3];
    std::int32_t surface_b[3];
    read_surface(frames[row_a], a, surface_a);
    read_surface(frames[row_b], b, surface_b);
    for (int axis = 0; axis < 3; ++axis) {
        terms.surface_velocity[axis][lane] = raw_subtract(surface_b[axis], surface_a[axis]);
    }
    const bool a_moves = a.mode == kDynamic;
    const bool b_moves = b.mode == kDynamic;
    block.share_a[lane] = a_moves && b_moves ? mass_share(a.inverse_mass, b.inverse_mass)
                                             : (a_moves ? kCoefficientOne : 0);
    block.share_b[lane] = kCoefficientOne - block.share_a[lane];
    block.friction[lane] = combine(a.friction, b.friction, a.friction_rule, b.friction_rule);
    if (block.point_count_max > 1) {
        read_twist(manifold, block, lane, terms);
    }
    terms.overreach_a[lane] = may_overreach(bodies.overreach(row_a), a, manifold) ? 1 : 0;
    terms.overreach_b[lane] = may_overreach(bodies.overreach(row_b), b, manifold) ? 1 : 0;
    const Softness& softness =
        a_moves && b_moves ? constants.dynamic_softness : constants.static_softness;
    block.mass_scale[lane] = softness.mass_scale;
    block.impulse_scale[lane] = softness.impulse_scale;
    block.bias_rate[lane] = softness.bias_rate;
    block.impulse_max[lane] = kImpulseMax / block.point_count[lane];
    std::int64_t load = 0;
    for (int point = 0; point < block.point_count_max; ++point) {
        const bool exists = point < block.point_count[lane];
        block.point[point].impulse[lane] = exists ? impulse.normal[point] : 0;
        load += block.point[point].impulse[lane];
    }
    block.friction_impulse[0][lane] = impulse.friction[0];
    block.friction_impulse[1][lane] = impulse.friction[1];
    block.twist_impulse[lane] = impulse.twist;
    const std::int32_t sideways =
        magnitude(impulse.friction[0]) | magnitude(impulse.friction[1]) | magnitude(impulse.twist);
    if (load > kCalmMax || sideways > kCalmMax) {
        bodies.mark_wild(a_moves ? row_a : row_b);
    }
}

void PairReader::read_twist(const Manifold& manifold,
                            ContactBlock& block,
                            int lane,
                            PairTerms& terms) const {
    const BodyRow row_a = block.row_a[lane];
    const BodyRow row_b = block.row_b[lane];
    const BodyProperties& a = tables.properties[row_a];
    const BodyProperties& b = tables.properties[row_b];
    const bool a_is_smaller =
        a.mode == kDynamic && (b.mode != kDynamic || a.gyration_radius <= b.gyration_radius);
    const BodyProperties& smaller = a_is_smaller ? a : b;
    std::int32_t twist =
        twist_radius(smaller.gyration_radius, a, bodies.terms(row_a), manifold.normal);
    twist = twist_radius(twist, b, bodies.terms(row_b), manifold.normal);
    block.twist_lever_a[lane] = a.mode == kFixed ? 0 : -radius_ratio(twist, a.gyration_radius);
    block.twist_lever_b[lane] = b.mode == kFixed ? 0 : radius_ratio(twist, b.gyration_radius);
    terms.inverse_radius_min[lane] =
        twist == smaller.gyration_radius ? smaller.inverse_gyration_radius : inverse_radius(twist);
    terms.lever_max[lane] = saturate(std::int64_t{twist} * 15 / 2);
}

/// Lanes without a contact are a contact of nothing with nothing.
void fill_padding(BodyRow padding_row, ContactBlock& block, PairTerms& terms) {
    static constexpr Manifold kNothing{};
    static constexpr BodyTerms kNoBody{};
    for (int lane = block.lane_count; lane < kBlockLanes; ++lane) {
        block.row_a[lane] = padding_row;
        block.row_b[lane] = padding_row;
        block.point_count[lane] = 0;
        terms.manifold[lane] = &kNothing;
        terms.body_a[lane] = &kNoBody;
        terms.body_b[lane] = &kNoBody;
        for (int axis = 0; axis < 3; ++axis) {
            terms.centre_delta[axis][lane] = 0;
            terms.surface_velocity[axis][lane] = 0;
        }
        terms.inverse_radius_min[lane] = 0;
        terms.lever_max[lane] = 0;
        terms.overreach_a[lane] = 0;
        terms.overreach_b[lane] = 0;
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

ContactKernels::Passes ContactKernels::*passes_for(const SolverBodies& bodies) {
    return bodies.is_any_wild() ? &ContactKernels::wild : &ContactKernels::calm;
}

} // namespace

ContactSolver::ContactSolver(const DynamicsSettings& settings, const ContactKernels& kernels)
    : kernels_(kernels), overflow_kernels_(kernels_of<ScalarLanes>()),
      colouring_(settings.body_capacity, settings.pair_capacity),
      layout_(settings.manifold_capacity) {
    impacts_.reserve(settings.manifold_capacity);
}

void ContactSolver::prepare(const StepConstants& constants,
                            const DynamicsTables& tables,
                            const BodyFrames& frames,
                            const Activity& activity,
                            SolverBodies& bodies) {
    colouring_.run(tables, activity);
    layout_.run(tables, colouring_.contacts());
    fill_blocks(constants, tables, frames, bodies);
}

void ContactSolver::fill_blocks(const StepConstants& constants,
                                const DynamicsTables& tables,
                                const BodyFrames& frames,
                                SolverBodies& bodies) {
    const PairReader reader{constants, tables, frames, bodies};
    PairTerms terms{};
    impacts_.clear();
    const std::span<ContactBlock> blocks = layout_.blocks();
    for (std::uint32_t index = 0; index < blocks.size(); ++index) {
        ContactBlock& block = blocks[index];
        for (int lane = 0; lane < block.lane_count; ++lane) {
            reader.read(block, lane, terms);
        }
        fill_padding(bodies.padding_row(), block, terms);
        kernels_.prepare(
            terms, constants.substep_rate, constants.separation_max, layout_.inputs(index), block);
        find_impacts(index, bodies);
    }
}

/// Notes the block's contacts that approach fast enough to bounce.
void ContactSolver::find_impacts(std::uint32_t index, SolverBodies& bodies) {
    ContactBlock& block = layout_.blocks()[index];
    std::int64_t bound = 0;
    for (int lane = 0; lane < block.lane_count; ++lane) {
        bound = std::max(bound,
                         std::int64_t{bodies.speed_bound(block.row_a[lane])} +
                             bodies.speed_bound(block.row_b[lane]));
    }
    if (bound < kBounceSpeed / 2) {
        return;
    }
    PointSpeeds speeds;
    (kernels_.*passes_for(bodies)).read_speeds(block, bodies.bodies(), speeds);
    for (int lane = 0; lane < block.lane_count; ++lane) {
        Impact impact{block.pair[lane], index, lane, {}, {}, 0};
        for (int point = 0; point < block.point_count[lane]; ++point) {
            impact.approach[point] = speeds.at[point][lane];
        }
        if (*std::min_element(impact.approach, impact.approach + kBlockPoints) < -kBounceSpeed) {
            impacts_.push_back(impact);
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

void ContactSolver::run(ContactKernels::Pass ContactKernels::Passes::*pass,
                        Halves halves,
                        SolverBodies& bodies) {
    const auto passes = passes_for(bodies);
    const std::span<ContactBlock> blocks = layout_.blocks();
    (kernels_.*passes.*pass)(blocks.first(layout_.overflow_first()), bodies.bodies(), halves);
    (overflow_kernels_.*passes.*
     pass)(blocks.subspan(layout_.overflow_first()), bodies.bodies(), halves);
}

void ContactSolver::relax(Halves halves, SolverBodies& bodies) {
    run(&ContactKernels::Passes::relax, halves, bodies);
    note_impacts();
}

void ContactSolver::write(const DynamicsTables& tables) {
    for (const ContactBlock& block : layout_.blocks()) {
        for (int lane = 0; lane < block.lane_count; ++lane) {
            ContactImpulse& impulse = tables.impulses[block.manifold[lane]];
            for (int point = 0; point < block.point_count[lane]; ++point) {
                impulse.normal[point] = block.point[point].impulse[lane];
            }
            impulse.friction[0] = block.friction_impulse[0][lane];
            impulse.friction[1] = block.friction_impulse[1][lane];
            impulse.twist = block.twist_impulse[lane];
        }
    }
}

/// Newton's impact law, row by row: the separating speed becomes restitution x approach speed. The
/// impulse is not kept for the next tick's warm start.
void ContactSolver::bounce(const DynamicsTables& tables, SolverBodies& bodies, Impact& impact) {
    ContactBlock& block = layout_.blocks()[impact.block];
    const BodyRow rows[2] = {block.row_a[impact.lane], block.row_b[impact.lane]};
    const BodyProperties& a = tables.properties[rows[0]];
    const BodyProperties& b = tables.properties[rows[1]];
    const std::int64_t restitution =
        combine(a.restitution, b.restitution, a.restitution_rule, b.restitution_rule);
    if (restitution <= 0) {
        return;
    }
    for (int point = 0; point < block.point_count[impact.lane]; ++point) {
        if (impact.approach[point] >= -kBounceSpeed || impact.impulse_max[point] == 0) {
            continue;
        }
        const auto target = static_cast<std::int32_t>(
            -round_shift(restitution * impact.approach[point], kCoefficientFraction));
        visit_lanes<ScalarLanes, true>(
            block, bodies.bodies(), impact.lane, Halves::up, [&](auto& solver) {
                impact.impulse_max[point] +=
                    solver.reach_speed(point, target, impact.impulse_max[point]);
            });
    }
}

void ContactSolver::bounce(const DynamicsTables& tables, SolverBodies& bodies) {
    for (Impact& impact : impacts_) {
        bounce(tables, bodies, impact);
    }
}

void ContactSolver::list_hits(const DynamicsTables& tables, std::vector<ContactHit>& hits) {
    std::sort(impacts_.begin(), impacts_.end(), [](const Impact& x, const Impact& y) {
        return x.pair < y.pair;
    });
    for (const Impact& impact : impacts_) {
        if (impact.load_max <= kBounceSpeed) {
            continue;
        }
        const Pair& pair = tables.pairs[impact.pair];
        if (!hits.empty() && hits.back().row_a == pair.row_a &&
            hits.back().row_b == pair.row_b) { // another part of the same bodies
            hits.back().impulse = std::max(hits.back().impulse, impact.load_max);
        } else {
            hits.push_back({pair.row_a, pair.row_b, impact.load_max});
        }
    }
}

} // namespace lockwind
