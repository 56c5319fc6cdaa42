#include "geometry/compound.h"
#include "geometry/rotation.h"
#include "hull_points.h"

#include <cmath>
#include <gtest/gtest.h>

namespace lockwind {
namespace {

using namespace reference;

CompoundChild child(const ShapeDefinition& shape, const Vec3& position) {
    return {shape, position, {}, 1};
}

ShapeDefinition sphere(Real radius) {
    ShapeDefinition shape;
    shape.radius = radius;
    return shape;
}

ShapeDefinition box(const Vec3& half_extents) {
    ShapeDefinition shape;
    shape.type = ShapeType::box;
    shape.half_extents = half_extents;
    return shape;
}

Compound made(const std::vector<CompoundChild>& children, std::span<const Hull> hulls = {}) {
    const Result<Compound> compound = make_compound({children}, hulls);
    EXPECT_TRUE(compound.ok()) << (compound.ok() ? "" : compound.error().message);
    return compound.ok() ? compound.value() : Compound{};
}

double moment(const UnitInertia& inertia, int axis) {
    return static_cast<double>(inertia.moment[axis].raw()) * 0x1p-44;
}

double volume_of(const Volume& volume) {
    return std::ldexp(static_cast<double>(volume.mantissa), -volume.fraction);
}

TEST(Compound, OfTwoBallsIsADumbbell) {
    // m r^2 2/5 each about the line, and m d^2 more across it.
    const Compound dumbbell =
        made({child(sphere(0.25), {0.5, 1, 0}), child(sphere(0.25), {-0.5, 1, 0})});
    EXPECT_NEAR(metres(dumbbell.centre)[1], 1, 1e-6);
    EXPECT_NEAR(metres(dumbbell.centre)[0], 0, 1e-6);
    EXPECT_NEAR(moment(dumbbell.inertia, 0), 0.4 * 0.0625, 1e-8);
    EXPECT_NEAR(moment(dumbbell.inertia, 1), 0.4 * 0.0625 + 0.25, 1e-7);
    EXPECT_NEAR(moment(dumbbell.inertia, 2), 0.4 * 0.0625 + 0.25, 1e-7);
    EXPECT_NEAR(volume_of(dumbbell.volume), 2 * 4.0 / 3 * M_PI * 0.015625, 1e-9);
    EXPECT_NEAR(dumbbell.bounding_radius * kLengthUlp, 0.75, 1e-5);
    EXPECT_NEAR(dumbbell.arm[0] * kLengthUlp, 0.25, 1e-5);
    EXPECT_NEAR(dumbbell.arm[1] * kLengthUlp, 0.75, 1e-5);
}

TEST(Compound, OfTwoHalvesIsTheWholeBox) {
    const Compound halves = made(
        {child(box({0.5, 0.25, 0.75}), {0.5, 3, 0}), child(box({0.5, 0.25, 0.75}), {-0.5, 3, 0})});
    const double half[3] = {1, 0.25, 0.75};
    for (int axis = 0; axis < 3; ++axis) {
        const double j = half[(axis + 1) % 3];
        const double k = half[(axis + 2) % 3];
        EXPECT_NEAR(moment(halves.inertia, axis), (j * j + k * k) / 3, 1e-7);
    }
    EXPECT_NEAR(volume_of(halves.volume), 8 * 1 * 0.25 * 0.75, 1e-9);
    EXPECT_EQ(halves.orientation[3], kUnitOne); // symmetrical: the axes that it was given in
}

TEST(Compound, WeighsChildrenByTheirDensity) {
    std::vector<CompoundChild> children{child(sphere(0.5), {0, 0, 0}),
                                        child(sphere(0.5), {4, 0, 0})};
    children[1].density = 3;
    const Compound compound = made(children);
    EXPECT_NEAR(metres(compound.centre)[0], 3, 1e-6);
    EXPECT_NEAR(volume_of(compound.volume), 4 * 4.0 / 3 * M_PI * 0.125, 1e-8);
    // About the centre: (1 x 3^2 + 3 x 1^2) / 4 + 2/5 r^2.
    EXPECT_NEAR(moment(compound.inertia, 1), 3 + 0.1, 1e-6);
}

/// Sum over children in double precision, by the parallel axis theorem, about a point.
struct Tensor {
    double entry[3][3] = {};
};

Tensor tensor_about(const std::vector<Body>& bodies,
                    const std::vector<Vec>& places,
                    const std::vector<double>& masses,
                    const std::vector<Vec>& moments,
                    const Vec& centre,
                    double mass) {
    Tensor sum;
    for (std::size_t index = 0; index < bodies.size(); ++index) {
        const Vec r = places[index] - centre;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                double own = 0;
                for (int axis = 0; axis < 3; ++axis) {
                    own += bodies[index].axis(axis)[i] * bodies[index].axis(axis)[j] *
                           moments[index][axis];
                }
                sum.entry[i][j] +=
                    masses[index] / mass * (own + (i == j ? dot(r, r) : 0) - r[i] * r[j]);
            }
        }
    }
    return sum;
}

