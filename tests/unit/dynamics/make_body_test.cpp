#include "dynamics/make_body.h"

#include "lockwind/wide.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <string>

namespace lockwind {
namespace {

double value(Real real) {
    return static_cast<double>(real.raw()) * 0x1p-32;
}

double fixed_value(std::int64_t raw, int fraction) {
    return std::ldexp(static_cast<double>(raw), -fraction);
}

BodyDefinition crate() {
    BodyDefinition definition;
    definition.id = 7;
    definition.shape.type = ShapeType::box;
    definition.shape.half_extents = {0.5, 0.25, 1};
    definition.position = {1.5, -2, 30000};
    definition.linear_velocity = {3, 0, -4};
    definition.angular_velocity = {0, 2, 0};
    return definition;
}

struct Made {
    BodyMotion motion{};
    BodyProperties properties{};
    std::string error; // "" where it was made
};

Made make(const BodyDefinition& definition, const WorldSettings& settings = {}) {
    Made made;
    const Status status = make_body(definition, settings, {}, made.motion, made.properties);
    if (!status) {
        made.error = status.error().message;
    }
    return made;
}

TEST(MakeBody, FillsTheRowsOfABox) {
    const Made made = make(crate());
    ASSERT_EQ(made.error, "");
    const BodyMotion& motion = made.motion;
    const BodyProperties& properties = made.properties;
    EXPECT_EQ(motion.id, 7U);
    EXPECT_EQ(motion.position[0], std::int64_t{3} << 31);
    EXPECT_EQ(motion.orientation[3], 1 << 30);
    EXPECT_EQ(motion.linear_velocity[0], 3 << 20);
    EXPECT_EQ(motion.linear_velocity[2], -(4 << 20));
    EXPECT_EQ(properties.size[0], 1 << 21);
    EXPECT_EQ(properties.size[1], 1 << 20);
    EXPECT_EQ(properties.size[2], 1 << 22);
    // 1 m x 0.5 m x 2 m of water: 1000 kg; floor(2^40 / 1000).
    EXPECT_EQ(properties.inverse_mass, 1099511627);
    EXPECT_NEAR(fixed_value(properties.bounding_radius, 22), std::sqrt(1.3125), 3e-7);
    EXPECT_EQ(properties.friction, 1 << 27);
    EXPECT_EQ(properties.restitution, 0);
    EXPECT_EQ(properties.mode, static_cast<std::uint8_t>(BodyMode::dynamic));
    EXPECT_EQ(properties.shape, static_cast<std::uint8_t>(ShapeType::box));
}

TEST(MakeBody, GyrationRadiusScalesInertiaAndAngularVelocity) {
    const Made made = make(crate());
    const double k[3] = {(0.0625 + 1) / 3, (0.25 + 1) / 3, (0.25 + 0.0625) / 3};
    const double rho = std::pow(k[2] * k[1], 0.25);
    EXPECT_NEAR(fixed_value(made.properties.gyration_radius, 22), rho, 3e-7);
    EXPECT_NEAR(fixed_value(made.properties.inverse_gyration_radius, 24), 1 / rho, 2e-6);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(
            fixed_value(made.properties.inverse_inertia[axis], 26), rho * rho / k[axis], 2e-6);
    }
    EXPECT_EQ(made.motion.angular_velocity[0], 0);
    EXPECT_NEAR(fixed_value(made.motion.angular_velocity[1], 20), 2 * rho, 1e-6);
}

TEST(MakeBody, InverseInertiaIsTheRadiusSquaredOverK) {
    // Whatever the rounding of the radius, the stored numbers fit each other: I^-1 = ratio / (m
    // rho^2).
    for (const double size : {0.01, 0.02, 0.35, 3.0, 40.0}) {
        BodyDefinition definition = crate();
        definition.mass = 1;
        definition.angular_velocity = {};
        const auto raw = static_cast<std::int64_t>(size * 0x1p32);
        definition.shape.half_extents = {
            Real::from_raw(raw),
            Real::from_raw(raw * 2),
            Real::from_raw(raw / 2 < kShapeSizeMin.raw() ? raw : raw / 2)};
        definition.shape.half_extents.y = std::min(definition.shape.half_extents.y, Real(60));
        const Made made = make(definition);
        ASSERT_EQ(made.error, "");
        const double rho = fixed_value(made.properties.gyration_radius, 22);
        EXPECT_NEAR(rho * fixed_value(made.properties.inverse_gyration_radius, 24), 1, 1e-5);
        for (int axis = 0; axis < 3; ++axis) {
            const double j = fixed_value(made.properties.size[(axis + 1) % 3], 22);
            const double k = fixed_value(made.properties.size[(axis + 2) % 3], 22);
            const double exact = rho * rho / ((j * j + k * k) / 3);
            EXPECT_NEAR(
                fixed_value(made.properties.inverse_inertia[axis], 26), exact, exact * 1e-7);
        }
    }
}

TEST(MakeBody, SmallestSphereKeepsItsInertiaBehindAClampedRadius) {
    BodyDefinition definition;
    definition.id = 1;
    definition.shape.radius = 0.01;
    definition.angular_velocity = {0, 0, 50};
    const Made made = make(definition);
    ASSERT_EQ(made.error, "");
    const double rho = fixed_value(made.properties.gyration_radius, 22);
    EXPECT_GE(rho, 1.0 / 127);
    EXPECT_LT(rho, 1.0 / 127 + 3e-7);
    EXPECT_LT(made.properties.inverse_gyration_radius, 127 << 24);
    const double radius = fixed_value(made.properties.size[0], 22);
    EXPECT_NEAR(fixed_value(made.properties.inverse_inertia[0], 26),
                rho * rho / (0.4 * radius * radius),
                1e-6);
    EXPECT_NEAR(value(read_body(made.motion, made.properties, {}).angular_velocity.z), 50, 1e-3);
}

TEST(MakeBody, NormalisesTheOrientationAtEveryScale) {
    for (const std::int64_t scale :
         {std::int64_t{1}, std::int64_t{1000}, std::int64_t{1} << 32, std::int64_t{1} << 60}) {
        BodyDefinition definition = crate();
        definition.orientation.x = Real::from_raw(scale);
        definition.orientation.y = Real::from_raw(-scale);
        definition.orientation.z = Real::from_raw(scale);
        definition.orientation.w = Real::from_raw(scale);
        const Made made = make(definition);
        ASSERT_EQ(made.error, "");
        EXPECT_EQ(made.motion.orientation[0], 1 << 29);
        EXPECT_EQ(made.motion.orientation[1], -(1 << 29));
        EXPECT_EQ(made.motion.orientation[3], 1 << 29);
    }
    BodyDefinition lowest = crate();
    lowest.orientation = {Real::lowest(), 0, 0, 0};
    EXPECT_EQ(make(lowest).motion.orientation[0], -(1 << 30));
}

TEST(MakeBody, FatBoundsComeOutEmpty) {
    const Made made = make(crate());
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GT(made.motion.fat_bounds[axis], made.motion.fat_bounds[axis + 3]);
    }
}

