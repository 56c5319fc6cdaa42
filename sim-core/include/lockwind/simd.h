#pragma once

#include <cstdint>

namespace lockwind {

/// Instruction sets that the solver has kernels for. They all give the same bits: the choice is one
/// of speed, no part of a world's definition or state.
enum class Simd : std::uint8_t {
    scalar = 0,
    sse4 = 1,   // x86-64-v2
    avx2 = 2,   // x86-64-v3
    avx512 = 3, // x86-64-v4
    neon = 4,   // every aarch64
};
inline constexpr int kSimdCount = 5;

/// Whether this program has kernels for it and this processor runs them. A checked build has scalar
/// ones alone: vector units do not trap an overflow.
bool is_available(Simd simd);
/// The fastest one that is available.
Simd best_simd();

const char* to_string(Simd simd);

} // namespace lockwind
