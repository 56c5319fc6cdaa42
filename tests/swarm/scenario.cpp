#include "tests/swarm/scenario.h"

#include "session/match_config.h"
#include "tests/support/dice.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace lockwind::swarm {

using testing::Dice;

namespace {

/// From the heal to the last tick: longer than silence is borne (2 s), a seat is kept (0.5 s), a
/// reliable packet is under way from a storm (2 s), and a snapshot takes, one after the other.
constexpr std::uint64_t kHealedUs = 5'000'000;
/// Players are gathered for so long where some of them come later.
constexpr std::uint32_t kJoinTimeoutMs = 2'500;
constexpr std::uint32_t kGatherUs = kJoinTimeoutMs * 1000;

std::uint32_t draw_u32(Dice& dice, std::uint32_t first, std::uint32_t last) {
    return static_cast<std::uint32_t>(dice.between(first, last));
}

/// Conditions between perfect and the worst of a kind.
struct Climate {
    std::uint32_t latency_us_max;
    std::uint32_t loss_ppm_max;
    std::uint32_t duplicate_ppm_max;
    std::uint32_t reorder_ppm_max;
};
constexpr Climate kLocal{3'000, 0, 0, 0};
constexpr Climate kWide{80'000, 30'000, 20'000, 30'000};
constexpr Climate kBad{150'000, 200'000, 100'000, 200'000};

LinkConditions draw_conditions(Dice& dice, const Climate& climate) {
    LinkConditions conditions;
    conditions.latency_us = draw_u32(dice, 100, climate.latency_us_max);
    conditions.jitter_us = draw_u32(dice, 0, conditions.latency_us);
    conditions.loss_ppm = draw_u32(dice, 0, climate.loss_ppm_max);
    conditions.duplicate_ppm = draw_u32(dice, 0, climate.duplicate_ppm_max);
    conditions.reorder_ppm = draw_u32(dice, 0, climate.reorder_ppm_max);
    conditions.reorder_delay_us = draw_u32(dice, 1'000, 100'000);
    const bool narrow = climate.loss_ppm_max > 0 && dice.chance(100);
    conditions.bandwidth_bytes_per_s = narrow ? dice.between(100'000, 500'000) : 0;
    return conditions;
}

LinkConditions draw_storm(Dice& dice) {
    LinkConditions conditions;
    conditions.latency_us = draw_u32(dice, 50'000, 150'000);
    conditions.jitter_us = draw_u32(dice, 0, conditions.latency_us);
    conditions.loss_ppm = draw_u32(dice, 100'000, 300'000);
    conditions.duplicate_ppm = draw_u32(dice, 0, 300'000);
    conditions.reorder_ppm = draw_u32(dice, 0, 300'000);
    conditions.reorder_delay_us = draw_u32(dice, 20'000, 200'000);
    return conditions;
}

MatchConfig draw_config(Dice& dice) {
    constexpr std::array<std::uint32_t, 4> kTickRatesHz{30, 50, 60, 60};
    constexpr std::array<std::uint32_t, 6> kHashIntervals{1, 1, 1, 2, 7, 30};
    MatchConfig config;
    config.match = "swarm";
    config.mode = "lockstep";
    config.seed = dice.next();
    config.players = draw_u32(dice, kClientsMin, kClientsMax);
    config.tick_rate_hz = kTickRatesHz.at(dice.below(kTickRatesHz.size()));
    config.input_delay_ticks = draw_u32(dice, 0, 6);
    config.hash_interval_ticks = kHashIntervals.at(dice.below(kHashIntervals.size()));
    return config;
}

/// The first client is there, over a fair link, before players are no longer waited for.
ClientPlan draw_client(Dice& dice, std::uint32_t index, bool late, std::uint64_t heal_us) {
    constexpr std::array<const char*, 5> kBehaviours{"fight", "fight", "fight", "wander", "idle"};
    constexpr std::array<Climate, 4> kClimates{kLocal, kWide, kWide, kBad};
    ClientPlan client;
    client.behaviour = kBehaviours.at(dice.below(kBehaviours.size()));
    client.arrival_us =
        late ? dice.between(kGatherUs, std::max<std::uint64_t>(kGatherUs, heal_us - 1))
             : dice.below(index == 0 ? 100'000 : 500'000);
    const Climate& climate = kClimates.at(dice.below(kClimates.size() - (index == 0 ? 1 : 0)));
    client.up = draw_conditions(dice, climate);
    client.down = draw_conditions(dice, climate);
    client.clock_offset_us = dice.below(1'000'000'000);
    client.clock_drift_ppm = static_cast<std::int32_t>(dice.between(0, 1'000)) - 500;
    return client;
}

/// Mostly shorter than the timeouts of the sessions, sometimes longer than all of them.
std::uint64_t draw_duration_us(Dice& dice) {
    switch (dice.below(4)) {
    case 0:
        return dice.between(10'000, 200'000);
    case 1:
    case 2:
        return dice.between(200'000, 1'500'000);
    default:
        return dice.between(1'500'000, 4'000'000);
    }
}

void add_faults(Dice& dice, std::uint32_t client, std::uint64_t from_us, Scenario& scenario) {
    constexpr std::array<FaultKind, 9> kKinds{FaultKind::partition,
                                              FaultKind::partition,
                                              FaultKind::deaf,
                                              FaultKind::mute,
                                              FaultKind::storm,
                                              FaultKind::freeze,
                                              FaultKind::kill,
                                              FaultKind::kill,
                                              FaultKind::leave};
    std::uint64_t begin_us = from_us + dice.between(50'000, 2'500'000);
    while (begin_us < scenario.heal_us) {
        Fault fault;
        fault.kind = kKinds.at(dice.below(kKinds.size()));
        fault.client = client;
        fault.begin_us = begin_us;
        fault.end_us = std::min(begin_us + draw_duration_us(dice), scenario.heal_us);
        fault.conditions = draw_storm(dice);
        scenario.faults.push_back(fault);
        begin_us = fault.end_us + dice.between(50'000, 2'500'000);
    }
}

void add_server_freeze(Dice& dice, Scenario& scenario) {
    Fault fault;
    fault.kind = FaultKind::server_freeze;
    fault.begin_us = dice.between(kGatherUs, scenario.heal_us - 1);
    fault.end_us = std::min(fault.begin_us + draw_duration_us(dice), scenario.heal_us);
    scenario.faults.push_back(fault);
}

std::string text_of(const LinkConditions& link) {
    return fmt::format("{}+-{} ms, loss {:.1f} %, dup {:.1f} %, reorder {:.1f} %, {} kB/s",
                       link.latency_us / 1000,
                       link.jitter_us / 1000,
                       link.loss_ppm / 1e4,
                       link.duplicate_ppm / 1e4,
                       link.reorder_ppm / 1e4,
                       link.bandwidth_bytes_per_s == 0
                           ? "any"
                           : std::to_string(link.bandwidth_bytes_per_s / 1000));
}

} // namespace

std::string_view to_string(FaultKind kind) {
    static constexpr std::array<std::string_view, 8> kNames{
        "partition", "deaf", "mute", "storm", "freeze", "kill", "leave", "server_freeze"};
    return kNames.at(static_cast<std::size_t>(kind));
}

Scenario draw_scenario(std::uint64_t seed,
                       Tick ticks,
                       const std::string& scene_name,
                       const std::string& scene_text) {
    Dice dice(seed);
    Scenario scenario;
    scenario.config = draw_config(dice);
    scenario.config.ticks = ticks;
    scenario.config.scene_name = scene_name;
    scenario.config.scene_text = scene_text;
    scenario.stall_policy = static_cast<StallPolicy>(dice.below(3));
    const std::uint64_t match_us = ticks * tick_period_us(scenario.config);
    scenario.heal_us = match_us - kHealedUs;

    // The first client and the server are left alone until the match has begun.
    const bool some_late = dice.chance(400);
    const bool calm = dice.chance(50);
    scenario.join_timeout_ms = some_late ? kJoinTimeoutMs : 30'000;
    for (std::uint32_t index = 0; index < scenario.config.players; ++index) {
        const bool late = some_late && index > 0 && dice.chance(500);
        const ClientPlan client = draw_client(dice, index, late, scenario.heal_us);
        scenario.clients.push_back(client);
        const bool spared = calm || dice.chance(200);
        if (!spared) {
            add_faults(dice, index, index == 0 ? kGatherUs : client.arrival_us, scenario);
        }
    }
    if (!calm && dice.chance(300)) {
        add_server_freeze(dice, scenario);
    }
    std::stable_sort(scenario.faults.begin(),
                     scenario.faults.end(),
                     [](const Fault& a, const Fault& b) { return a.begin_us < b.begin_us; });
    return scenario;
}

std::vector<std::string> describe(const Scenario& scenario) {
    constexpr std::array<const char*, 3> kPolicies{"pause", "substitute", "drop"};
    const MatchConfig& config = scenario.config;
    std::vector<std::string> lines;
    lines.push_back(fmt::format(
        "{} players, {} ticks at {} Hz, input delay {}, hash interval {}, stall policy {}, "
        "healed at {} ms",
        config.players,
        config.ticks,
        config.tick_rate_hz,
        config.input_delay_ticks,
        config.hash_interval_ticks,
        kPolicies.at(static_cast<std::size_t>(scenario.stall_policy)),
        scenario.heal_us / 1000));
    for (std::size_t index = 0; index < scenario.clients.size(); ++index) {
        const ClientPlan& client = scenario.clients[index];
        lines.push_back(fmt::format("client {}: {} from {} ms; clock {:+} ppm; up {}; down {}",
                                    index,
                                    client.behaviour,
                                    client.arrival_us / 1000,
                                    client.clock_drift_ppm,
                                    text_of(client.up),
                                    text_of(client.down)));
    }
    return lines;
}

} // namespace lockwind::swarm