TEST(MakeBody, MassOverridesDensity) {
    BodyDefinition definition = crate();
    definition.mass = 3;
    definition.density = 5;
    EXPECT_EQ(make(definition).properties.inverse_mass, (std::int64_t{1} << 40) / 3);
}

TEST(MakeBody, EveryAllowedMassHasAnInverseThatFits) {
    for (const Real mass : {kBodyMassMin, Real(0.001), Real(1), Real(12345), kBodyMassMax}) {
        BodyDefinition definition = crate();
        definition.mass = mass;
        const Made made = make(definition);
        ASSERT_EQ(made.error, "");
        EXPECT_GT(made.properties.inverse_mass, 1000);
        EXPECT_LT(made.properties.inverse_mass, std::int64_t{1} << 60);
        const double read = value(read_body(made.motion, made.properties, {}).mass);
        EXPECT_NEAR(read, value(mass), value(mass) * 1e-3);
    }
}

TEST(MakeBody, OnlyDynamicBodiesHaveMass) {
    for (const BodyMode mode : {BodyMode::fixed, BodyMode::kinematic}) {
        BodyDefinition definition = crate();
        definition.mode = mode;
        if (mode == BodyMode::fixed) {
            definition.linear_velocity = {};
            definition.angular_velocity = {};
        }
        const Made made = make(definition);
        ASSERT_EQ(made.error, "");
        EXPECT_EQ(made.properties.inverse_mass, 0);
        for (const std::int32_t ratio : made.properties.inverse_inertia) {
            EXPECT_EQ(ratio, 0);
        }
        EXPECT_EQ(read_body(made.motion, made.properties, {}).mass, Real(0));
    }
}

