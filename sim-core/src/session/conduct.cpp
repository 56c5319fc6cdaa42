#include "session/conduct.h"

#include <algorithm>

namespace lockwind {

bool Conduct::admit(std::uint64_t now_us) {
    const std::uint64_t full = std::uint64_t{settings_.messages_burst} * kUsPerS;
    // Longer silences fill it too; the bound keeps the product in its type.
    const std::uint64_t elapsed_us = std::min(now_us - admitted_us_, std::uint64_t{3600} * kUsPerS);
    allowance_ = std::min(full, allowance_ + elapsed_us * settings_.messages_per_s);
    admitted_us_ = now_us;
    if (allowance_ < kUsPerS) {
        return false;
    }
    allowance_ -= kUsPerS;
    return true;
}

} // namespace lockwind
