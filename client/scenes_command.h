#pragma once

#include <string>

namespace lockwind {

/// `lockwind scenes`.
struct ScenesOptions {
    std::string check; // name or file to check; "" lists the built-in scenes
    bool json = false;
};

/// Lists the built-in scenes, or says whether a match could run one. Returns the exit code: 0, 2
/// where the scene is wrong, 3 where it cannot be read.
int run_scenes(const ScenesOptions& options);

} // namespace lockwind
