#pragma once

#include <cstdint>

namespace lockwind {

/// Lets `burst` through at once and `per_s` a second on average; starts full.
class TokenBucket {
public:
    TokenBucket(std::uint32_t per_s, std::uint32_t burst)
        : per_s_(per_s), full_(burst * kUsPerS), tokens_(full_) {}

    /// False where there is none left.
    bool take(std::uint64_t now_us);

private:
    static constexpr std::uint64_t kUsPerS = 1'000'000;

    std::uint64_t per_s_;
    std::uint64_t full_;
    std::uint64_t tokens_; // in units of 1 / kUsPerS
    std::uint64_t filled_us_ = 0;
};

struct ConductSettings {
    std::uint32_t messages_per_s = 2500;
    std::uint32_t messages_burst = 5000;
    std::uint32_t offences_per_s = 1;
    std::uint32_t offences_burst = 64;
};

/// How the holder of a slot keeps to the protocol: he may send so many messages, and offend
/// (violation.h) so often, before he loses the slot.
struct Conduct {
    explicit Conduct(const ConductSettings& settings)
        : messages(settings.messages_per_s, settings.messages_burst),
          offences(settings.offences_per_s, settings.offences_burst) {}

    TokenBucket messages;
    TokenBucket offences;
};

} // namespace lockwind
