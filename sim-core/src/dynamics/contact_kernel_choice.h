#pragma once

#include "dynamics/contact_kernels.h"

#include "lockwind/simd.h"

namespace lockwind {

/// The kernels of an instruction set that this program has and this processor runs; see
/// is_available().
ContactKernels contact_kernels(Simd simd);

} // namespace lockwind
