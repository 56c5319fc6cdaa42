#pragma once

namespace lockwind {

/// Exit codes of all programs.
enum ExitCode : int {
    kExitDone = 0,     // done and in agreement
    kExitDiverged = 1, // a divergence or a failed verification
    kExitUsage = 2,    // wrong usage or input
    kExitFile = 3,     // a file is missing, unreadable, torn or damaged
    kExitNetwork = 4,  // the network or a peer failed
};

} // namespace lockwind
