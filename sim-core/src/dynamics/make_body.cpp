#include "dynamics/make_body.h"

#include "dynamics/definition_checker.h"
#include "dynamics/step_constants.h"
#include "geometry/bounds.h"
#include "geometry/fixed_geometry.h"
#include "geometry/mass.h"

#include "lockwind/integer.h"
#include "lockwind/wide.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <string>

namespace lockwind {

namespace {

using GyrationRadius = Length;                   // Q9.22
using InverseGyration = Fixed<std::int32_t, 24>; // Q7.24
using InverseInertia = Fixed<std::int32_t, 26>;  // Q5.26

constexpr Real kDensityMax = 1000000; // kg/m^3
/// The gyration radius is no smaller, so that its inverse fits Q7.24: 1/127 m, rounded up. It only
/// scales the stored angular velocity and inverse inertia, so that a smaller body is as exact.
constexpr std::int32_t kGyrationRadiusMin = 33027;
/// Largest arm / gyration radius, and arm x gyration radius / k, that a solver row may meet. Its
/// coefficients are below 8 (Q3.28).
constexpr std::int64_t kLeverageMax = 62; // in eighths: 7.75

void check_shape(const ShapeDefinition& shape,
                 BodyMode mode,
                 const ShapeLibrary& shapes,
                 DefinitionChecker& checker) {
    // Compared as it will be stored, so that a stored size is always a valid one.
    const auto size = [&](const char* field, Real value) {
        const auto stored = convert_saturated<Length>(value);
        if (stored < convert<Length>(kShapeSizeMin) || stored > convert<Length>(kShapeSizeMax)) {
            checker.range(field, value, kShapeSizeMin, kShapeSizeMax, " m");
        }
    };
    const auto check_index = [&](const char* field, const char* names) {
        const std::uint32_t count = shapes.count(shape.type);
        if (library_index(shape) >= count) {
            checker.fail(field,
                         "is " + std::to_string(library_index(shape)) + "; there are " +
                             std::to_string(count) + " " + names);
        }
    };
    switch (shape.type) {
    case ShapeType::sphere:
        size("shape.radius", shape.radius);
        return;
    case ShapeType::capsule:
        size("shape.radius", shape.radius);
        size("shape.half_height", shape.half_height);
        return;
    case ShapeType::box:
        size("shape.half_extents.x", shape.half_extents.x);
        size("shape.half_extents.y", shape.half_extents.y);
        size("shape.half_extents.z", shape.half_extents.z);
        return;
    case ShapeType::plane:
        checker.require(
            mode == BodyMode::fixed, "shape.type", "is a plane; only a fixed body may be one");
        return;
    case ShapeType::hull:
        check_index("shape.hull", "hulls");
        return;
    case ShapeType::compound:
        check_index("shape.compound", "compounds");
        return;
    case ShapeType::height_field:
        check_index("shape.height_field", "height fields");
        checker.require(mode == BodyMode::fixed,
                        "shape.type",
                        "is a height field; only a fixed body may be one");
        return;
    case ShapeType::mesh:
        check_index("shape.mesh", "meshes");
        checker.require(
            mode == BodyMode::fixed, "shape.type", "is a mesh; only a fixed body may be one");
        return;
    }
    checker.fail("shape.type", "is unknown");
}

void check_motion(const BodyDefinition& definition,
                  const WorldSettings& settings,
                  DefinitionChecker& checker) {
    const RealQuat& q = definition.orientation;
    checker.vector_range("position", definition.position, kBodyPositionMax, " m");
    checker.require(
        q.x != 0 || q.y != 0 || q.z != 0 || q.w != 0, "orientation", "is 0; it must be a rotation");
    if (definition.mode == BodyMode::fixed) {
        checker.require(definition.linear_velocity == Vec3{},
                        "linear_velocity",
                        "is not 0; a fixed body does not move");
        checker.require(definition.angular_velocity == Vec3{},
                        "angular_velocity",
                        "is not 0; a fixed body does not turn");
        return;
    }
    checker.speed("linear_velocity",
                  definition.linear_velocity,
                  std::min(settings.linear_speed_max, kBodySpeedMax),
                  " m/s");
    checker.speed(
        "angular_velocity", definition.angular_velocity, settings.angular_speed_max, " rad/s");
}

void check_definition(const BodyDefinition& definition,
                      const WorldSettings& settings,
                      const ShapeLibrary& shapes,
                      DefinitionChecker& checker) {
    constexpr BodyId kSceneIdMax = 0xffffffffU;
    checker.require(definition.id >= 1 && definition.id <= kSceneIdMax,
                    "id",
                    "is out of range; it must be within 1 .. 4294967295");
    checker.require(definition.mode == BodyMode::fixed || definition.mode == BodyMode::kinematic ||
                        definition.mode == BodyMode::dynamic,
                    "mode",
                    "is unknown");
    check_shape(definition.shape, definition.mode, shapes, checker);
    check_motion(definition, settings, checker);
    checker.require(
        definition.layer < kLayerCount, "layer", "is out of range; it must be within 0 .. 31");
    checker.require(
        definition.friction_rule <= CombineRule::maximum, "friction_rule", "is unknown");
    checker.require(
        definition.restitution_rule <= CombineRule::maximum, "restitution_rule", "is unknown");
    checker.require(
        definition.collision_mode <= CollisionMode::speculative, "collision_mode", "is unknown");
    checker.require(definition.substeps <= kSubstepsMax, "substeps", "is more than 16");
    checker.vector_range("surface_velocity", definition.surface_velocity, kSurfaceSpeedMax, " m/s");
    checker.range("density", definition.density, 0, kDensityMax, " kg/m^3");
    checker.range("mass", definition.mass, 0, kBodyMassMax, " kg");
    checker.range("friction", definition.friction, 0, kFrictionMax, "");
    checker.range("restitution", definition.restitution, 0, kRestitutionMax, "");
}

using Build = std::optional<ShapeBuild>;

Build build_of(const ShapeDefinition& shape, const ShapeLibrary& shapes) {
    return shapes.build(shape.type, library_index(shape));
}

Build build_of(const BodyProperties& properties, const ShapeLibrary& shapes) {
    return shapes.build(static_cast<ShapeType>(properties.shape), properties.shape_index);
}

void fill_size(const ShapeDefinition& shape, const Build& build, BodyProperties& properties) {
    const auto set = [&](int index, Real value) {
        properties.size[index] = convert<Length>(value).raw();
    };
    switch (shape.type) {
    case ShapeType::sphere:
        set(0, shape.radius);
        break;
    case ShapeType::capsule:
        set(0, shape.radius);
        set(1, shape.half_height);
        break;
    case ShapeType::box:
        set(0, shape.half_extents.x);
        set(1, shape.half_extents.y);
        set(2, shape.half_extents.z);
        break;
    case ShapeType::plane:
        break;
    case ShapeType::hull:
    case ShapeType::compound:
    case ShapeType::height_field:
    case ShapeType::mesh:
        properties.shape_index = static_cast<std::uint16_t>(library_index(shape));
        properties.bounding_radius = build->bounding_radius;
        return;
    }
    properties.bounding_radius = bounding_radius(shape.type, properties.size);
}

/// The index back again.
void name_shape(const BodyProperties& properties, ShapeDefinition& shape) {
    switch (shape.type) {
    case ShapeType::hull:
        shape.hull = properties.shape_index;
        return;
    case ShapeType::compound:
        shape.compound = properties.shape_index;
        return;
    case ShapeType::height_field:
        shape.height_field = properties.shape_index;
        return;
    case ShapeType::mesh:
        shape.mesh = properties.shape_index;
        return;
    default:
        return;
    }
}

void set_gyration_radius(std::int64_t radius, BodyProperties& properties) {
    properties.gyration_radius =
        static_cast<std::int32_t>(std::max<std::int64_t>(radius, kGyrationRadiusMin));
    const Length length = Length::from_raw(properties.gyration_radius);
    // 1 / Q22 in Q24, to the nearest.
    constexpr std::int64_t kOne = std::int64_t{1}
                                  << (Length::kFraction + InverseGyration::kFraction);
    properties.inverse_gyration_radius =
        static_cast<std::int32_t>((kOne + length.raw() / 2) / length.raw());
}

/// Distance from the local axis to the farthest surface point.
std::int64_t arm_about(const ShapeDefinition& shape,
                       const Build& build,
                       const BodyProperties& properties,
                       int axis) {
    if (build) {
        return build->arm[axis];
    }
    const std::int32_t* size = properties.size;
    if (shape.type == ShapeType::box) {
        const std::int32_t across[3] = {
            axis == 0 ? 0 : size[0], axis == 1 ? 0 : size[1], axis == 2 ? 0 : size[2]};
        return bounding_radius(ShapeType::box, across);
    }
    return shape.type == ShapeType::capsule && axis == 1 ? size[0] : properties.bounding_radius;
}

/// Of a body with k = I / m, Q.44 m^2.
struct InertiaTerms {
    std::int64_t moment[3];
    std::int64_t arm[3]; // Q9.22 m: of the farthest surface point from each axis
};

/// rho^2 / k, Q5.26.
std::int64_t inverse_inertia_of(std::int64_t rho, std::int64_t k) {
    constexpr std::int64_t kTwice = std::int64_t{2} << InverseInertia::kFraction;
    return (multiply_divide(rho * rho, kTwice, k) + 1) >> 1;
}

/// With rho = (k_min k_max)^(1/4), which makes levers and responses about as large. False where a
/// contact's row may leave its format; nothing is set then but the gyration radius.
bool fill_balanced(const InertiaTerms& terms, BodyProperties& properties) {
    const auto [least, most] = std::minmax_element(terms.moment, terms.moment + 3);
    set_gyration_radius(
        static_cast<std::int64_t>(floor_sqrt(floor_sqrt128(
            multiply_wide(static_cast<std::uint64_t>(*least), static_cast<std::uint64_t>(*most))))),
        properties);
    const std::int64_t rho = properties.gyration_radius;
    // A contact point may lie off the surface by half its separation: half the margin, or for a
    // point that comes along, which weighs little in friction, a quarter of the longest half axis.
    constexpr std::int64_t kOff = kSpeculativeMargin >> 1;
    const std::int64_t radius = properties.bounding_radius;
    const auto is_bearable = [](std::int64_t arm, std::int64_t numerator, std::int64_t divisor) {
        return multiply_divide(8 * arm, numerator, divisor) < kLeverageMax;
    };
    bool bearable = is_bearable(radius + (radius >> 2) + kOff, 1, rho);
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t k = terms.moment[axis];
        const std::int64_t ratio = inverse_inertia_of(rho, k);
        bearable = bearable && is_bearable(terms.arm[axis] + radius / 24 + kOff, rho, k) &&
                   ratio < kVerySlender;
        properties.inverse_inertia[axis] = raw_saturate<std::int32_t>(ratio);
    }
    return bearable;
}

/// Of longer bodies: rho just long enough for the levers of their ends, and moments large enough
/// for the responses of their sides. A capsule or square bar of up to 24 times its thickness keeps
/// its true moments; about its long axis a longer or flat one is harder to turn, by less than
/// twice. False where that does not do. `hold_arm` of the contacts takes the points off the
/// surface.
bool fill_slender(const InertiaTerms& terms, BodyProperties& properties) {
    set_gyration_radius(std::max<std::int64_t>(properties.gyration_radius,
                                               std::int64_t{properties.bounding_radius} * 9 / 64),
                        properties);
    const std::int64_t rho = properties.gyration_radius;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t bearable = terms.arm[axis] * rho * 8 / 59; // a response of 7.375
        const std::int64_t k = std::max(terms.moment[axis], bearable);
        const std::int64_t ratio = inverse_inertia_of(rho, k);
        if (k > 2 * terms.moment[axis] || ratio > std::numeric_limits<std::int32_t>::max()) {
            return false;
        }
        properties.inverse_inertia[axis] = static_cast<std::int32_t>(ratio);
    }
    return true;
}

