#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lockwind {

/// May another file be at the path of an output?
enum class Existing : unsigned char {
    refused = 0,  // what was recorded is never overwritten
    replaced = 1, // a report that is made again and again
};

/// Whether `path` can be written, asked before any work is done: nothing where it can, or the exit
/// code of the error that was said. `flag` is what the user called it, as in "--trace". An empty
/// path is no output, and fine.
std::optional<int>
output_path_trouble(std::string_view flag, const std::string& path, Existing existing);

} // namespace lockwind
