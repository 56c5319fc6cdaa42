#include "forensics/verdict.h"

#include <array>

namespace lockwind {

namespace {

constexpr std::array<std::string_view, 6> kNames{"inputs_differ",
                                                 "settings_differ",
                                                 "false_hash",
                                                 "build_differs",
                                                 "nondeterminism",
                                                 "corrupted_state"};

} // namespace

std::string_view to_text(Verdict verdict) {
    return kNames[static_cast<std::size_t>(verdict)];
}

std::optional<Verdict> verdict_from_text(std::string_view text) {
    for (std::size_t index = 0; index < kNames.size(); ++index) {
        if (kNames[index] == text) {
            return static_cast<Verdict>(index);
        }
    }
    return std::nullopt;
}

} // namespace lockwind
