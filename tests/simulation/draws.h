#pragma once

#include "tests/simulation/measures.h"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace lockwind::test {

/// Draws of one scene.
class Draws {
public:
    explicit Draws(std::uint64_t seed) : seed_(seed) {}
    double uniform(double low, double high) {
        return low + (high - low) * to_double(random_unit(seed_, 1, counter_++));
    }
    /// Every magnitude alike.
    double scale(double low, double high) {
        return std::exp(uniform(std::log(low), std::log(high)));
    }
    Vector direction() {
        const double y = uniform(-1, 1);
        const double angle = uniform(0, 2 * std::numbers::pi);
        const double across = std::sqrt(1 - y * y);
        return {across * std::cos(angle), y, across * std::sin(angle)};
    }
    bool chance(double part) { return uniform(0, 1) < part; }

private:
    std::uint64_t seed_;
    std::uint64_t counter_ = 0;
};

} // namespace lockwind::test
