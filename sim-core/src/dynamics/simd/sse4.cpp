#include "dynamics/simd/wide_kernels.h"
#include "dynamics/simd/wide_lanes.h"

// Compiled for x86-64-v2.
static_assert(HWY_TARGET == HWY_SSE4);

namespace lockwind {

ContactKernels sse4_kernels() {
    return kernels_of<HWY_NAMESPACE::WideLanes>();
}

} // namespace lockwind
