#pragma once

#include <string>

namespace lockwind {

/// The command line of `lockwind diff`.
struct DiffCommandOptions {
    std::string a;     // a bundle, or with b: two logs, traces or snapshots
    std::string b;     // "" for none
    std::string junit; // file to write JUnit XML to; "" for none
    bool json = false;
};

/// Compares; prints the first divergence; returns the exit code.
int run_diff(const DiffCommandOptions& options);

} // namespace lockwind
