#pragma once

#include "lockwind/vector.h"

namespace lockwind {

/// The unit quaternion along `quat`, identity for zero. |components| < 2^29.
RealQuat normalised(const RealQuat& quat);

/// Right-handed turn about `axis`, which need not be of unit length but must not be 0.
RealQuat rotation_about(const Vec3& axis, Real degrees);

/// The point of a circle about y, at `degrees` from +z towards +x.
Vec3 on_circle(Real degrees, Real radius);

} // namespace lockwind
