#pragma once

#include <cstdint>

namespace lockwind {

/// Called during a step after each named phase; the state may be saved and hashed there.
class PhaseObserver {
public:
    virtual ~PhaseObserver() = default;
    virtual void after_phase(std::uint32_t phase) = 0;
};

} // namespace lockwind
