#include "dynamics/contact_kernel_choice.h"
#include "tests/support/dice.h"

#include "lockwind/overflow.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <iostream>
#include <iterator>
#include <limits>
#include <memory>

// The kernels of each instruction set against the scalar ones, block by block, on values that no
// simulation would bring: the lanes wrap as the scalar ones do.
namespace lockwind {
namespace {

using testing::Dice;
using Passes = ContactKernels::Passes;

constexpr int kBodies = 2 * kBlockLanes;

std::int32_t any(Dice& dice) {
    constexpr std::int32_t kEnds[] = {std::numeric_limits<std::int32_t>::min(),
                                      std::numeric_limits<std::int32_t>::max(),
                                      -1,
                                      0,
                                      1};
    if (dice.chance(20)) {
        return kEnds[dice.below(std::size(kEnds))];
    }
    // Of all magnitudes: a uniform draw would nearly always be huge.
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(dice.next())) >> dice.below(32);
}
std::int32_t between(Dice& dice, std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(
                     dice.below(static_cast<std::uint64_t>(std::int64_t{high} - low + 1)));
}

template <std::size_t kCount>
void fill(std::int32_t (&values)[kCount], Dice& dice) {
    for (std::int32_t& value : values) {
        value = any(dice);
    }
}
template <std::size_t kRows, std::size_t kCount>
void fill(std::int32_t (&rows)[kRows][kCount], Dice& dice) {
    for (auto& row : rows) {
        fill(row, dice);
    }
}
void fill(ContactBlock::Row& row, Dice& dice) {
    fill(row.jacobian_a, dice);
    fill(row.jacobian_b, dice);
    fill(row.response_a, dice);
    fill(row.response_b, dice);
    fill(row.mass, dice);
}

/// What a block's passes rely on: no impulse of a point that a lane does not have, none negative,
/// no twist on one point.
void keep_promises(ContactBlock& block, Dice& dice) {
    for (int lane = 0; lane < kBlockLanes; ++lane) {
        block.impulse_max[lane] = between(dice, 0, 1 << 28);
        block.friction[lane] = between(dice, 0, 4 << kCoefficientFraction >> 1);
        for (int index = 0; index < static_cast<int>(kBlockPoints); ++index) {
            ContactBlock::Point& point = block.point[index];
            const bool exists = index < block.point_count[lane];
            point.impulse[lane] = exists ? between(dice, 0, block.impulse_max[lane]) : 0;
            point.row.mass[lane] = exists ? point.row.mass[lane] : 0;
            // Of blocks of single points nobody writes it: it is what an earlier block left.
            const bool twists =
                block.point_count_max == 1 || (exists && block.point_count[lane] > 1);
            point.lever[lane] = twists ? between(dice, 0, 7 << kCoefficientFraction) : 0;
        }
        if (block.point_count[lane] == 1) {
            block.twist_impulse[lane] = 0;
        }
    }
}

/// Eight contacts of sixteen bodies.
void draw_block(ContactBlock& block, Dice& dice) {
    block.lane_count = kBlockLanes;
    block.point_count_max = 0;
    block.is_central = dice.chance(250);
    const auto most =
        block.is_central ? std::uint64_t{1} : static_cast<std::uint64_t>(between(dice, 1, 4));
    for (int lane = 0; lane < kBlockLanes; ++lane) {
        block.row_a[lane] = static_cast<BodyRow>(2 * lane);
        block.row_b[lane] = static_cast<BodyRow>(2 * lane + 1);
        block.point_count[lane] = static_cast<std::int32_t>(1 + dice.below(most));
        block.point_count_max = std::max(block.point_count_max, block.point_count[lane]);
    }
    fill(block.normal, dice);
    fill(block.tangent[0], dice);
    fill(block.tangent[1], dice);
    fill(block.coupling, dice);
    for (auto* lanes : {&block.share_a,
                        &block.share_b,
                        &block.mass_scale,
                        &block.impulse_scale,
                        &block.bias_rate,
                        &block.tangent_coupling,
                        &block.twist_lever_a,
                        &block.twist_lever_b,
                        &block.twist_mass,
                        &block.twist_impulse}) {
        fill(*lanes, dice);
    }
    for (ContactBlock::Point& point : block.point) {
        fill(point.row, dice);
        fill(point.separation, dice);
    }
    fill(block.tangent_row[0], dice);
    fill(block.tangent_row[1], dice);
    fill(block.twist_response_a, dice);
    fill(block.twist_response_b, dice);
    fill(block.friction_impulse, dice);
    fill(block.surface_speed, dice);
    keep_promises(block, dice);
}

using Bodies = std::array<SolverBody, kBodies>;

void draw_bodies(Bodies& bodies, Dice& dice) {
    for (SolverBody& body : bodies) {
        fill(body.linear, dice);
        body.linear[kWildEntry] = dice.chance(100) ? 1 : 0;
        fill(body.angular, dice);
        fill(body.linear_moved, dice);
        fill(body.angular_moved, dice);
    }
}

/// All that a pass may write, of the points that there are.
void expect_same(const ContactBlock& block, const ContactBlock& other) {
    for (int lane = 0; lane < kBlockLanes; ++lane) {
        for (int point = 0; point < block.point_count[lane]; ++point) {
            ASSERT_EQ(block.point[point].impulse[lane], other.point[point].impulse[lane]);
            ASSERT_EQ(block.point[point].separation[lane], other.point[point].separation[lane]);
        }
        ASSERT_EQ(block.friction_impulse[0][lane], other.friction_impulse[0][lane]);
        ASSERT_EQ(block.friction_impulse[1][lane], other.friction_impulse[1][lane]);
        ASSERT_EQ(block.twist_impulse[lane], other.twist_impulse[lane]);
    }
}

/// Runs every pass over both, and compares all that it may write.
void expect_same_passes(const Passes& passes,
                        ContactBlock& block,
                        Bodies& bodies,
                        const Passes& other_passes,
                        ContactBlock& other,
                        Bodies& others) {
    for (const auto pass : {&Passes::warm_start, &Passes::solve, &Passes::relax}) {
        for (const Halves halves : {Halves::up, Halves::down}) {
            (passes.*pass)({&block, 1}, bodies.data(), halves);
            (other_passes.*pass)({&other, 1}, others.data(), halves);
            ASSERT_NO_FATAL_FAILURE(expect_same(block, other));
            ASSERT_EQ(std::memcmp(bodies.data(), others.data(), sizeof bodies), 0);
        }
    }
}

/// Nobody writes the lever of a single point: it is what its block held before. Here any build
/// shows where it has an effect, a checked one where it is even multiplied by.
TEST(ContactPasses, ASinglePointHasNoLever) {
    const ContactKernels kernels = contact_kernels(Simd::scalar);
    for (const bool is_central : {false, true}) {
        auto block = std::make_unique<ContactBlock>();
        block->lane_count = 1;
        block->point_count[0] = block->point_count_max = 1;
        block->is_central = is_central;
        block->row_b[0] = 1;
        block->impulse_max[0] = kImpulseMax;
        block->point[0].impulse[0] = kImpulseMax;
        block->point[0].row.mass[0] = kCoefficientOne;
        auto other = std::make_unique<ContactBlock>(*block);
        other->point[0].lever[0] = 7 << kCoefficientFraction;
        Bodies bodies{};
        Bodies others{};
        ASSERT_NO_FATAL_FAILURE(
            expect_same_passes(kernels.calm, *block, bodies, kernels.calm, *other, others));
        EXPECT_EQ(block->point[0].impulse[0], kImpulseMax) << "it bears all the while";
    }
}

class SimdTest : public ::testing::TestWithParam<Simd> {
protected:
    void SetUp() override {
        if (!is_available(GetParam())) {
            GTEST_SKIP() << to_string(GetParam()) << " is not available here";
        }
    }
};

INSTANTIATE_TEST_SUITE_P(Kernels,
                         SimdTest,
                         ::testing::Values(Simd::sse4, Simd::avx2, Simd::avx512, Simd::neon),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST_P(SimdTest, PassesOfRandomBlocksAreThoseOfScalarLanes) {
    const ContactKernels scalar = contact_kernels(Simd::scalar);
    const ContactKernels wide = contact_kernels(GetParam());
    Dice dice(11);
    auto block = std::make_unique<ContactBlock>();
    auto other = std::make_unique<ContactBlock>();
    int cones = 0;
    int approaching = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        draw_block(*block, dice);
        *other = *block;
        Bodies bodies{};
        draw_bodies(bodies, dice);
        Bodies others = bodies;
        PointSpeeds speeds;
        PointSpeeds other_speeds;
        const auto passes = trial % 2 == 0 ? &ContactKernels::calm : &ContactKernels::wild;
        (scalar.*passes).read_speeds(*block, bodies.data(), speeds);
        (wide.*passes).read_speeds(*other, others.data(), other_speeds);
        for (int lane = 0; lane < block->lane_count; ++lane) {
            for (int point = 0; point < block->point_count[lane]; ++point) {
                ASSERT_EQ(speeds.at[point][lane], other_speeds.at[point][lane]) << trial;
                approaching += speeds.at[point][lane] < -kVelocityOne ? 1 : 0;
            }
        }
        const auto friction = block->friction_impulse[0][0];
        ASSERT_NO_FATAL_FAILURE(
            expect_same_passes(scalar.*passes, *block, bodies, wide.*passes, *other, others))
            << "trial " << trial;
        cones += block->friction_impulse[0][0] != friction ? 1 : 0;
    }
    EXPECT_GT(cones, 1000);
    EXPECT_GT(approaching, 1000);
}

TEST_P(SimdTest, CentralContactsAreThoseWhoseNormalForcesTurnNothing) {
    const ContactKernels kernels = contact_kernels(GetParam());
    Dice dice(13);
    auto block = std::make_unique<ContactBlock>();
    auto other = std::make_unique<ContactBlock>();
    int central = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        draw_block(*block, dice);
        if (!block->is_central) {
            continue;
        }
        ++central;
        *other = *block;
        other->is_central = false;
        other->point[0].row = {};
        std::fill_n(other->point[0].row.mass, kBlockLanes, kCoefficientOne);
        Bodies bodies{};
        draw_bodies(bodies, dice);
        Bodies others = bodies;
        const auto passes = trial % 2 == 0 ? &ContactKernels::calm : &ContactKernels::wild;
        ASSERT_NO_FATAL_FAILURE(
            expect_same_passes(kernels.*passes, *block, bodies, kernels.*passes, *other, others))
            << "trial " << trial;
    }
    EXPECT_GT(central, 300);
}