void fill_inertia(const ShapeDefinition& shape,
                  const Build& build,
                  BodyProperties& properties,
                  DefinitionChecker& checker) {
    const UnitInertia inertia = build ? build->inertia : unit_inertia(shape.type, properties.size);
    InertiaTerms terms{};
    for (int axis = 0; axis < 3; ++axis) {
        terms.moment[axis] = inertia.moment[axis].raw();
        terms.arm[axis] = arm_about(shape, build, properties, axis);
    }
    checker.require(fill_balanced(terms, properties) || fill_slender(terms, properties),
                    "shape",
                    "is too slender; it may be about 30 times as long as wide");
}

void fill_mass(const BodyDefinition& definition,
               const Build& build,
               BodyProperties& properties,
               DefinitionChecker& checker) {
    const bool by_density = definition.mass == 0;
    Real mass = definition.mass;
    if (by_density) {
        mass = build ? mass_of(build->volume, definition.density)
                     : mass_of(definition.shape.type, properties.size, definition.density);
    }
    if (mass < kBodyMassMin || mass > kBodyMassMax) {
        checker.fail(by_density ? "density" : "mass",
                     "gives " + text_of(mass) + " kg; a mass must be within " +
                         text_of(kBodyMassMin) + " .. " + text_of(kBodyMassMax) + " kg");
        return;
    }
    // floor(2^40 / m), m in Q32.
    const UInt128 one = UInt128{0, 1} << (InverseMass::kFraction + Real::kFraction);
    properties.inverse_mass =
        static_cast<std::int64_t>(divide_wide(one, static_cast<std::uint64_t>(mass.raw())).low);
}

