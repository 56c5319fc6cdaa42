#pragma once

#include "base/arena.h"
#include "base/canonical.h"
#include "base/field_access.h"
#include "base/state_hash.h"

#include "lockwind/simulation.h"

#include <array>
#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

namespace lockwind::test {

struct Counts {
    std::uint32_t arena, globals, body, body_properties, pair, manifold;
};
struct Globals {
    std::uint64_t tick;
    std::uint64_t seed;
};
struct FakeBody {
    std::uint64_t id;
    std::int64_t position[3];
    std::int32_t velocity[2];
    std::uint16_t group;
    std::uint8_t flags[2];
    std::uint32_t zero;
};
struct FakeProperties {
    std::int32_t friction;
};
struct FakePair {
    std::uint32_t row_a, row_b, manifold;
};
struct FakeManifold {
    std::int32_t impulse[2];
};

inline constexpr std::array kCountsFields{
    LOCKWIND_FIELD(Counts, arena, 0, "", ""),
    LOCKWIND_FIELD(Counts, globals, 0, "", ""),
    LOCKWIND_FIELD(Counts, body, 0, "", ""),
    LOCKWIND_FIELD(Counts, body_properties, 0, "", ""),
    LOCKWIND_FIELD(Counts, pair, 0, "", ""),
    LOCKWIND_FIELD(Counts, manifold, 0, "", ""),
};
inline constexpr std::array kGlobalsFields{
    LOCKWIND_FIELD(Globals, tick, 0, "tick", ""),
    LOCKWIND_FIELD(Globals, seed, 0, "", ""),
};
inline constexpr std::array kBodyFields{
    LOCKWIND_FIELD(FakeBody, id, 0, "", ""),
    LOCKWIND_FIELD(FakeBody, position, 32, "m", "xyz"),
    LOCKWIND_FIELD(FakeBody, velocity, 20, "m/s", "xy"),
    LOCKWIND_FIELD(FakeBody, group, 0, "", ""),
    LOCKWIND_FIELD(FakeBody, flags, 0, "", ""),
    LOCKWIND_FIELD(FakeBody, zero, 0, "", ""),
};
inline constexpr std::array kPropertiesFields{
    LOCKWIND_FIELD(FakeProperties, friction, 28, "", ""),
};
inline constexpr std::array kPairFields{
    LOCKWIND_FIELD(FakePair, row_a, 0, "", ""),
    LOCKWIND_FIELD(FakePair, row_b, 0, "", ""),
    LOCKWIND_FIELD(FakePair, manifold, 0, "", ""),
};
inline constexpr std::array kManifoldFields{
    LOCKWIND_FIELD(FakeManifold, impulse, 20, "m/s", ""),
};
inline constexpr std::array<SectionDescriptor, 6> kFakeSections{{
    {"arena", "test", sizeof(Counts), false, "", kCountsFields},
    {"globals", "test", sizeof(Globals), false, "", kGlobalsFields},
    {"body", "test", sizeof(FakeBody), false, "id", kBodyFields},
    {"body_properties", "test", sizeof(FakeProperties), false, "", kPropertiesFields},
    {"pair", "test", sizeof(FakePair), false, "", kPairFields},
    {"manifold", "test", sizeof(FakeManifold), false, "", kManifoldFields},
}};
inline constexpr std::array<std::string_view, 3> kFakePhases{"apply_inputs", "move", "next_tick"};
inline constexpr std::array<std::uint32_t, 6> kFakeCapacities{1, 1, 64, 64, 16, 16};

enum Section : std::uint32_t { globals = 1, body = 2, properties = 3, pair = 4, manifold = 5 };

/// Bodies with sparse ids that accelerate with the players' inputs, two pairs and two manifolds
/// whose rows are not in the pairs' order.
class FakeSimulation final : public Simulation {
public:
    static constexpr std::uint32_t kInputSizeBytes = 2;
    static constexpr std::uint32_t kBodies = 40;

