#pragma once

#include "lockwind/slot_input.h"
#include "lockwind/world_simulation.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lockwind::bench {

/// A world with its inputs: every pod drives ahead, circles and shoots.
class MeasuredWorld {
public:
    /// Ends the program with a message where the world cannot be created.
    explicit MeasuredWorld(const WorldDefinition& definition, Simd simd = best_simd());

    void step();
    void run(std::uint32_t steps);
    WorldSimulation& simulation() { return *simulation_; }
    /// Why a step failed; "" if none did.
    const std::string& error() const { return error_; }

    std::uint32_t contact_count() const;
    std::uint32_t awake_count() const; // dynamic bodies
    double penetration_mm() const;     // deepest of all contact points
    std::string hash_text() const;     // 16 hex digits

private:
    std::unique_ptr<WorldSimulation> simulation_;
    std::vector<SlotInput> inputs_;
    std::string error_;
};

} // namespace lockwind::bench
