#pragma once

#include "lockwind/vector.h"

#include <optional>

namespace lockwind {

/// The Real nearest to an IEEE double, halves up as in Real's literals, by integer arithmetic on
/// its bits: no rounding mode or compiler flag takes part. Nothing for infinities, NaN and |value|
/// >= 2^31.
std::optional<Real> to_real(double value);

} // namespace lockwind
