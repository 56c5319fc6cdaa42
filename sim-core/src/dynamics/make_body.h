#pragma once

#include "dynamics/body.h"
#include "geometry/shape_instance.h"
#include "geometry/shape_library.h"

#include "lockwind/result.h"
#include "lockwind/world_definition.h"

namespace lockwind {

// Limits that make_body keeps; the solver's formats rest on them.
inline constexpr Real kBodyPositionMax = 30000.0;  // m, each axis
inline constexpr Real kBodyMassMin = 0.000001;     // kg: 1/m stays below 2^20
inline constexpr Real kBodyMassMax = 1000000000.0; // kg: 1/m keeps three digits in Q24.40
inline constexpr Real kBodySpeedMax = 2000.0;      // m/s; also of angular speed x gyration radius
inline constexpr Real kSurfaceSpeedMax = 100.0;    // m/s, each axis
inline constexpr Real kFrictionMax = 4.0;
inline constexpr Real kRestitutionMax = 1.0;

/// Fills the rows of a new body. An Error names the body, the field and what would be right; the
/// rows are then untouched. fat_bounds come out empty (min > max), so that the broad phase inserts
/// it.
Status make_body(const BodyDefinition& definition,
                 const WorldSettings& settings,
                 const ShapeLibrary& shapes,
                 BodyMotion& motion,
                 BodyProperties& properties);

/// Whether a query may move a shape about: a convex one that a kinematic body may have. No
/// allocation but for the Error, which starts "query: ".
Status check_query_shape(const ShapeDefinition& shape, const ShapeLibrary& shapes);

/// Place, orientation, shape and size of a shape that check_query_shape takes, as those of a body;
/// all else is 0. An orientation of 0 is the identity. No allocation.
void make_query_shape(const ShapeDefinition& shape,
                      const Vec3& position,
                      const RealQuat& orientation,
                      const ShapeLibrary& shapes,
                      BodyMotion& motion,
                      BodyProperties& properties);

/// Rows read back at the API's scale, in the frame of the definition: of a hull, compound or
/// surface, the one that its points were given in.
struct BodyReading {
    BodyMode mode;
    ShapeDefinition shape;
    Vec3 position; // m
    RealQuat orientation;
    Vec3 linear_velocity;  // m/s
    Vec3 angular_velocity; // rad/s
    Real mass;             // kg; 0 unless dynamic
};
BodyReading
read_body(const BodyMotion& motion, const BodyProperties& properties, const ShapeLibrary& shapes);

/// The shape of a row, turned by `rotation` (identity for a sphere).
ShapeInstance shape_of(const BodyProperties& properties,
                       const ShapeLibrary& shapes,
                       const std::int32_t* rotation);

/// A point of the definition's frame, m, from the centre of mass along the principal axes.
Vec3 to_principal_frame(const Vec3& point,
                        const BodyProperties& properties,
                        const ShapeLibrary& shapes);

/// The turn from a body's principal axes to the frame of its definition: the identity but for
/// hulls and compounds.
RealQuat turn_to_given_frame(const BodyProperties& properties, const ShapeLibrary& shapes);

} // namespace lockwind
