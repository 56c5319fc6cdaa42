#include "lockwind/world_simulation.h"

#include "base/field_access.h"
#include "world/state.h"

#include "lockwind/player_input.h"

#include <algorithm>
#include <optional>

namespace lockwind {

namespace {

constexpr std::string_view kDefaultField = "body.linear_velocity.x";

std::string field_names(StateSchema schema) {
    std::string names;
    for (const SectionDescriptor& section : schema) {
        if (section.derived) {
            continue;
        }
        for (const FieldDescriptor& field : section.fields) {
            names += names.empty() ? "" : ", ";
            names += std::string(section.name) + "." + std::string(field.name);
        }
    }
    return names;
}

std::string phase_names() {
    std::string names;
    for (const std::string_view phase : World::phases()) {
        names += names.empty() ? "" : ", ";
        names += phase;
    }
    return names;
}

/// Row to corrupt: the first dynamic body's that is awake in the sections of bodies (who sleeps has
/// no velocity that could be another one), else the first. Nothing where the section has no row.
std::optional<std::uint32_t> row_to_corrupt(const World& world, std::uint32_t section) {
    if (world.row_count(section) == 0) {
        return std::nullopt;
    }
    if (section == section::kBody || section == section::kBodyLife ||
        section == section::kBodySleep) {
        for (BodyRow row = 0; row < world.body_count(); ++row) {
            const BodyView body = world.body_at(row);
            if (body.mode == BodyMode::dynamic && !body.asleep) {
                return row;
            }
        }
    }
    return 0;
}

/// Adds `delta` to a component's raw value.
void add_raw(World& world, const FieldPlace& place, std::uint32_t row, std::int64_t delta) {
    const SectionDescriptor& section = World::schema()[place.section];
    const FieldDescriptor& field = section.fields[place.field];
    std::byte* bytes =
        world.section_bytes(place.section).data() + std::size_t{section.stride_bytes} * row;
    const std::uint64_t raw = read_component(field, place.component, bytes);
    write_component(field, place.component, bytes, raw + static_cast<std::uint64_t>(delta));
    world.drop_derived();
}

void corrupt_default(World& world) {
    const std::optional<FieldPlace> place = find_field(World::schema(), kDefaultField);
    const std::optional<std::uint32_t> row = row_to_corrupt(world, place->section);
    if (row) {
        add_raw(world, *place, *row, 1);
    }
}

} // namespace

struct WorldSimulation::Impl final : PhaseObserver {
    explicit Impl(WorldPtr the_world) : world(std::move(the_world)) {}

    void after_phase(std::uint32_t phase) override {
        if (phase == fault_phase) {
            corrupt_default(*world);
        }
        if (observer != nullptr) {
            observer->after_phase(phase);
        }
    }

    WorldPtr world;
    PhaseObserver* observer = nullptr;
    std::uint32_t fault_phase = kNoIndex;
};

WorldSimulation::WorldSimulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

WorldSimulation::~WorldSimulation() = default;

Result<std::unique_ptr<WorldSimulation>> WorldSimulation::create(const WorldDefinition& definition,
                                                                 Simd simd) {
    Result<WorldPtr> world = World::create(definition, simd);
    if (!world) {
        return world.error();
    }
    auto impl = std::make_unique<Impl>(std::move(world).value());
    return std::unique_ptr<WorldSimulation>(new WorldSimulation(std::move(impl)));
}

World& WorldSimulation::world() {
    return *impl_->world;
}

const World& WorldSimulation::world() const {
    return *impl_->world;
}

std::uint32_t WorldSimulation::slot_count() const {
    return impl_->world->slot_count();
}

std::uint32_t WorldSimulation::input_size_bytes() const {
    return kPlayerInputSizeBytes;
}

Tick WorldSimulation::tick() const {
    return impl_->world->tick();
}

Status WorldSimulation::advance(std::span<const SlotInput> inputs) {
    const bool is_watched = impl_->observer != nullptr || impl_->fault_phase != kNoIndex;
    return impl_->world->step(inputs, is_watched ? impl_.get() : nullptr);
}

std::uint64_t WorldSimulation::state_hash() const {
    return impl_->world->state_hash();
}

HashTree WorldSimulation::hash_tree() const {
    return impl_->world->hash_tree();
}

void WorldSimulation::save(std::vector<std::byte>& out) const {
    impl_->world->save(out);
}

Status WorldSimulation::load(std::span<const std::byte> bytes) {
    return impl_->world->load(bytes);
}

void WorldSimulation::keep(KeptState& kept) const {
    impl_->world->keep(kept);
}

void WorldSimulation::restore(const KeptState& kept) {
    impl_->world->restore(kept);
}

StateSchema WorldSimulation::schema() const {
    return World::schema();
}

std::span<const std::string_view> WorldSimulation::phases() const {
    return World::phases();
}

void WorldSimulation::observe(PhaseObserver* observer) {
    impl_->observer = observer;
}

bool WorldSimulation::corrupt(std::string_view field) {
    return corrupt_field(field).ok();
}

Status WorldSimulation::check_field(std::string_view field) {
    if (field.empty() || find_field(World::schema(), field)) {
        return Success{};
    }
    return Error{"no field \"" + std::string(field) +
                 "\"; the state has: " + field_names(World::schema())};
}

Status WorldSimulation::corrupt_field(std::string_view field) {
    if (Status known = check_field(field); !known) {
        return known;
    }
    World& world = *impl_->world;
    const std::string_view path = field.empty() ? kDefaultField : field;
    const std::optional<FieldPlace> place = find_field(World::schema(), path);
    const std::optional<std::uint32_t> row = row_to_corrupt(world, place->section);
    if (!row) {
        return Error{"field \"" + std::string(path) + "\": the section has no row now"};
    }
    add_raw(world, *place, *row, 1);
    if (!world.check()) {
        add_raw(world, *place, *row, -2);
        if (!world.check()) {
            add_raw(world, *place, *row, 1);
            return Error{"field \"" + std::string(path) +
                         "\": another value would leave no state that can be stepped"};
        }
    }
    return Success{};
}

Status WorldSimulation::check_phase(std::string_view phase) {
    if (phase.empty() || std::ranges::find(World::phases(), phase) != World::phases().end()) {
        return Success{};
    }
    return Error{"no phase \"" + std::string(phase) + "\"; the step has: " + phase_names()};
}

Status WorldSimulation::set_phase_fault(std::string_view phase) {
    Status known = check_phase(phase);
    if (known) {
        const auto found = std::ranges::find(World::phases(), phase);
        impl_->fault_phase =
            phase.empty() ? kNoIndex : static_cast<std::uint32_t>(found - World::phases().begin());
    }
    return known;
}

} // namespace lockwind
