#include "dynamics/simd/wide_kernels.h"
#include "dynamics/simd/wide_lanes.h"

// Compiled for x86-64-v4.
static_assert(HWY_TARGET == HWY_AVX3);

namespace lockwind {

ContactKernels avx512_kernels() {
    return kernels_of<HWY_NAMESPACE::WideLanes>();
}

} // namespace lockwind
