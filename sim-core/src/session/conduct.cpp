#include "session/conduct.h"

#include <algorithm>

namespace lockwind {

bool TokenBucket::take(std::uint64_t now_us) {
    // An hour fills any; the bound keeps the product in its type.
    const std::uint64_t elapsed_us = std::min(now_us - filled_us_, 3600 * kUsPerS);
    tokens_ = std::min(full_, tokens_ + elapsed_us * per_s_);
    filled_us_ = now_us;
    if (tokens_ < kUsPerS) {
        return false;
    }
    tokens_ -= kUsPerS;
    return true;
}

} // namespace lockwind
