#include "dynamics/contact_kernel_choice.h"

#include "dynamics/simd/wide_kernels.h"

#include "lockwind/assert.h"

// LOCKWIND_SIMD_X86 and LOCKWIND_SIMD_NEON come from the build: which files of kernels it has.

namespace lockwind {

bool is_available(Simd simd) {
    switch (simd) {
    case Simd::scalar:
        return true;
#if LOCKWIND_SIMD_X86
    case Simd::sse4:
        return __builtin_cpu_supports("sse4.2");
    case Simd::avx2:
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") &&
               __builtin_cpu_supports("fma");
    case Simd::avx512:
        return is_available(Simd::avx2) && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#endif
#if LOCKWIND_SIMD_NEON
    case Simd::neon:
        return true;
#endif
    default:
        return false;
    }
}

Simd best_simd() {
    for (int simd = kSimdCount - 1; simd > 0; --simd) {
        if (is_available(static_cast<Simd>(simd))) {
            return static_cast<Simd>(simd);
        }
    }
    return Simd::scalar;
}

const char* to_string(Simd simd) {
    constexpr const char* kNames[kSimdCount] = {"scalar", "sse4", "avx2", "avx512", "neon"};
    return kNames[static_cast<int>(simd)];
}

ContactKernels contact_kernels(Simd simd) {
    LOCKWIND_ASSERT(is_available(simd));
    switch (simd) {
#if LOCKWIND_SIMD_X86
    case Simd::sse4:
        return sse4_kernels();
    case Simd::avx2:
        return avx2_kernels();
    case Simd::avx512:
        return avx512_kernels();
#endif
#if LOCKWIND_SIMD_NEON
    case Simd::neon:
        return neon_kernels();
#endif
    default:
        return kernels_of<ScalarLanes>();
    }
}

} // namespace lockwind
