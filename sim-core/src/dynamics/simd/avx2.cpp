#include "dynamics/simd/wide_kernels.h"
#include "dynamics/simd/wide_lanes.h"

// Compiled for x86-64-v3.
static_assert(HWY_TARGET == HWY_AVX2);

namespace lockwind {

ContactKernels avx2_kernels() {
    return kernels_of<HWY_NAMESPACE::WideLanes>();
}

} // namespace lockwind
