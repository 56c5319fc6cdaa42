#include "dynamics/simd/wide_kernels.h"
#include "dynamics/simd/wide_lanes.h"

static_assert(HWY_TARGET == HWY_NEON);

namespace lockwind {

ContactKernels neon_kernels() {
    return kernels_of<HWY_NAMESPACE::WideLanes>();
}

} // namespace lockwind
