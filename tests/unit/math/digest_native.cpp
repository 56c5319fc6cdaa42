#include "tests/unit/math/arithmetic_digest.h"
#include "tests/unit/math/arithmetic_digest_body.h"

std::uint64_t native_digest() {
    return arithmetic_digest();
}
