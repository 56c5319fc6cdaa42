#include "lockwind/assert.h"

#include <cstdio>
#include <cstdlib>

namespace lockwind {

void assert_failed(const char* what, const char* file, int line) {
    // Digits by hand: printf would drag formatting of floating point into the core.
    char digits[12] = {};
    char* first = digits + sizeof(digits) - 1;
    do {
        --first;
        *first = static_cast<char>('0' + line % 10);
        line /= 10;
    } while (line > 0);
    std::fputs(file, stderr);
    std::fputs(":", stderr);
    std::fputs(first, stderr);
    std::fputs(": assertion failed: ", stderr);
    std::fputs(what, stderr);
    std::fputs("\n", stderr);
    std::abort();
}

} // namespace lockwind
