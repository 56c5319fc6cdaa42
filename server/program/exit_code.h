#pragma once

namespace lockwind {

// Exit codes of all programs.
inline constexpr int kExitDone = 0;     // done and in agreement
inline constexpr int kExitDiverged = 1; // a divergence or a failed verification
inline constexpr int kExitUsage = 2;    // wrong usage or input
inline constexpr int kExitFile = 3;     // a file is missing, unreadable, torn or damaged
inline constexpr int kExitNetwork = 4;  // the network or a peer failed

} // namespace lockwind