void fill_build(const BodyDefinition& definition,
                const Build& build,
                BodyProperties& properties,
                DefinitionChecker& checker) {
    const auto radius = convert<Real>(Length::from_raw(properties.bounding_radius));
    const bool fixed = definition.mode == BodyMode::fixed;
    checker.range("shape's bounding radius",
                  radius,
                  0,
                  fixed ? kFixedRadiusMax : kMovingRadiusMax,
                  fixed ? " m for a fixed body" : " m for a body that moves");
    if (checker.failed() || fixed) {
        return;
    }
    if (definition.mode == BodyMode::kinematic) {
        // No inertia: the radius only scales the angular velocity, and keeps the solver's arms
        // short.
        set_gyration_radius(properties.bounding_radius, properties);
        return;
    }
    fill_inertia(definition.shape, build, properties, checker);
    fill_mass(definition, build, properties, checker);
}

void fill_orientation(const RealQuat& orientation, BodyMotion& motion) {
    const std::int64_t raw[4] = {
        orientation.x.raw(), orientation.y.raw(), orientation.z.raw(), orientation.w.raw()};
    std::uint64_t largest = 0;
    for (const std::int64_t component : raw) {
        largest = std::max(largest, raw_magnitude(component));
    }
    // Scaled to 62 bits, so that a short quaternion loses no digits; four squares fit 126 bits.
    const int shift = std::countl_zero(largest) - 2;
    std::int64_t scaled[4];
    UInt128 square{};
    for (int index = 0; index < 4; ++index) {
        scaled[index] = shift < 0 ? raw[index] >> -shift : raw[index] * (std::int64_t{1} << shift);
        const std::uint64_t size = raw_magnitude(scaled[index]);
        square = square + multiply_wide(size, size);
    }
    const auto length = static_cast<std::int64_t>(floor_sqrt128(square));
    constexpr std::int64_t kTwice = std::int64_t{2} << Unit::kFraction;
    for (int index = 0; index < 4; ++index) {
        motion.orientation[index] =
            static_cast<std::int32_t>((multiply_divide(scaled[index], kTwice, length) + 1) >> 1);
    }
}

