#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>

namespace lockwind {

/// Of options that name something: an empty value is a script's unset variable.
CLI::Validator not_empty();

/// A decimal number without sign, from `least` to `most`.
CLI::Validator whole_number(std::uint64_t least = 0,
                            std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

} // namespace lockwind