TEST_P(SimdTest, WildPassesGiveContactsWithoutAWildBodyTheSameBits) {
    const ContactKernels kernels = contact_kernels(GetParam());
    Dice dice(12);
    auto block = std::make_unique<ContactBlock>();
    auto other = std::make_unique<ContactBlock>();
    int held = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        draw_block(*block, dice);
        *other = *block;
        Bodies bodies{};
        draw_bodies(bodies, dice);
        Bodies others = bodies;
        for (const auto pass : {&Passes::warm_start, &Passes::solve, &Passes::relax}) {
            (kernels.calm.*pass)({block.get(), 1}, bodies.data(), Halves::up);
            (kernels.wild.*pass)({other.get(), 1}, others.data(), Halves::up);
        }
        for (std::size_t lane = 0; lane < kBlockLanes; ++lane) {
            const SolverBody* pair = &bodies[2 * lane];
            const bool is_same = std::memcmp(pair, &others[2 * lane], 2 * sizeof *pair) == 0;
            const bool is_wild = (pair[0].linear[kWildEntry] | pair[1].linear[kWildEntry]) != 0;
            ASSERT_TRUE(is_wild || is_same) << trial;
            held += is_same ? 0 : 1;
        }
    }
    EXPECT_GT(held, 1000);
}

/// A manifold and bodies as bodies of any shape and place might bring them.
struct PairDraw {
    std::array<Manifold, kBlockLanes> manifolds{};
    std::array<BodyTerms, kBodies> bodies{};
    PairTerms terms{};