TEST(MakeBody, KinematicBodiesTurnByTheirBoundingRadius) {
    BodyDefinition definition = crate();
    definition.mode = BodyMode::kinematic;
    definition.shape.half_extents = {50, 0.01, 0.01}; // no inertia: as slender as it likes
    const Made made = make(definition);
    ASSERT_EQ(made.error, "");
    EXPECT_EQ(made.properties.gyration_radius, made.properties.bounding_radius);
    EXPECT_NEAR(value(read_body(made.motion, made.properties, {}).angular_velocity.y), 2, 1e-6);
}

TEST(MakeBody, FixedPlaneHasNoExtent) {
    BodyDefinition definition;
    definition.id = 1;
    definition.mode = BodyMode::fixed;
    definition.shape.type = ShapeType::plane;
    const Made made = make(definition);
    ASSERT_EQ(made.error, "");
    EXPECT_EQ(made.properties.bounding_radius, 0);
    EXPECT_EQ(made.properties.gyration_radius, 0);
    EXPECT_EQ(made.properties.inverse_gyration_radius, 0);
}

TEST(ReadBody, GivesBackWhatWasMade) {
    BodyDefinition definition = crate();
    definition.orientation = {0.5, 0.5, -0.5, 0.5};
    definition.angular_velocity = {1.25, -7, 0.5};
    const Made made = make(definition);
    const BodyReading reading = read_body(made.motion, made.properties, {});
    EXPECT_EQ(reading.mode, definition.mode);
    EXPECT_EQ(reading.shape.type, ShapeType::box);
    EXPECT_EQ(reading.shape.half_extents, definition.shape.half_extents);
    EXPECT_EQ(reading.position, definition.position);
    EXPECT_EQ(reading.orientation, definition.orientation);
    EXPECT_EQ(reading.linear_velocity, definition.linear_velocity);
    EXPECT_NEAR(value(reading.angular_velocity.x), 1.25, 3e-6);
    EXPECT_NEAR(value(reading.angular_velocity.y), -7, 3e-6);
    EXPECT_NEAR(value(reading.angular_velocity.z), 0.5, 3e-6);
    EXPECT_NEAR(value(reading.mass), 1000, 1e-5);
}

TEST(ReadBody, RemakingFromAReadingGivesTheSameProperties) {
    const ShapeType types[] = {ShapeType::sphere, ShapeType::capsule, ShapeType::box};
    for (const ShapeType type : types) {
        for (const Real size : {kShapeSizeMin, Real(0.3), Real(1), Real(25)}) {
            BodyDefinition definition = crate();
            definition.shape.type = type;
            definition.shape.radius = size;
            definition.shape.half_height = size;
            definition.shape.half_extents = {size, size, size};
            definition.mass = 2;
            const Made made = make(definition);
            ASSERT_EQ(made.error, "");
            BodyDefinition again = definition;
            again.shape = read_body(made.motion, made.properties, {}).shape;
            const Made remade = make(again);
            ASSERT_EQ(remade.error, "");
            EXPECT_EQ(std::memcmp(&made.properties, &remade.properties, sizeof(BodyProperties)), 0);
        }
    }
}

TEST(ShapeOf, CarriesTypeSizeAndRotation) {
    const Made made = make(crate());
    const std::int32_t rotation[9] = {};
    const ShapeInstance shape = shape_of(made.properties, {}, rotation);
    EXPECT_EQ(shape.type, ShapeType::box);
    EXPECT_EQ(shape.size[2], 1 << 22);
    EXPECT_EQ(shape.rotation, rotation);
}

struct Refusal {
    const char* name;
    std::function<void(BodyDefinition&)> spoil;
    const char* field;
};

std::string refusal_name(const testing::TestParamInfo<Refusal>& info) {
    return info.param.name;
}

class MakeBodyRefuses : public testing::TestWithParam<Refusal> {};

TEST_P(MakeBodyRefuses, NamingBodyAndFieldAndLeavingTheRows) {
    BodyDefinition definition = crate();
    GetParam().spoil(definition);
    BodyMotion motion{};
    motion.id = 99;
    BodyProperties properties{};
    properties.friction = 99;
    const Status status = make_body(definition, {}, {}, motion, properties);
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().message.find("body " + std::to_string(definition.id) + ":"),
              std::string::npos)
        << status.error().message;
    EXPECT_NE(status.error().message.find(GetParam().field), std::string::npos)
        << status.error().message;
    EXPECT_EQ(motion.id, 99U);
    EXPECT_EQ(properties.friction, 99);
}