/// Turns a shape's own axes into its definition's.
RealQuat own_turn(const ShapeBuild& build) {
    const auto unit = [&](int index) {
        return convert<Real>(Unit::from_raw(build.orientation[index]));
    };
    return {unit(0), unit(1), unit(2), unit(3)};
}

Vec3 own_centre(const ShapeBuild& build) {
    const auto length = [&](int index) {
        return convert<Real>(Length::from_raw(build.centre[index]));
    };
    return {length(0), length(1), length(2)};
}

void fill_place(const Vec3& given_position,
                const RealQuat& given_orientation,
                const Build& build,
                BodyMotion& motion) {
    RealQuat orientation = given_orientation;
    Vec3 position = given_position;
    if (build) {
        const RealQuat given = normalized(orientation);
        orientation = given * own_turn(*build);
        position += rotate(given, own_centre(*build));
    }
    motion.position[0] = position.x.raw();
    motion.position[1] = position.y.raw();
    motion.position[2] = position.z.raw();
    fill_orientation(orientation, motion);
}

void check_place(const BodyMotion& motion, DefinitionChecker& checker) {
    const Vec3 position{Real::from_raw(motion.position[0]),
                        Real::from_raw(motion.position[1]),
                        Real::from_raw(motion.position[2])};
    checker.vector_range("position of the centre of mass", position, kBodyPositionMax, " m");
}

