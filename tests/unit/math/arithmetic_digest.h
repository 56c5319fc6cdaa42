#pragma once

#include <cstdint>

/// FNV-1a over the results of every operation on seeded operands, in the arithmetic that the
/// including file compiles. The generator is local and exact, so that the value holds on every
/// machine.
std::uint64_t native_digest();
std::uint64_t portable_digest();
