#include "dynamics/pairing.h"

#include "dynamics/make_body.h"
#include "dynamics/solver_format.h"

#include "lockwind/integer.h"

#include <algorithm>

namespace lockwind {

std::int32_t combine(std::int32_t a, std::int32_t b, std::uint8_t rule_a, std::uint8_t rule_b) {
    const std::int64_t product = std::int64_t{a} * b;
    switch (static_cast<CombineRule>(std::max(rule_a, rule_b))) {
    case CombineRule::average:
        return static_cast<std::int32_t>((std::int64_t{a} + b) >> 1);
    case CombineRule::geometric_mean:
        return a == b ? a
                      : static_cast<std::int32_t>(floor_sqrt(static_cast<std::uint64_t>(product)));
    case CombineRule::minimum:
        return std::min(a, b);
    case CombineRule::multiply: {
        const std::int64_t largest = convert<Coefficient>(kFrictionMax).raw();
        return static_cast<std::int32_t>(
            std::min(round_shift(product, kCoefficientFraction), largest));
    }
    case CombineRule::maximum:
        break;
    }
    return std::max(a, b);
}

} // namespace lockwind
