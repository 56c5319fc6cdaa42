#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace lockwind {

/// The command line of `lockwind bots`.
struct BotsOptions {
    std::uint32_t count = 1;
    std::string server = "127.0.0.1";
    std::uint32_t domain = 1;
    std::string match = "match";
    std::uint32_t connect_timeout_s = 30;
    std::string behaviour = "fight";   // or log:FILE
    std::optional<std::uint64_t> seed; // none: drawn
    std::optional<std::string> net;    // link conditions
    std::optional<std::string> corrupt;
    std::string corrupt_phase;
    bool json = false;
};

/// Plays until all bots' sessions have ended; prints the report; returns the exit code.
int run_bots(const BotsOptions& options);

} // namespace lockwind