    void draw(ContactBlock& block, Dice& dice) {
        for (BodyTerms& body : bodies) {
            for (int entry = 0; entry < kBodyTermCount; ++entry) {
                body.entry[entry] = between(dice, -(1 << 29), 1 << 29);
            }
            body.inverse_gyration_radius() = between(dice, 0, 100 << kEffectiveMassFraction);
        }
        fill(terms.centre_delta, dice);
        fill(terms.surface_velocity, dice);
        for (int lane = 0; lane < kBlockLanes; ++lane) {
            Manifold& manifold = manifolds[static_cast<std::size_t>(lane)];
            fill(manifold.normal, dice);
            fill(manifold.tangent, dice);
            fill(manifold.centre_delta, dice);
            fill(manifold.separation, dice);
            fill(manifold.anchor_a, dice);
            for (std::int32_t(*orientation)[4] :
                 {&manifold.orientation_a, &manifold.orientation_b}) {
                for (std::int32_t& component : *orientation) {
                    component = between(dice, -(1 << 29), 1 << 29);
                }
            }
            terms.manifold[lane] = &manifold;
            terms.body_a[lane] = &bodies[block.row_a[lane]];
            terms.body_b[lane] = &bodies[block.row_b[lane]];
            terms.inverse_radius_min[lane] = between(dice, 0, 100 << kEffectiveMassFraction);
            terms.lever_max[lane] = between(dice, 0, 100 << kLengthFraction);
            terms.overreach_a[lane] = between(dice, 0, 1);
            terms.overreach_b[lane] = between(dice, 0, 1);
        }
    }
};

