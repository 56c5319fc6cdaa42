#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace lockwind {

/// Why two parties came to different hashes of a tick. In order of precedence, see README.md.
enum class Verdict : std::uint8_t {
    inputs_differ = 0,   // they stepped different inputs
    settings_differ = 1, // they started from different scenes, settings or states
    false_hash = 2,      // the reported hash is of no state that the client can show
    build_differs = 3,   // re-simulation diverges, and the builds differ
    nondeterminism = 4,  // re-simulation diverges between equal builds
    corrupted_state = 5, // re-simulation agrees: a state was changed outside the step
};

std::string_view to_text(Verdict verdict);
std::optional<Verdict> verdict_from_text(std::string_view text);

/// `phase` of a divergence that no re-simulation reproduces.
inline constexpr std::string_view kOutsideStep = "outside_step";

} // namespace lockwind
