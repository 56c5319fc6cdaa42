#pragma once

#include <vector>

namespace lockwind {

/// The largest error of an operation over seeded operands, against quadruple precision.
struct Accuracy {
    const char* operation;
    const char* operands;
    const char* rounding;
    double ulp; // measured, in units of the last place of the result: 2^-32, or 2^-30 for Unit
    double ulp_bound; // promised
};

std::vector<Accuracy> measure_accuracy(int samples);

} // namespace lockwind
