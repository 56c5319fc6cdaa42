#include "geometry/rotation.h"
#include "reference.h"

#include "lockwind/integer.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

using reference::kUnitUlp;
using reference::Random;
using reference::raw_length;
using reference::Vec;

TEST(Rotation, IdentityIsExact) {
    const std::int32_t orientation[4] = {0, 0, 0, kUnitOne};
    std::int32_t rotation[9];
    rotation_matrix(orientation, rotation);
    for (int entry = 0; entry < 9; ++entry) {
        EXPECT_EQ(rotation[entry], kIdentityRotation[entry]);
    }
}

TEST(Rotation, HalfTurnAboutYIsExact) {
    const std::int32_t orientation[4] = {0, kUnitOne, 0, 0};
    std::int32_t rotation[9];
    rotation_matrix(orientation, rotation);
    const std::int32_t v[3] = {100, 200, 300};
    std::int32_t turned[3];
    rotate(rotation, v, turned);
    EXPECT_EQ(turned[0], -100);
    EXPECT_EQ(turned[1], 200);
    EXPECT_EQ(turned[2], -300);
}

TEST(Rotation, QuarterTurnAboutZTakesXToY) {
    // sqrt(1/2) in Q2.30.
    const std::int32_t orientation[4] = {0, 0, 759250125, 759250125};
    std::int32_t rotation[9];
    rotation_matrix(orientation, rotation);
    const std::int32_t v[3] = {raw_length(3), 0, 0};
    std::int32_t turned[3];
    rotate(rotation, v, turned);
    EXPECT_EQ(turned[0], 0);
    EXPECT_EQ(turned[1], raw_length(3));
    EXPECT_EQ(turned[2], 0);
}

TEST(Rotation, MatrixOfRandomTurnsIsOrthonormalAndRight) {
    Random random(11);
    for (int round = 0; round < 2000; ++round) {
        reference::Body body = reference::Body::box(1, 1, 1);
        const Vec axis = random.direction();
        const double angle = random.uniform(0, 6.28);
        body.turn(axis, angle);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                EXPECT_NEAR(
                    reference::dot(body.axis(i), body.axis(j)), i == j ? 1 : 0, 8 * kUnitUlp);
            }
        }
        // Rodrigues' formula.
        const Vec v = random.direction();
        const Vec turned = v * std::cos(angle) + reference::cross(axis, v) * std::sin(angle) +
                           axis * (reference::dot(axis, v) * (1 - std::cos(angle)));
        EXPECT_LT(reference::length(body.to_world(v) - turned), 8 * kUnitUlp);
    }
}

TEST(Rotation, InverseUndoesTheTurn) {
    Random random(12);
    for (int round = 0; round < 2000; ++round) {
        reference::Body body = reference::Body::box(1, 1, 1);
        body.turn(random.direction(), random.uniform(0, 6.28));
        const Vec v = random.direction() * random.uniform(0, 500);
        const std::int32_t raw[3] = {raw_length(v[0]), raw_length(v[1]), raw_length(v[2])};
        std::int32_t turned[3];
        std::int32_t back[3];
        rotate(body.rotation, raw, turned);
        inverse_rotate(body.rotation, turned, back);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(back[axis], raw[axis], 12); // 2^-29 of 500 m, twice
        }
    }
}

TEST(Rotation, WideDotRoundsTheExactSumOnceHalfUp) {
    Random random(13);
    for (int round = 0; round < 5000; ++round) {
        const Vec direction = random.direction();
        std::int32_t unit[3];
        std::int64_t v[3];
        Int128 sum = 0;
        for (int axis = 0; axis < 3; ++axis) {
            unit[axis] = static_cast<std::int32_t>(direction[axis] / kUnitUlp);
            v[axis] = static_cast<std::int64_t>(random.bits()) >> (10 + random.bits() % 40);
            sum = raw_add(sum, wide_product<Int128>(unit[axis], v[axis]));
        }
        EXPECT_EQ(dot_unit(unit, v), raw_narrow<std::int64_t>(round_shift(sum, kUnitFraction)));
    }
}

TEST(Normalise, KeepsShortVectorsExact) {
    const std::int32_t v[3] = {1, 1, 0};
    std::int32_t unit[3];
    EXPECT_EQ(normalise(v, unit), 1);
    EXPECT_NEAR(unit[0], 759250125, 2);
    EXPECT_NEAR(unit[1], 759250125, 2);
    EXPECT_EQ(unit[2], 0);
}

TEST(Normalise, AlongAnAxisIsExactAtEveryLength) {
    for (std::int32_t length = 1; length > 0 && length < (1 << 30); length = length * 3 + 1) {
        const std::int32_t v[3] = {0, -length, 0};
        std::int32_t unit[3];
        EXPECT_EQ(normalise(v, unit), length);
        EXPECT_EQ(unit[0], 0);
        EXPECT_EQ(unit[1], -kUnitOne);
        EXPECT_EQ(unit[2], 0);
    }
}

TEST(Normalise, LeavesTheUnitOfNothingAlone) {
    const std::int32_t v[3] = {0, 0, 0};
    std::int32_t unit[3] = {1, 2, 3};
    EXPECT_EQ(normalise(v, unit), 0);
    EXPECT_EQ(unit[1], 2);
}

TEST(Normalise, IsWithinTwoUlpAtEveryScale) {
    Random random(14);
    for (int round = 0; round < 5000; ++round) {
        const Vec direction = random.direction();
        const double size = std::exp2(random.uniform(4, 31));
        std::int32_t v[3];
        for (int axis = 0; axis < 3; ++axis) {
            v[axis] = static_cast<std::int32_t>(direction[axis] * size);
        }
        std::int32_t unit[3];
        const std::int32_t found = normalise(v, unit);
        const Vec exact = reference::metres(v);
        const double exact_length = reference::length(exact) / reference::kLengthUlp;
        EXPECT_LE(found, exact_length);
        EXPECT_GT(found, exact_length - 1.001);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(
                unit[axis] * kUnitUlp, exact[axis] / reference::length(exact), 2 * kUnitUlp);
        }
    }
}

} // namespace
} // namespace lockwind