    explicit FakeSimulation(std::uint32_t slots = 2, std::uint64_t seed = 1)
        : arena_(kFakeSections, kFakeCapacities), slots_(slots) {
        for (const auto& [section, count] : {std::pair<std::uint32_t, std::uint32_t>{globals, 1},
                                             {body, kBodies},
                                             {properties, kBodies},
                                             {pair, 2},
                                             {manifold, 2}}) {
            arena_.set_row_count(section, count);
        }
        row<Globals>(globals, 0).seed = seed;
        for (std::uint32_t index = 0; index < kBodies; ++index) {
            FakeBody& made = row<FakeBody>(body, index);
            made.id = 10 + 3 * index;
            made.position[0] = std::int64_t{index} << 32U;
            made.position[1] = -static_cast<std::int64_t>(seed);
            made.group = static_cast<std::uint16_t>(index);
            row<FakeProperties>(properties, index).friction = 1 << 27;
        }
        row<FakePair>(pair, 0) = {0, 1, 1};
        row<FakePair>(pair, 1) = {1, 4, 0};
    }

    template <class Row>
    Row& row(std::uint32_t section, std::uint32_t index) {
        return arena_.table<Row>(section)[index];
    }
    StateArena& arena() { return arena_; }

    /// Called after each phase's own work, in every advance: a fault of the build.
    std::function<void(FakeSimulation&, std::uint32_t phase)> fault;

    std::uint32_t slot_count() const override { return slots_; }
    std::uint32_t input_size_bytes() const override { return kInputSizeBytes; }
    Tick tick() const override {
        return const_cast<StateArena&>(arena_).table<Globals>(globals)[0].tick;
    }

    Status advance(std::span<const SlotInput> inputs) override {
        if (tick() == fails_after) {
            return Error{"body_capacity ran out"};
        }
        for (std::uint32_t phase = 0; phase < kFakePhases.size(); ++phase) {
            run(phase, inputs);
            if (fault) {
                fault(*this, phase);
            }
            if (observer_ != nullptr) {
                observer_->after_phase(phase);
            }
        }
        return Success{};
    }

    std::uint64_t state_hash() const override { return StateHasher(arena_).root(arena_); }
    HashTree hash_tree() const override { return StateHasher(arena_).tree(arena_); }
    void save(std::vector<std::byte>& out) const override { save_canonical(arena_, out); }
    Status load(std::span<const std::byte> bytes) override {
        StateArena loaded(kFakeSections, kFakeCapacities);
        if (Status status = load_canonical(loaded, bytes); !status) {
            return status;
        }
        if (loaded.row_count(globals) != 1) {
            return Error{"snapshot: no globals"};
        }
        return load_canonical(arena_, bytes);
    }
    std::vector<std::byte> saved() const {
        std::vector<std::byte> bytes;
        save(bytes);
        return bytes;
    }

    StateSchema schema() const override { return kFakeSections; }
    std::span<const std::string_view> phases() const override { return kFakePhases; }
    void observe(PhaseObserver* observer) override { observer_ = observer; }
    PhaseObserver* observer() const { return observer_; }
    bool corrupt(std::string_view field) override {
        const std::optional<FieldPlace> place =
            find_field(kFakeSections, field.empty() ? "body.velocity.x" : field);
        if (!place || arena_.row_count(place->section) == 0) {
            return false;
        }
        std::byte* bytes = arena_.live_bytes(place->section).data();
        const FieldDescriptor& described = kFakeSections[place->section].fields[place->field];
        write_component(described,
                        place->component,
                        bytes,
                        read_component(described, place->component, bytes) + 1);
        return true;
    }

    Tick fails_after = UINT64_MAX;

private:
    void run(std::uint32_t phase, std::span<const SlotInput> inputs) {
        if (phase == 2) {
            row<Globals>(globals, 0).tick += 1;
            return;
        }
        for (std::uint32_t index = 0; index < kBodies; ++index) {
            FakeBody& moved = row<FakeBody>(body, index);
            const std::uint8_t push = inputs[index % slots_].bytes[0];
            moved.velocity[0] += phase == 0 ? push : 0;
            moved.position[0] += phase == 1 ? moved.velocity[0] : 0;
        }
    }

    StateArena arena_;
    std::uint32_t slots_;
    PhaseObserver* observer_ = nullptr;
};

inline std::vector<SlotInput> fake_inputs(Tick tick, std::uint32_t slots = 2) {
    std::vector<SlotInput> inputs(slots);
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
        inputs[slot].status = InputStatus::confirmed;
        inputs[slot].bytes[0] = static_cast<std::uint8_t>(tick * 7 + slot * 31);
        inputs[slot].bytes[1] = static_cast<std::uint8_t>(tick);
    }
    return inputs;
}

} // namespace lockwind::test
