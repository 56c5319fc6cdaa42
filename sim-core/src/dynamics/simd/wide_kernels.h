#pragma once

#include "dynamics/contact_kernels.h"

namespace lockwind {

// Each in a file that is compiled for its instruction set; only those of this architecture exist.
ContactKernels sse4_kernels();
ContactKernels avx2_kernels();
ContactKernels avx512_kernels();
ContactKernels neon_kernels();

} // namespace lockwind