INSTANTIATE_TEST_SUITE_P(
    Fields,
    MakeBodyRefuses,
    testing::Values(
        Refusal{"IdZero", [](BodyDefinition& d) { d.id = 0; }, "id"},
        Refusal{"IdTooLarge", [](BodyDefinition& d) { d.id = 0x100000000U; }, "id"},
        Refusal{
            "UnknownMode", [](BodyDefinition& d) { d.mode = static_cast<BodyMode>(3); }, "mode"},
        Refusal{"UnknownShape",
                [](BodyDefinition& d) { d.shape.type = static_cast<ShapeType>(8); },
                "shape.type"},
        Refusal{"MovingPlane",
                [](BodyDefinition& d) { d.shape.type = ShapeType::plane; },
                "shape.type"},
        Refusal{"BoxTooThin",
                [](BodyDefinition& d) { d.shape.half_extents.y = 0.0099; },
                "shape.half_extents.y"},
        Refusal{"BoxTooLong",
                [](BodyDefinition& d) { d.shape.half_extents.x = 250.1; },
                "shape.half_extents.x"},
        Refusal{"BoxNegative",
                [](BodyDefinition& d) { d.shape.half_extents.z = -1; },
                "shape.half_extents.z"},
        Refusal{"SphereTooLarge",
                [](BodyDefinition& d) {
                    d.shape.type = ShapeType::sphere;
                    d.shape.radius = Real::highest();
                },
                "shape.radius"},
        Refusal{"CapsuleTooShort",
                [](BodyDefinition& d) {
                    d.shape.type = ShapeType::capsule;
                    d.shape.half_height = 0;
                },
                "shape.half_height"},
        Refusal{"TooLargeToMove",
                [](BodyDefinition& d) {
                    d.shape.half_extents = {60, 60, 60};
                    d.density = 1;
                },
                "bounding radius"},
        Refusal{"FixedCapsuleTooLarge",
                [](BodyDefinition& d) {
                    d.mode = BodyMode::fixed;
                    d.linear_velocity = {};
                    d.angular_velocity = {};
                    d.shape.type = ShapeType::capsule;
                    d.shape.radius = 250;
                    d.shape.half_height = 250;
                },
                "bounding radius"},
        Refusal{"TooSlender",
                [](BodyDefinition& d) {
                    d.shape.half_extents = {1, 0.02, 0.02};
                },
                "slender"},
        Refusal{"PlankTooSlender",
                [](BodyDefinition& d) {
                    d.shape.half_extents = {1.7, 0.05, 0.01};
                },
                "slender"},
        Refusal{"CapsuleTooSlender",
                [](BodyDefinition& d) {
                    d.shape.type = ShapeType::capsule;
                    d.shape.radius = 0.02;
                    d.shape.half_height = 1;
                },
                "slender"},
        Refusal{"PositionTooFar", [](BodyDefinition& d) { d.position.y = -30001; }, "position.y"},
        Refusal{"PositionAtTheEndOfTheFormat",
                [](BodyDefinition& d) { d.position.z = Real::lowest(); },
                "position.z"},
        Refusal{"NoOrientation",
                [](BodyDefinition& d) {
                    d.orientation = {0, 0, 0, 0};
                },
                "orientation"},
        Refusal{"TooFast",
                [](BodyDefinition& d) {
                    d.linear_velocity = {300, 300, 0};
                },
                "linear_velocity"},
        Refusal{"TooFastOnAnAxis",
                [](BodyDefinition& d) { d.linear_velocity.x = Real::highest(); },
                "linear_velocity.x"},
        Refusal{"SpinsTooFast",
                [](BodyDefinition& d) {
                    d.angular_velocity = {0, 101, 0};
                },
                "angular_velocity"},
        Refusal{"SpinsTooFastForItsSize",
                [](BodyDefinition& d) {
                    d.shape.half_extents = {40, 40, 40};
                    d.density = 1;
                    d.angular_velocity = {0, 90, 0};
                },
                "angular_velocity"},
        Refusal{"FixedButMoving",
                [](BodyDefinition& d) {
                    d.mode = BodyMode::fixed;
                    d.angular_velocity = {};
                },
                "linear_velocity"},
        Refusal{"FixedButTurning",
                [](BodyDefinition& d) {
                    d.mode = BodyMode::fixed;
                    d.linear_velocity = {};
                },
                "angular_velocity"},
        Refusal{"NegativeMass", [](BodyDefinition& d) { d.mass = -1; }, "mass"},
        Refusal{"TooHeavy", [](BodyDefinition& d) { d.mass = 1000000001; }, "mass"},
        Refusal{"TooLight", [](BodyDefinition& d) { d.mass = Real::ulp(); }, "mass"},
        Refusal{"NoDensity", [](BodyDefinition& d) { d.density = 0; }, "density"},
        Refusal{"NegativeDensity", [](BodyDefinition& d) { d.density = -5; }, "density"},
        Refusal{"DensityBeyondRange",
                [](BodyDefinition& d) { d.density = Real::highest(); },
                "density"},
        Refusal{"NegativeFriction", [](BodyDefinition& d) { d.friction = -0.1; }, "friction"},
        Refusal{"FrictionBeyondRange", [](BodyDefinition& d) { d.friction = 4.1; }, "friction"},
        Refusal{
            "NegativeRestitution", [](BodyDefinition& d) { d.restitution = -0.1; }, "restitution"},
        Refusal{"RestitutionBeyondRange",
                [](BodyDefinition& d) { d.restitution = 1.1; },
                "restitution"}),
    refusal_name);

