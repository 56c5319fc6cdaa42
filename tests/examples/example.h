#pragma once

#include "lockwind/world.h"

#include <cstdio>
#include <cstdlib>

namespace example {

/// For printing alone: what is computed from here must not go back into the world.
inline double to_double(lockwind::Real value) {
    return static_cast<double>(value.raw()) / 4294967296.0;
}

/// The value, or the end of the program with what was wrong.
template <class T>
T require(lockwind::Result<T> result) {
    if (!result.ok()) {
        std::fprintf(stderr, "%s\n", result.error().message.c_str());
        std::exit(1);
    }
    return std::move(result).value();
}

inline void require(bool condition, const char* what) {
    if (!condition) {
        std::fprintf(stderr, "not so: %s\n", what);
        std::exit(1);
    }
}

} // namespace example
