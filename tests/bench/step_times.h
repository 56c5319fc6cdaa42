#pragma once

#include "thread_clock.h"

#include <cstdint>
#include <vector>

namespace lockwind::bench {

/// How long each step of a run took.
class StepTimes {
public:
    explicit StepTimes(std::uint32_t steps) { seconds_.reserve(steps); }

    template <class Step>
    void measure(Step&& step) {
        const double begin = thread_seconds();
        step();
        seconds_.push_back(thread_seconds() - begin);
    }

    double mean_seconds() const;
    /// Nearest rank: the least time that `percent` of the steps did not exceed.
    double percentile_us(std::uint32_t percent) const;

private:
    std::vector<double> seconds_;
};

} // namespace lockwind::bench
