#include "tests/unit/math/accuracy.h"

#include <cstdio>

/// Prints the accuracy table of sim-core/README.md.
int main() {
    std::puts("| operation | operands | rounding | largest error, ulp | promised |");
    std::puts("|---|---|---|---|---|");
    for (const lockwind::Accuracy& row : lockwind::measure_accuracy(1000000)) {
        std::printf("| %s | %s | %s | %.4f | %.3f |\n",
                    row.operation,
                    row.operands,
                    row.rounding,
                    row.ulp,
                    row.ulp_bound);
    }
    return 0;
}