TEST(Compound, HasTheMassAndAxesOfItsChildren) {
    Random random(21);
    for (int round = 0; round < 200; ++round) {
        std::vector<CompoundChild> children;
        std::vector<Body> bodies;
        std::vector<Vec> places;
        std::vector<double> masses;
        std::vector<Vec> moments;
        double mass = 0;
        Vec first{0, 0, 0};
        const int count = 1 + static_cast<int>(random.bits() % 6);
        for (int index = 0; index < count; ++index) {
            const Vec half{random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)};
            const Vec place{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
            const Vec axis = random.direction();
            const double angle = random.uniform(0, 3);
            const double density = random.uniform(0.1, 5);
            const double s = std::sin(angle / 2);
            const Vec3 q = to_real(axis * s);
            children.push_back({box(to_real(half)),
                                to_real(place),
                                {q.x, q.y, q.z, to_real(Vec{std::cos(angle / 2), 0, 0}).x},
                                to_real(Vec{density, 0, 0}).x});
            bodies.push_back(Body::box(half[0], half[1], half[2]).turn(axis, angle));
            places.push_back(place);
            masses.push_back(8 * half[0] * half[1] * half[2] * density);
            moments.push_back({(half[1] * half[1] + half[2] * half[2]) / 3,
                               (half[2] * half[2] + half[0] * half[0]) / 3,
                               (half[0] * half[0] + half[1] * half[1]) / 3});
            mass += masses.back();
            first = first + place * masses.back();
        }
        const Compound compound = made(children);
        const Vec centre = first * (1 / mass);
        const Tensor tensor = tensor_about(bodies, places, masses, moments, centre, mass);
        EXPECT_NEAR(volume_of(compound.volume) / mass, 1, 1e-6);
        EXPECT_LT(length(metres(compound.centre) - centre), 4e-6);
        std::int32_t rotation[9];
        rotation_matrix(compound.orientation, rotation);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                double entry = 0;
                for (int axis = 0; axis < 3; ++axis) {
                    entry += rotation[3 * i + axis] * kUnitUlp * rotation[3 * j + axis] * kUnitUlp *
                             moment(compound.inertia, axis);
                }
                EXPECT_NEAR(entry, tensor.entry[i][j], 2e-5);
            }
        }
        // Each child stands where it did.
        for (int index = 0; index < count; ++index) {
            const CompoundShape& part = compound.children[index];
            const Vec own = metres(part.position);
            Vec given = centre;
            for (int axis = 0; axis < 3; ++axis) {
                given = given + Vec{rotation[axis] * kUnitUlp,
                                    rotation[3 + axis] * kUnitUlp,
                                    rotation[6 + axis] * kUnitUlp} *
                                    own[axis];
            }
            EXPECT_LT(length(given - places[static_cast<std::size_t>(index)]), 4e-6);
        }
    }
}

TEST(Compound, OfOneHullIsThatHull) {
    Random random(22);
    for (int round = 0; round < 50; ++round) {
        const Hull hull = random_hull(random, 12, 1);
        ShapeDefinition shape;
        shape.type = ShapeType::hull;
        const Compound compound = made({child(shape, {0, 0, 0})}, {&hull, 1});
        EXPECT_LT(length(metres(compound.centre) - metres(hull.centre)), 1e-6);
        EXPECT_NEAR(compound.bounding_radius, hull.bounding_radius, 16);
        double sorted[2][3];
        for (int axis = 0; axis < 3; ++axis) {
            sorted[0][axis] = moment(compound.inertia, axis);
            sorted[1][axis] = moment(hull.inertia, axis);
        }
        std::sort(sorted[0], sorted[0] + 3);
        std::sort(sorted[1], sorted[1] + 3);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(sorted[0][axis], sorted[1][axis], 1e-6);
        }
    }
}

TEST(Compound, RefusesWhatItCannotBeMadeOf) {
    const auto refusal = [](const std::vector<CompoundChild>& children) {
        const Result<Compound> compound = make_compound({children}, {});
        return compound.ok() ? "" : compound.error().message;
    };
    const CompoundChild ball = child(sphere(0.5), {});
    EXPECT_EQ(refusal({}), "has 0 children; give 1 .. 32");
    EXPECT_EQ(refusal(std::vector<CompoundChild>(33, ball)), "has 33 children; give 1 .. 32");
    EXPECT_EQ(refusal({ball, child(sphere(0.001), {})}),
              "child 1 has a size out of range; give 0.01 .. 250 m");
    EXPECT_EQ(refusal({child(sphere(1), {251, 0, 0})}), "child 0 has a position beyond 250 m");
    ShapeDefinition shape;
    shape.type = ShapeType::hull;
    EXPECT_EQ(refusal({child(shape, {})}), "child 0 is hull 0; there are 0 hulls");
    for (const ShapeType type :
         {ShapeType::plane, ShapeType::compound, ShapeType::mesh, ShapeType::height_field}) {
        shape.type = type;
        EXPECT_EQ(refusal({child(shape, {})}), "child 0 is no sphere, capsule, box or hull");
    }
    CompoundChild still = ball;
    still.orientation = {0, 0, 0, 0};
    EXPECT_EQ(refusal({still}), "child 0 has orientation 0; it must be a rotation");
    CompoundChild light = ball;
    light.density = 0;
    EXPECT_EQ(refusal({light}),
              "child 0 has a density out of range; give 0.001 .. 1000 times the body's");
}

} // namespace
} // namespace lockwind
