#include "step_times.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace lockwind::bench {

double StepTimes::mean_seconds() const {
    LOCKWIND_ASSERT(!seconds_.empty());
    const double sum = std::accumulate(seconds_.begin(), seconds_.end(), 0.0);
    return sum / static_cast<double>(seconds_.size());
}

double StepTimes::percentile_us(std::uint32_t percent) const {
    LOCKWIND_ASSERT(!seconds_.empty() && percent >= 1 && percent <= 100);
    std::vector<double> sorted = seconds_;
    const std::size_t rank = (sorted.size() * percent + 99) / 100; // from 1, rounded up
    const auto wanted = sorted.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(sorted.begin(), wanted, sorted.end());
    return 1e6 * *wanted;
}

} // namespace lockwind::bench