void fill_velocities(const BodyDefinition& definition,
                     const BodyProperties& properties,
                     BodyMotion& motion,
                     DefinitionChecker& checker) {
    const Vec3& linear = definition.linear_velocity;
    motion.linear_velocity[0] = convert<Velocity>(linear.x).raw();
    motion.linear_velocity[1] = convert<Velocity>(linear.y).raw();
    motion.linear_velocity[2] = convert<Velocity>(linear.z).raw();
    const Vec3& angular = definition.angular_velocity;
    const auto radius = GyrationRadius::from_raw(properties.gyration_radius);
    const Real scaled[3] = {saturate_to<Real>(product(angular.x, radius)),
                            saturate_to<Real>(product(angular.y, radius)),
                            saturate_to<Real>(product(angular.z, radius))};
    for (int axis = 0; axis < 3; ++axis) {
        if (scaled[axis] > kBodySpeedMax || scaled[axis] < -kBodySpeedMax) {
            checker.fail("angular_velocity",
                         "times the gyration radius (" + text_of(convert<Real>(radius)) +
                             " m) is above " + text_of(kBodySpeedMax) + " m/s");
            return;
        }
        motion.angular_velocity[axis] = convert<Velocity>(scaled[axis]).raw();
    }
}

} // namespace

Status make_body(const BodyDefinition& definition,
                 const WorldSettings& settings,
                 const ShapeLibrary& shapes,
                 BodyMotion& motion,
                 BodyProperties& properties) {
    DefinitionChecker checker("body", definition.id);
    check_definition(definition, settings, shapes, checker);
    if (checker.failed()) {
        return checker.error();
    }
    const Build build = build_of(definition.shape, shapes);
    BodyMotion new_motion{};
    BodyProperties new_properties{};
    new_properties.mode = static_cast<std::uint8_t>(definition.mode);
    new_properties.shape = static_cast<std::uint8_t>(definition.shape.type);
    new_properties.can_sleep = definition.can_sleep ? 1 : 0;
    new_properties.sensor = definition.sensor ? 1 : 0;
    const Vec3 surface = build ? rotate(conjugate(own_turn(*build)), definition.surface_velocity)
                               : definition.surface_velocity;
    new_properties.surface_velocity[0] = convert<Velocity>(surface.x).raw();
    new_properties.surface_velocity[1] = convert<Velocity>(surface.y).raw();
    new_properties.surface_velocity[2] = convert<Velocity>(surface.z).raw();
    new_properties.layer = static_cast<std::uint8_t>(definition.layer);
    new_properties.mask = definition.mask & settings.layer_masks[definition.layer];
    new_properties.collision_mode = static_cast<std::uint8_t>(definition.collision_mode);
    new_properties.substeps = static_cast<std::uint8_t>(definition.substeps);
    new_properties.friction_rule = static_cast<std::uint8_t>(definition.friction_rule);
    new_properties.restitution_rule = static_cast<std::uint8_t>(definition.restitution_rule);
    new_properties.friction = convert<Coefficient>(definition.friction).raw();
    new_properties.restitution = convert<Coefficient>(definition.restitution).raw();
    fill_size(definition.shape, build, new_properties);
    fill_build(definition, build, new_properties, checker);

    new_motion.id = definition.id;
    fill_place(definition.position, definition.orientation, build, new_motion);
    check_place(new_motion, checker);
    fill_velocities(definition, new_properties, new_motion, checker);
    for (int axis = 0; axis < 3; ++axis) {
        new_motion.fat_bounds[axis] = 1;
    }
    if (checker.failed()) {
        return checker.error();
    }
    motion = new_motion;
    properties = new_properties;
    return Success{};
}