void expect_same(const ContactBlock::Row& row, const ContactBlock::Row& other, int lane) {
    for (int axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(row.jacobian_a[axis][lane], other.jacobian_a[axis][lane]);
        ASSERT_EQ(row.jacobian_b[axis][lane], other.jacobian_b[axis][lane]);
        ASSERT_EQ(row.response_a[axis][lane], other.response_a[axis][lane]);
        ASSERT_EQ(row.response_b[axis][lane], other.response_b[axis][lane]);
    }
    ASSERT_EQ(row.mass[lane], other.mass[lane]);
}

void expect_same_preparation(const ContactBlock& block, const ContactBlock& other, int lane) {
    for (int point = 0; point < block.point_count[lane]; ++point) {
        const ContactBlock::Point& p = block.point[point];
        ASSERT_NO_FATAL_FAILURE(expect_same(p.row, other.point[point].row, lane));
        ASSERT_EQ(p.separation[lane], other.point[point].separation[lane]);
        ASSERT_EQ(p.lever[lane], other.point[point].lever[lane]);
        for (int before = 0; before < point; ++before) {
            const int index = coupling_index(point, before);
            ASSERT_EQ(block.coupling[index][lane], other.coupling[index][lane]);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(block.normal[axis][lane], other.normal[axis][lane]);
        ASSERT_EQ(block.tangent[0][axis][lane], other.tangent[0][axis][lane]);
        ASSERT_EQ(block.tangent[1][axis][lane], other.tangent[1][axis][lane]);
        ASSERT_EQ(block.twist_response_a[axis][lane], other.twist_response_a[axis][lane]);
        ASSERT_EQ(block.twist_response_b[axis][lane], other.twist_response_b[axis][lane]);
    }
    ASSERT_NO_FATAL_FAILURE(expect_same(block.tangent_row[0], other.tangent_row[0], lane));
    ASSERT_NO_FATAL_FAILURE(expect_same(block.tangent_row[1], other.tangent_row[1], lane));
    ASSERT_EQ(block.surface_speed[0][lane], other.surface_speed[0][lane]);
    ASSERT_EQ(block.surface_speed[1][lane], other.surface_speed[1][lane]);
    ASSERT_EQ(block.tangent_coupling[lane], other.tangent_coupling[lane]);
    ASSERT_EQ(block.twist_mass[lane], other.twist_mass[lane]);
}

TEST_P(SimdTest, PreparesRandomContactsAsScalarLanesDo) {
    const ContactKernels scalar = contact_kernels(Simd::scalar);
    const ContactKernels wide = contact_kernels(GetParam());
    Dice dice(12);
    auto block = std::make_unique<ContactBlock>();
    auto other = std::make_unique<ContactBlock>();
    PairDraw pairs;
    for (int trial = 0; trial < 4000; ++trial) {
        draw_block(*block, dice);
        pairs.draw(*block, dice);
        *other = *block;
        const std::int32_t rate = between(dice, 10, 3840);
        const std::int32_t separation_max = between(dice, 1, 4 << kLengthFraction);
        RowInputs inputs{};
        scalar.prepare(pairs.terms, rate, separation_max, inputs, *block);
        inputs = RowInputs{};
        wide.prepare(pairs.terms, rate, separation_max, inputs, *other);
        for (int lane = 0; lane < kBlockLanes; ++lane) {
            ASSERT_NO_FATAL_FAILURE(expect_same_preparation(*block, *other, lane))
                << "trial " << trial << ", lane " << lane;
        }
    }
}

/// Changes one of the things that a contact's rows are made from.
void change_an_input(PairDraw& pairs, ContactBlock& block, Dice& dice) {
    const auto lane = dice.below(kBlockLanes);
    Manifold& manifold = pairs.manifolds[lane];
    const auto body = [&]() -> BodyTerms& { return pairs.bodies[block.row_a[lane]]; };
    const auto one_of = [&](auto& values) -> auto& {
        return values[dice.below(std::size(values))];
    };
    std::int32_t& share_a = block.share_a[lane];
    std::int32_t* const inputs[] = {&one_of(manifold.normal),
                                    &one_of(manifold.tangent),
                                    &one_of(manifold.centre_delta),
                                    &one_of(manifold.anchor_a),
                                    &one_of(manifold.separation),
                                    &one_of(manifold.orientation_b),
                                    &body().inverse_inertia()[dice.below(6)],
                                    &body().inverse_gyration_radius(),
                                    &body().rotation()[dice.below(9)],
                                    &one_of(pairs.terms.centre_delta)[lane],
                                    &one_of(pairs.terms.surface_velocity)[lane],
                                    &pairs.terms.inverse_radius_min[lane],
                                    &pairs.terms.lever_max[lane],
                                    &pairs.terms.overreach_b[lane],
                                    &block.twist_lever_a[lane],
                                    &block.twist_lever_b[lane],
                                    &share_a};
    *inputs[dice.below(std::size(inputs))] ^= 1 << dice.below(20);
    block.share_b[lane] = raw_subtract(kCoefficientOne, share_a);
}

TEST_P(SimdTest, KeepsRowsThatAreMadeFromTheSameOnly) {
    const ContactKernels kernels = contact_kernels(GetParam());
    constexpr std::int32_t kRate = 240;
    constexpr std::int32_t kSeparationMax = 4 << kLengthFraction;
    Dice dice(13);
    auto block = std::make_unique<ContactBlock>();
    auto inputs = std::make_unique<RowInputs>();
    int kept = 0;
    for (int trial = 0; trial < 1000; ++trial) {
        PairDraw pairs;
        draw_block(*block, dice);
        pairs.draw(*block, dice);
        for (int lane = 0; lane < kBlockLanes; ++lane) {
            block->share_b[lane] = raw_subtract(kCoefficientOne, block->share_a[lane]);
        }
        kernels.prepare(pairs.terms, kRate, kSeparationMax, *inputs, *block);
        // A lane that is told not to be what it was made to is left alone.
        std::swap(block->normal[0][0], block->normal[1][0]);
        const std::int32_t swapped = block->normal[0][0];
        kernels.prepare(pairs.terms, kRate, kSeparationMax, *inputs, *block);
        kept += block->normal[0][0] == swapped ? 1 : 0;
        std::swap(block->normal[0][0], block->normal[1][0]);
        for (int change = 0; change < 10; ++change) {
            change_an_input(pairs, *block, dice);
            auto fresh = std::make_unique<ContactBlock>(*block);
            RowInputs none{};
            kernels.prepare(pairs.terms, kRate, kSeparationMax, *inputs, *block);
            kernels.prepare(pairs.terms, kRate, kSeparationMax, none, *fresh);
            for (int lane = 0; lane < kBlockLanes; ++lane) {
                ASSERT_NO_FATAL_FAILURE(expect_same_preparation(*block, *fresh, lane))
                    << "trial " << trial << ", lane " << lane;
            }
        }
    }
    EXPECT_GT(kept, 500) << "of blocks of several points";
}

TEST(Simd, TheBestOneIsAvailable) {
    EXPECT_TRUE(is_available(Simd::scalar));
    EXPECT_TRUE(is_available(best_simd()));
    std::cout << "best: " << to_string(best_simd()) << "\n";
}

} // namespace
} // namespace lockwind
