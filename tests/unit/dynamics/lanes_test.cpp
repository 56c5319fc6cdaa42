#include "dynamics/broad_phase.h"
#include "dynamics/contact_kernel_choice.h"
#include "dynamics/narrow_phase.h"
#include "dynamics/solver.h"
#include "tests/unit/dynamics/dynamics_bench.h"

#include <array>
#include <iostream>
#include <numbers>
#include <random>

namespace lockwind {
namespace {

/// Eight lanes by loops: what a vector unit would do to a whole block.
struct EightLanes {
    static constexpr int kWidth = 8;
    using Vector = std::array<std::int32_t, 8>;
    using Wide = std::array<std::int64_t, 8>;
    struct Factor {
        Vector value;
    };
    using One = ScalarLanes;

    template <class Operation>
    static Vector each(Operation&& operation) {
        Vector result{};
        for (std::size_t lane = 0; lane < 8; ++lane) {
            result[lane] = operation(lane);
        }
        return result;
    }
    static Vector load(const std::int32_t* from) {
        return each([=](std::size_t lane) { return from[lane]; });
    }
    static Factor load_factor(const std::int32_t* from) { return {load(from)}; }
    static void store(std::int32_t* to, const Vector& value) {
        std::copy(value.begin(), value.end(), to);
    }
    static Vector set(std::int32_t value) {
        return each([=](std::size_t) { return value; });
    }
    template <class Source>
    static void gather_quad(int first, Source&& source, Vector* out) {
        for (int lane = 0; lane < 8; ++lane) {
            for (int entry = 0; entry < 4; ++entry) {
                out[entry][static_cast<std::size_t>(lane)] = source(first + lane)[entry];
            }
        }
    }
    template <class Target>
    static void scatter_quad(int first, const Vector* values, Target&& target) {
        for (int lane = 0; lane < 8; ++lane) {
            for (int entry = 0; entry < 4; ++entry) {
                target(first + lane)[entry] = values[entry][static_cast<std::size_t>(lane)];
            }
        }
    }
    static Vector add(const Vector& a, const Vector& b) {
        return each([&](std::size_t lane) { return One::add(a[lane], b[lane]); });
    }
    static Vector subtract(const Vector& a, const Vector& b) {
        return each([&](std::size_t lane) { return One::subtract(a[lane], b[lane]); });
    }
    static Vector negate(const Vector& a) {
        return each([&](std::size_t lane) { return One::negate(a[lane]); });
    }
    template <int Shift>
    static Vector shift_right(const Vector& a) {
        return each([&](std::size_t lane) { return One::shift_right<Shift>(a[lane]); });
    }
    static Vector minimum(const Vector& a, const Vector& b) {
        return each([&](std::size_t lane) { return One::minimum(a[lane], b[lane]); });
    }
    static Vector maximum(const Vector& a, const Vector& b) {
        return each([&](std::size_t lane) { return One::maximum(a[lane], b[lane]); });
    }
    static Vector clamp(const Vector& value, const Vector& low, const Vector& high) {
        return minimum(maximum(value, low), high);
    }
    static Vector select_positive(const Vector& value, const Vector& a, const Vector& b) {
        return each(
            [&](std::size_t lane) { return One::select_positive(value[lane], a[lane], b[lane]); });
    }
    static Vector add_difference(const Vector& difference, const Vector& a, const Vector& b) {
        return each([&](std::size_t lane) {
            return One::add_difference(difference[lane], a[lane], b[lane]);
        });
    }
    static bool is_zero(const Vector& a) {
        return std::all_of(a.begin(), a.end(), [](auto value) { return One::is_zero(value); });
    }
    static Wide zero() { return {}; }
    template <int Shift>
    static Wide start(Halves halves = Halves::up) {
        Wide sum{};
        sum.fill(One::start<Shift>(halves));
        return sum;
    }
    static Wide add_product(Wide sum, const Vector& a, const Vector& b) {
        for (std::size_t lane = 0; lane < 8; ++lane) {
            sum[lane] = One::add_product(sum[lane], a[lane], b[lane]);
        }
        return sum;
    }
    static Wide add_product(const Wide& sum, const Vector& a, const Factor& b) {
        return add_product(sum, a, b.value);
    }
    template <int Shift>
    static Vector round(const Wide& sum) {
        return each([&](std::size_t lane) { return One::round<Shift>(sum[lane]); });
    }
    template <int Shift>
    static Vector round_within(const Wide& sum, std::int32_t most) {
        return each([&](std::size_t lane) { return One::round_within<Shift>(sum[lane], most); });
    }
    template <int Shift, class Multiplier>
    static Vector multiply(const Vector& a, const Multiplier& b) {
        return round<Shift>(add_product(start<Shift>(), a, b));
    }
    template <int Power>
    static Vector reciprocal(const Vector& value) {
        return each([&](std::size_t lane) { return One::reciprocal<Power>(value[lane]); });
    }
    static Vector root(const Wide& sum) {
        return each([&](std::size_t lane) { return One::root(sum[lane]); });
    }
    static void clamp_to_cone(Vector& first, Vector& second, const Vector& limit) {
        for (std::size_t lane = 0; lane < 8; ++lane) {
            One::clamp_to_cone(first[lane], second[lane], limit[lane]);
        }
    }
};

/// A heap whose contacts have one to four points, in blocks that mix them; more bodies on one body
/// than there are colours.
void add_mixed_heap(DynamicsBench& bench) {
    bench.add(ground());
    bench.add(box(6, 0.2, 6, vec(0, 0.2, 0)));
    std::mt19937 random(21);
    const auto turn = [&] { return real(std::ldexp(static_cast<double>(random()), -31) - 1); };
    for (int index = 0; index < 100; ++index) {
        const Vec3 position =
            vec((index % 10 - 4.5) * 1.1, index < 60 ? 0.85 : 1.9, (index / 10 % 10 - 4.5) * 1.1);
        BodyDefinition body = index % 4 == 0 ? ball(0.4, position) : cube(0.4, position);
        if (index % 4 == 2) {
            body = box(0.3, 0.45, 0.4, position);
            body.orientation = {turn(), turn(), turn(), 1};
        } else if (index % 4 == 3) {
            body = ball(0.2, position);
            body.shape.type = ShapeType::capsule;
            body.shape.half_height = 0.3;
            body.orientation = {0, 0, 1, 1};
        }
        bench.add(body);
    }
}

/// The solver alone, with kernels of a test's choice.
class SolverRun {
public:
    explicit SolverRun(const ContactKernels& kernels) : settings_(make_settings()) {
        frames_ = std::make_unique<BodyFrames>(settings_.body_capacity);
        solver_ = std::make_unique<Solver>(settings_, kernels);
        add_mixed_heap(bench_);
    }
    void step() {
        const DynamicsTables tables = bench_.tables();
        ++bench_.state().tick;
        ASSERT_EQ(bench_.dynamics().broad_phase(tables), StepFault::none);
        ASSERT_EQ(bench_.dynamics().narrow_phase(tables), StepFault::none);
        const Activity activity = bench_.activity();
        frames_->refresh(tables, activity.rows());
        frames_->refresh(tables, activity.partners());
        solver_->solve(tables, *frames_, activity);
        solver_->restitution(tables);
    }
    DynamicsBench& bench() { return bench_; }

private:
    static DynamicsSettings make_settings() {
        DynamicsSettings settings;
        settings.gravity = WorldSettings{}.gravity;
        settings.body_capacity = 256;
        settings.pair_capacity = 4096;
        settings.manifold_capacity = 2048;
        return settings;
    }
    DynamicsSettings settings_;
    DynamicsBench bench_;
    std::unique_ptr<BodyFrames> frames_;
    std::unique_ptr<Solver> solver_;
};

/// Steps the heap with scalar kernels and with others.
void expect_same_steps(const ContactKernels& kernels) {
    SolverRun narrow(kernels_of<ScalarLanes>());
    SolverRun wide(kernels);
    std::uint32_t with_points[5] = {};
    for (int tick = 0; tick < 90; ++tick) {
        narrow.step();
        wide.step();
        ASSERT_TRUE(same_bits(narrow.bench().state(), wide.bench().state())) << "tick " << tick;
        for (const Pair& pair : narrow.bench().tables().pairs.rows()) {
            ++with_points[pair.point_count];
        }
    }
    for (int points = 1; points <= 4; ++points) {
        EXPECT_GT(with_points[points], 50U) << points << " points";
    }
}

TEST(Lanes, WidthChangesNoBit) {
    expect_same_steps(kernels_of<EightLanes>());
}

TEST(Lanes, NoInstructionSetChangesABitOfAHeap) {
    int available = 0;
    for (int simd = 1; simd < kSimdCount; ++simd) {
        if (is_available(static_cast<Simd>(simd))) {
            SCOPED_TRACE(to_string(static_cast<Simd>(simd)));
            expect_same_steps(contact_kernels(static_cast<Simd>(simd)));
            ++available;
        }
    }
    std::cout << available << " instruction sets beside the scalar one\n";
    EXPECT_EQ(available > 0, best_simd() != Simd::scalar);
}

TEST(Lanes, ConeKeepsDirectionAndLength) {
    std::mt19937 random(4);
    for (int trial = 0; trial < 20000; ++trial) {
        const auto draw = [&] {
            return static_cast<std::int32_t>(static_cast<std::uint32_t>(random())) >>
                   (random() % 28);
        };
        const std::int32_t x = draw();
        const std::int32_t y = draw();
        const std::int32_t limit = std::abs(draw() >> 1);
        std::int32_t first = x;
        std::int32_t second = y;
        clamp_to_cone(first, second, limit);
        const double length = std::hypot(x, y);
        if (length <= limit) {
            EXPECT_EQ(first, x);
            EXPECT_EQ(second, y);
            continue;
        }
        // A unit each from the length's and the product's rounding, 2^-28 from the scale's.
        EXPECT_NEAR(first, x * (limit / length), 2 + length * 4e-9);
        EXPECT_NEAR(second, y * (limit / length), 2 + length * 4e-9);
        EXPECT_LE(std::hypot(first, second), limit + 2);
    }
}

TEST(Lanes, SoftnessIsTheClosedForm) {
    for (const std::uint32_t rate : {10U, 60U, 120U, 240U, 480U, 3840U}) {
        for (const auto& [factor, damping] : {std::pair{1, 10}, std::pair{2, 5}}) {
            const double hertz = std::min(30.0, rate / 8.0) * factor;
            const double x = 2 * std::numbers::pi * hertz / rate;
            const double a1 = 2 * damping + x;
            const double a3 = 1 / (1 + x * a1);
            const Softness softness = make_softness(rate, factor, damping);
            EXPECT_NEAR(std::ldexp(softness.impulse_scale, -28), a3, 2e-8);
            EXPECT_NEAR(std::ldexp(softness.mass_scale, -28), 1 - a3, 2e-8);
            EXPECT_NEAR(std::ldexp(softness.bias_rate, -28), (1 - a3) * x / a1, 2e-8);
        }
    }
}

TEST(Lanes, ReciprocalDividesToTwoPartsInABillion) {
    std::mt19937_64 random(8);
    for (std::uint32_t divisor = 10; divisor <= 3840; divisor += 7) {
        const Reciprocal reciprocal = make_reciprocal(divisor);
        EXPECT_GE(reciprocal.multiplier, std::int64_t{1} << 28);
        EXPECT_LE(reciprocal.multiplier, std::int64_t{1} << 29);
        for (int trial = 0; trial < 20; ++trial) {
            const auto value = static_cast<std::int64_t>(random() >> 31) - (std::int64_t{1} << 32);
            const double exact = std::ldexp(static_cast<double>(value), 12) / divisor;
            EXPECT_NEAR(static_cast<double>(divide(value, reciprocal, 12)),
                        exact,
                        1 + 2e-9 * std::abs(exact));
        }
    }
}

TEST(Lanes, GravityOfATickIsRoundedOnce) {
    for (const std::uint32_t substeps : {1U, 3U, 4U, 7U, 16U}) {
        DynamicsSettings settings;
        settings.tick_rate_hz = 60;
        settings.substeps = substeps;
        settings.gravity = vec(1.234, -9.81, 0);
        const StepConstants constants = make_step_constants(settings);
        std::int64_t sum[3] = {};
        for (std::uint32_t substep = 0; substep < substeps; ++substep) {
            for (int axis = 0; axis < 3; ++axis) {
                sum[axis] += constants.gravity[substep][axis];
            }
        }
        EXPECT_EQ(sum[0], std::llround(std::ldexp(1.234 / 60, 20)));
        EXPECT_EQ(sum[1], std::llround(std::ldexp(-9.81 / 60, 20)));
        EXPECT_EQ(sum[2], 0);
    }
}

TEST(Lanes, SeparationsFitTheVelocityFormatAtEveryRate) {
    for (const std::uint32_t rate : {10U, 60U, 240U}) {
        for (const std::uint32_t substeps : {1U, 4U, 16U}) {
            DynamicsSettings settings;
            settings.tick_rate_hz = rate;
            settings.substeps = substeps;
            const StepConstants constants = make_step_constants(settings);
            const double speed = std::ldexp(constants.separation_max, -22) * rate * substeps;
            EXPECT_LE(speed, 960);
            EXPECT_GE(std::ldexp(constants.separation_max, -22), 0.2);
        }
    }
}

} // namespace
} // namespace lockwind
