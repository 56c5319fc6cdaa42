#pragma once

#include <string>

namespace lockwind {

/// The command line of `lockwind info`.
struct InfoCommandOptions {
    std::string file;        // any file that the tools wrote
    std::string export_file; // file to write its content to as plain protobuf; "" for none
    bool json = false;
};

/// Prints what the file holds; returns the exit code.
int run_info(const InfoCommandOptions& options);

} // namespace lockwind
