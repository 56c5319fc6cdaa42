#pragma once

#include <cstdint>

namespace lockwind {

struct ConductSettings {
    std::uint32_t messages_per_s = 2500; // on average
    std::uint32_t messages_burst = 5000; // at once, after a silence
    std::uint32_t offences_max = 64;     // messages that broke a rule
};

/// How the holder of a slot keeps to the protocol. Links lose, double and delay messages, but never
/// make them break a rule, or come by the thousand: who does so again and again has no place.
class Conduct {
public:
    explicit Conduct(const ConductSettings& settings)
        : settings_(settings), allowance_(std::uint64_t{settings.messages_burst} * kUsPerS) {}

    /// A message arrived; false where it is one too many (a token bucket: messages_per_s into
    /// messages_burst).
    bool admit(std::uint64_t now_us);
    void offend() { ++offences_; }

    bool is_bearable() const { return offences_ <= settings_.offences_max; }
    std::uint64_t offences() const { return offences_; }

private:
    static constexpr std::uint64_t kUsPerS = 1'000'000;

    ConductSettings settings_;
    std::uint64_t allowance_; // messages * kUsPerS
    std::uint64_t admitted_us_ = 0;
    std::uint64_t offences_ = 0;
};

} // namespace lockwind
