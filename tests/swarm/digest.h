#pragma once

#include "lockwind/rng.h"

#include <cstdint>
#include <string_view>

namespace lockwind::swarm {

/// Of all that happened, in order: two runs with the same digest were the same run.
class Digest {
public:
    void add(std::uint64_t value) { value_ = split_mix((value_ ^ value) + kSplitMixGamma); }
    void add(std::string_view text) {
        add(text.size());
        for (const char letter : text) {
            add(static_cast<std::uint64_t>(static_cast<unsigned char>(letter)));
        }
    }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0;
};

} // namespace lockwind::swarm