Status check_query_shape(const ShapeDefinition& shape, const ShapeLibrary& shapes) {
    DefinitionChecker checker("query");
    check_shape(shape, BodyMode::kinematic, shapes, checker);
    checker.require(
        shape.type != ShapeType::compound, "shape.type", "is a compound; give a convex shape");
    if (!checker.failed()) {
        BodyProperties properties{};
        fill_size(shape, build_of(shape, shapes), properties);
        checker.range("shape's bounding radius",
                      convert<Real>(Length::from_raw(properties.bounding_radius)),
                      0,
                      kMovingRadiusMax,
                      " m");
    }
    return checker.failed() ? Status(checker.error()) : Status(Success{});
}

void make_query_shape(const ShapeDefinition& shape,
                      const Vec3& position,
                      const RealQuat& orientation,
                      const ShapeLibrary& shapes,
                      BodyMotion& motion,
                      BodyProperties& properties) {
    const Build build = build_of(shape, shapes);
    motion = {};
    properties = {};
    properties.shape = static_cast<std::uint8_t>(shape.type);
    fill_size(shape, build, properties);
    fill_place(position, normalized(orientation), build, motion);
}

BodyReading
read_body(const BodyMotion& motion, const BodyProperties& properties, const ShapeLibrary& shapes) {
    BodyReading reading{};
    reading.mode = static_cast<BodyMode>(properties.mode);
    reading.shape.type = static_cast<ShapeType>(properties.shape);
    const auto size = [&](int index) {
        return convert<Real>(Length::from_raw(properties.size[index]));
    };
    if (reading.shape.type == ShapeType::box) {
        reading.shape.half_extents = {size(0), size(1), size(2)};
    } else if (const Build build = build_of(properties, shapes); build) {
        name_shape(properties, reading.shape);
    } else if (reading.shape.type != ShapeType::plane) {
        reading.shape.radius = size(0);
    }
    if (reading.shape.type == ShapeType::capsule) {
        reading.shape.half_height = size(1);
    }
    const auto unit = [&](int index) {
        return convert<Real>(Unit::from_raw(motion.orientation[index]));
    };
    reading.orientation = {unit(0), unit(1), unit(2), unit(3)};
    reading.position = {Real::from_raw(motion.position[0]),
                        Real::from_raw(motion.position[1]),
                        Real::from_raw(motion.position[2])};
    if (const Build build = build_of(properties, shapes); build) {
        reading.orientation =
            normalized(reading.orientation * turn_to_given_frame(properties, shapes));
        reading.position -= rotate(reading.orientation, own_centre(*build));
    }
    const auto linear = [&](int index) {
        return convert<Real>(Velocity::from_raw(motion.linear_velocity[index]));
    };
    reading.linear_velocity = {linear(0), linear(1), linear(2)};
    const auto radius = convert<Real>(GyrationRadius::from_raw(properties.gyration_radius));
    const auto angular = [&](int index) {
        return convert<Real>(Velocity::from_raw(motion.angular_velocity[index])) / radius;
    };
    if (radius > 0) {
        reading.angular_velocity = {angular(0), angular(1), angular(2)};
    }
    if (properties.inverse_mass > 0) {
        const UInt128 one = UInt128{0, 1} << (InverseMass::kFraction + Real::kFraction);
        const UInt128 mass = divide_wide(one, static_cast<std::uint64_t>(properties.inverse_mass));
        reading.mass = mass.high == 0 && (mass.low >> 63U) == 0
                           ? Real::from_raw(static_cast<std::int64_t>(mass.low))
                           : Real::highest();
    }
    return reading;
}

ShapeInstance shape_of(const BodyProperties& properties,
                       const ShapeLibrary& shapes,
                       const std::int32_t* rotation) {
    ShapeInstance shape{static_cast<ShapeType>(properties.shape),
                        {properties.size[0], properties.size[1], properties.size[2]},
                        rotation};
    shapes.set_shape(shape, properties.shape_index);
    return shape;
}

Vec3 to_principal_frame(const Vec3& point,
                        const BodyProperties& properties,
                        const ShapeLibrary& shapes) {
    const Build build = build_of(properties, shapes);
    return build ? rotate(conjugate(own_turn(*build)), point - own_centre(*build)) : point;
}

RealQuat turn_to_given_frame(const BodyProperties& properties, const ShapeLibrary& shapes) {
    const Build build = build_of(properties, shapes);
    return build ? conjugate(own_turn(*build)) : RealQuat{};
}

} // namespace lockwind
