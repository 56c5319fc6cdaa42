#include "tests/swarm/plant.h"

#include "base/field_access.h"
#include "forensics/match_simulation.h"

#include <algorithm>
#include <array>

namespace lockwind::swarm {

namespace {

constexpr std::array<std::string_view, 4> kNames{
    "none", "unconfirmed_hash", "reordered_input", "missing_field"};

/// Now and then hashes the state to come, its inputs guessed from the last ones.
class UnconfirmedHash final : public WireTap {
public:
    explicit UnconfirmedHash(const Bot& bot) : bot_(bot) {}

    bool on_send(Message& message) override {
        auto* report = std::get_if<HashReport>(&message);
        if (report == nullptr || ++reports_ % kEveryReports != 0) {
            return false;
        }
        const LockstepClient& session = bot_.session();
        const std::span<const SlotInput> inputs =
            session.confirmed_inputs(bot_.simulation()->tick());
        const Tick predicted = next_hash_tick(session.config(), bot_.simulation()->tick());
        if (inputs.empty() || predicted <= report->entries.back().tick ||
            predicted > session.config().ticks) {
            return false;
        }
        std::unique_ptr<WorldSimulation> copy = create_match_simulation(session.config()).value();
        std::vector<std::byte> state;
        bot_.simulation()->save(state);
        bool stepped = copy->load(state).ok();
        while (stepped && copy->tick() < predicted) {
            stepped = copy->advance(inputs).ok();
        }
        if (stepped) {
            report->entries.push_back({predicted, copy->state_hash()});
        }
        return stepped;
    }

private:
    static constexpr std::uint64_t kEveryReports = 16;

    const Bot& bot_;
    std::uint64_t reports_ = 0;
};

/// After a confirmation that was overtaken, the next new input never leaves the client.
class ReorderedInput final : public WireTap {
public:
    bool on_receive(Message& message) override {
        if (const auto* confirmation = std::get_if<Confirmation>(&message)) {
            reordered_ = reordered_ || confirmation->confirmed_tick < newest_tick_;
            newest_tick_ = std::max(newest_tick_, confirmation->confirmed_tick);
        }
        return false;
    }

    bool on_send(Message& message) override {
        auto* batch = std::get_if<InputBatch>(&message);
        if (batch == nullptr || batch->inputs.empty()) {
            return false;
        }
        const Tick last = batch->first_tick + batch->inputs.size() - 1;
        if (reordered_ && last > sent_tick_) {
            reordered_ = false;
            forgotten_tick_ = sent_tick_ + 1;
        }
        sent_tick_ = std::max(sent_tick_, last);
        if (forgotten_tick_ < batch->first_tick || forgotten_tick_ > last) {
            return false;
        }
        // A batch has no gaps: it goes on behind the forgotten input, or ends before it.
        if (forgotten_tick_ == batch->first_tick) {
            batch->inputs.erase(batch->inputs.begin());
            ++batch->first_tick;
        } else {
            batch->inputs.resize(forgotten_tick_ - batch->first_tick);
        }
        return true;
    }

private:
    bool reordered_ = false;
    Tick newest_tick_ = 0;
    Tick sent_tick_ = 0;
    Tick forgotten_tick_ = 0;
};

/// Every body stands still in the snapshot that arrives. The swarm's scene fits into one chunk;
/// larger snapshots pass as they are.
class MissingField final : public WireTap {
public:
    explicit MissingField(const MatchConfig& config) : config_(config) {}

    bool on_receive(Message& message) override {
        auto* chunk = std::get_if<Chunk>(&message);
        if (chunk == nullptr || chunk->kind != BlobKind::snapshot || chunk->count != 1) {
            return false;
        }
        std::unique_ptr<WorldSimulation> copy = create_match_simulation(config_).value();
        if (!copy->load(chunk->bytes)) {
            return false;
        }
        const FieldPlace place = find_field(World::schema(), "body.linear_velocity").value();
        const SectionDescriptor& section = World::schema()[place.section];
        const FieldDescriptor& field = section.fields[place.field];
        const std::span<std::byte> bytes = copy->world().section_bytes(place.section);
        for (std::uint32_t row = 0; row < copy->world().row_count(place.section); ++row) {
            for (std::uint32_t component = 0; component < field.components; ++component) {
                write_component(
                    field, component, &bytes[std::size_t{section.stride_bytes} * row], 0);
            }
        }
        copy->save(chunk->bytes);
        return true;
    }

private:
    const MatchConfig& config_;
};

} // namespace

std::span<const std::string_view> plant_names() {
    return std::span(kNames).subspan(1);
}

std::string_view to_string(Plant plant) {
    return kNames.at(static_cast<std::size_t>(plant));
}

std::optional<Plant> find_plant(std::string_view name) {
    const auto* found = std::ranges::find(kNames, name);
    return found == kNames.end() ? std::nullopt
                                 : std::optional(static_cast<Plant>(found - kNames.begin()));
}

std::unique_ptr<WireTap> make_plant(Plant plant, const MatchConfig& config, const Bot& bot) {
    switch (plant) {
    case Plant::unconfirmed_hash:
        return std::make_unique<UnconfirmedHash>(bot);
    case Plant::reordered_input:
        return std::make_unique<ReorderedInput>();
    case Plant::missing_field:
        return std::make_unique<MissingField>(config);
    case Plant::none:
        break;
    }
    return nullptr;
}

} // namespace lockwind::swarm
