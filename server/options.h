#pragma once

#include "session/messages.h"

#include <cstdint>
#include <optional>
#include <string>

namespace lockwind {

/// The command line of lockwind-server.
struct ServerOptions {
    MatchConfig config; // scene_text not yet filled in
    std::string listen = "lo";
    std::uint32_t domain = 1;
    std::uint32_t join_timeout_s = 30;
    std::string log_path; // "": lockwind-<match>-<utc>.log
    bool json = false;
};

/// What parsing came to: options, or a reason to exit at once (help, version, an error), already
/// said.
struct ParsedOptions {
    std::optional<ServerOptions> options;
    int exit_code = 0;
};

ParsedOptions parse_options(int argc, const char* const* argv);

} // namespace lockwind