TEST(MakeBodyRefusal, SaysValueAndRange) {
    BodyDefinition definition = crate();
    definition.shape.half_extents.y = 0.0075;
    EXPECT_EQ(make(definition).error,
              "body 7: shape.half_extents.y is 0.0075; it must be within 0.01 .. 250.0 m");
}

TEST(MakeBodyRefusal, SpeedLimitIsTheWorlds) {
    WorldSettings settings;
    settings.linear_speed_max = 4.9;
    EXPECT_NE(make(crate(), settings).error.find("linear_velocity"), std::string::npos);
    settings.linear_speed_max = 5;
    EXPECT_EQ(make(crate(), settings).error, "");
}

TEST(MakeBodyRefusal, TenToOneIsStillAccepted) {
    BodyDefinition definition = crate();
    for (const Real half : {Real(0.02), Real(0.1), Real(1)}) {
        definition.shape.type = ShapeType::box;
        definition.shape.half_extents = {half * 10, half, half};
        EXPECT_EQ(make(definition).error, "");
        definition.shape.half_extents = {half * 10, half, half * 10}; // plates are no problem
        EXPECT_EQ(make(definition).error, "");
        definition.shape.type = ShapeType::capsule;
        definition.shape.radius = half;
        definition.shape.half_height = half * 9;
        EXPECT_EQ(make(definition).error, "");
    }
}

TEST(MakeBodyRefusal, WhatIsAcceptedKeepsTheSolversCoefficientsInRange) {
    // Arms of normal and friction rows over shapes of all proportions: below 8, as Q3.28 demands.
    int accepted = 0;
    int slender = 0;
    for (int x = 1; x <= 60; ++x) {
        for (int z = 1; z <= 60; ++z) {
            BodyDefinition definition = crate();
            definition.shape.half_extents = {Real(0.02) * x, 0.02, Real(0.02) * z};
            const Made made = make(definition);
            if (!made.error.empty()) {
                continue;
            }
            ++accepted;
            const double rho = fixed_value(made.properties.gyration_radius, 22);
            const double radius = fixed_value(made.properties.bounding_radius, 22);
            double off = 0.01; // what may lie off the surface
            for (int axis = 0; axis < 3; ++axis) {
                if (fixed_value(made.properties.inverse_inertia[axis], 26) >= 8) {
                    off = 0; // the contacts take care of it
                    ++slender;
                }
            }
            EXPECT_LT((radius * (off > 0 ? 1.118 : 1.05) + off) / rho, 8.1);
            for (int axis = 0; axis < 3; ++axis) {
                const double ratio = fixed_value(made.properties.inverse_inertia[axis], 26);
                EXPECT_LT(ratio, 32);
                const double j = fixed_value(made.properties.size[(axis + 1) % 3], 22);
                const double k = fixed_value(made.properties.size[(axis + 2) % 3], 22);
                EXPECT_LT(ratio * (1.05 * std::hypot(j, k)) / rho, 8);
                // m rho^2 / I, of which I is the true one or, of the slenderest, less than twice.
                const double part = ratio * (j * j + k * k) / 3 / (rho * rho);
                EXPECT_LT(part, 1.0001);
                EXPECT_GT(part, std::max(x, z) <= 24 && std::min(x, z) == 1 ? 0.9999 : 0.5);
            }
        }
    }
    EXPECT_GT(slender, 100);
    EXPECT_GT(accepted, 500);
    EXPECT_LT(accepted, 3600);
}

} // namespace
} // namespace lockwind
