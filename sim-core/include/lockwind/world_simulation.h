#pragma once

#include "lockwind/simulation.h"
#include "lockwind/world.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lockwind {

/// A World as a Simulation: what sessions, logs and forensics run.
class WorldSimulation final : public Simulation {
public:
    static Result<std::unique_ptr<WorldSimulation>> create(const WorldDefinition& definition,
                                                           Simd simd = best_simd());
    ~WorldSimulation() override;

    World& world();
    const World& world() const;

    std::uint32_t slot_count() const override;
    std::uint32_t input_size_bytes() const override;
    Tick tick() const override;
    Status advance(std::span<const SlotInput> inputs) override;
    std::uint64_t state_hash() const override;
    HashTree hash_tree() const override;
    void save(std::vector<std::byte>& out) const override;
    Status load(std::span<const std::byte> bytes) override;
    void keep(KeptState& kept) const override;
    void restore(const KeptState& kept) override;
    StateSchema schema() const override;
    std::span<const std::string_view> phases() const override;
    void observe(PhaseObserver* observer) override;

    /// "section.field", ".x" or "[1]" behind it for a component; "" is "body.linear_velocity.x" of
    /// the first dynamic body. Adds one to the raw value, or takes one off where that would leave
    /// no state that can be stepped. False where there is no such field, no row, or neither is
    /// possible.
    bool corrupt(std::string_view field) override;
    /// As corrupt(), with an Error that says why not and lists the names there are.
    Status corrupt_field(std::string_view field);
    /// Whether corrupt_field and set_phase_fault know the name; an Error lists those there are.
    static Status check_field(std::string_view field);
    static Status check_phase(std::string_view phase);

    /// Test tool: corrupt("") after every run of the phase in all later advances, re-simulated ones
    /// too; "" ends it. An observer sees the corrupted state. An Error lists the phases there are.
    Status set_phase_fault(std::string_view phase);

private:
    struct Impl;
    explicit WorldSimulation(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Hash of the core's sources and its state schema: equal on all ends of a match. 16 hex digits.
std::string_view sim_version();

/// Compiler, flags, architecture and commit of this build; differs freely between ends.
std::string_view build_info();

} // namespace lockwind
