#include "geometry/mass.h"
#include "reference.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

using reference::Body;
using reference::Random;

constexpr double kPi = 3.14159265358979323846;

double value(Real real) {
    return static_cast<double>(real.raw()) * 0x1p-32;
}
double value(SquareMetres squares) {
    return static_cast<double>(squares.raw()) * 0x1p-44;
}

void expect_relative(double found, double expected) {
    EXPECT_NEAR(found, expected, 1e-8 * expected);
}

/// Moment of inertia / mass of a capsule about its axis (column 1) or across, by summing discs.
double capsule_moment(double r, double h, bool along) {
    const int slices = 200000;
    double mass = 0;
    double moment = 0;
    const double thickness = 2 * (h + r) / slices;
    for (int slice = 0; slice < slices; ++slice) {
        const double y = -(h + r) + (slice + 0.5) * thickness;
        const double beyond = std::max(0.0, std::abs(y) - h);
        const double square = r * r - beyond * beyond;
        mass += square;
        moment += square * (along ? square / 2 : square / 4 + y * y);
    }
    return moment / mass;
}

TEST(Mass, OfAUnitCubeIsItsDensity) {
    EXPECT_EQ(mass_of(ShapeType::box, Body::box(0.5, 0.5, 0.5).size, 1000), Real(1000));
}

TEST(Mass, FollowsTheClosedFormsFromCentimetresToHundredsOfMetres) {
    Random random(31);
    for (int round = 0; round < 2000; ++round) {
        const auto size = [&] { return std::exp(random.uniform(std::log(0.01), std::log(60.0))); };
        const Body sphere = Body::sphere(size());
        const Body capsule = Body::capsule(size(), size());
        const Body box = Body::box(size(), size(), size());
        const double r = capsule.extent(0);
        const double h = capsule.extent(1);
        const double density = 750;
        const auto check = [&](const Body& body, double volume) {
            const double expected = volume * density;
            EXPECT_NEAR(
                value(mass_of(body.type, body.size, 750)), expected, 1e-12 * expected + 0x1p-32);
        };
        check(sphere, 4.0 / 3 * kPi * std::pow(sphere.extent(0), 3));
        check(capsule, kPi * r * r * (2 * h + 4.0 / 3 * r));
        check(box, 8 * box.extent(0) * box.extent(1) * box.extent(2));
    }
}

TEST(Mass, SaturatesInsteadOfOverflowing) {
    EXPECT_EQ(mass_of(ShapeType::box, Body::box(250, 250, 250).size, 1000000), Real::highest());
    EXPECT_EQ(mass_of(ShapeType::sphere, Body::sphere(250).size, Real::highest()), Real::highest());
    EXPECT_EQ(mass_of(ShapeType::sphere, Body::sphere(1).size, 0), Real(0));
}

TEST(Mass, OfTheSmallestBodyKeepsItsDigits) {
    const Body sphere = Body::sphere(0.01);
    const double expected = 4.0 / 3 * kPi * std::pow(sphere.extent(0), 3) * 1000;
    EXPECT_NEAR(value(mass_of(ShapeType::sphere, sphere.size, 1000)), expected, 0x1p-32);
}

TEST(UnitInertia, OfSphereAndBoxFollowTheClosedForms) {
    const double sizes[] = {0.01, 0.37, 1, 12.5, 250};
    for (const double size : sizes) {
        const Body sphere = Body::sphere(size);
        const UnitInertia inertia = unit_inertia(sphere.type, sphere.size);
        for (const SquareMetres moment : inertia.moment) {
            expect_relative(value(moment), 0.4 * sphere.extent(0) * sphere.extent(0));
        }
        for (const double other : sizes) {
            const Body box = Body::box(size, other, 2);
            const UnitInertia of_box = unit_inertia(box.type, box.size);
            for (int axis = 0; axis < 3; ++axis) {
                const double j = box.extent((axis + 1) % 3);
                const double k = box.extent((axis + 2) % 3);
                expect_relative(value(of_box.moment[axis]), (j * j + k * k) / 3);
            }
        }
    }
}

TEST(UnitInertia, OfACapsuleIsTheSumOfItsDiscs) {
    const double sizes[][2] = {{0.01, 0.01}, {0.3, 0.5}, {2, 0.05}, {0.1, 5}, {250, 250}};
    for (const auto& size : sizes) {
        const Body capsule = Body::capsule(size[0], size[1]);
        const UnitInertia inertia = unit_inertia(capsule.type, capsule.size);
        const double along = capsule_moment(capsule.extent(0), capsule.extent(1), true);
        const double across = capsule_moment(capsule.extent(0), capsule.extent(1), false);
        EXPECT_NEAR(value(inertia.moment[1]), along, 1e-6 * along);
        EXPECT_NEAR(value(inertia.moment[0]), across, 1e-6 * across);
        EXPECT_EQ(inertia.moment[0], inertia.moment[2]);
    }
}

} // namespace
} // namespace lockwind
