#include "tests/unit/math/accuracy.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

#if defined(LOCKWIND_HAS_QUADMATH)

TEST(Accuracy, KeepsTheBoundsOfTheReadme) {
    for (const Accuracy& row : measure_accuracy(20000)) {
        EXPECT_LE(row.ulp, row.ulp_bound) << row.operation;
        // A measure that finds nothing measures nothing.
        EXPECT_GT(row.ulp, 0.49) << row.operation;
    }
}

#endif

} // namespace
} // namespace lockwind
