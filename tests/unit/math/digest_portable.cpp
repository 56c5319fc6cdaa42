// Two limbs, Knuth's division and the integer square root, on a machine that would not need them.
#define LOCKWIND_NO_INT128 1

#include "tests/unit/math/arithmetic_digest.h"
#include "tests/unit/math/arithmetic_digest_body.h"

// Its functions again, in this file's arithmetic.
#include "math/trig.cpp" // NOLINT(bugprone-suspicious-include): see above

std::uint64_t portable_digest() {
    return arithmetic_digest();
}
