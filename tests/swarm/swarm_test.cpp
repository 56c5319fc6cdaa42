#include "scene/scene.h"
#include "tests/swarm/oracle.h"
#include "tests/swarm/report.h"
#include "tests/swarm/scenario.h"
#include "tests/swarm/watched_transport.h"
#include "tests/swarm/workers.h"
#include "transport/sim/loopback_network.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <gtest/gtest.h>

namespace lockwind::swarm {
namespace {

std::vector<SlotInput> inputs_of(std::uint8_t value) {
    SlotInput input;
    input.status = InputStatus::confirmed;
    input.bytes[0] = value;
    return {input};
}

TEST(Oracle, RefusesASecondSetOfInputsForATick) {
    Oracle oracle;
    oracle.confirmed(kServerParty, 5, inputs_of(1));
    oracle.confirmed(kFirstClientParty, 5, inputs_of(1));
    EXPECT_FALSE(oracle.failed());
    oracle.confirmed(kFirstClientParty + 1, 5, inputs_of(2));
    ASSERT_TRUE(oracle.failed());
    EXPECT_EQ(oracle.failures()[0], "tick 5: client 1 has other inputs than the server had");
}

TEST(Oracle, RefusesASecondHashForATick) {
    Oracle oracle;
    oracle.hashed(kServerParty, 5, 1);
    oracle.hashed(kFirstClientParty, 4, 2);
    EXPECT_FALSE(oracle.failed());
    oracle.hashed(kReplayParty, 5, 2);
    EXPECT_TRUE(oracle.failed());
}

TEST(Oracle, RefusesATickThatIsToldOfBeforeItIsLogged) {
    Confirmation confirmation;
    confirmation.first_tick = confirmation.confirmed_tick = 7;
    confirmation.ticks.push_back({inputs_of(1)});
    Oracle oracle;
    oracle.told(confirmation, 7);
    EXPECT_FALSE(oracle.failed());
    oracle.told(confirmation, 6);
    EXPECT_TRUE(oracle.failed());
}

TEST(Oracle, RefusesAHashOfATickThatIsNotConfirmed) {
    HashReport report;
    report.entries = {{3, 30}};
    Oracle oracle;
    oracle.reported(kFirstClientParty, report, 3);
    EXPECT_FALSE(oracle.failed());
    oracle.reported(kFirstClientParty, report, 2);
    EXPECT_TRUE(oracle.failed());
}

TEST(Scenario, EndsEveryFaultBeforeTheHealAndNeverTwoOfAClientAtOnce) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        const Scenario scenario = draw_scenario(seed, 600, "", "");
        std::vector<std::uint64_t> busy_until(scenario.clients.size(), 0);
        for (const Fault& fault : scenario.faults) {
            EXPECT_LT(fault.begin_us, fault.end_us);
            EXPECT_LE(fault.end_us, scenario.heal_us);
            if (fault.kind != FaultKind::server_freeze) {
                EXPECT_GE(fault.begin_us, busy_until[fault.client]);
                EXPECT_GE(fault.begin_us, scenario.clients[fault.client].arrival_us);
                busy_until[fault.client] = fault.end_us;
            }
        }
    }
}

TEST(Scenario, DrawsEveryKindOfFaultAndPolicy) {
    std::vector<int> kinds(8, 0);
    std::vector<int> policies(3, 0);
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const Scenario scenario = draw_scenario(seed, 600, "", "");
        ++policies[static_cast<std::size_t>(scenario.stall_policy)];
        for (const Fault& fault : scenario.faults) {
            ++kinds[static_cast<std::size_t>(fault.kind)];
        }
    }
    EXPECT_GT(*std::ranges::min_element(kinds), 10);
    EXPECT_GT(*std::ranges::min_element(policies), 30);
}

TEST(WatchedTransport, WakesItsProcessWhenItsOwnClockSaysSo) {
    for (const std::int32_t drift_ppm : {-500, -1, 0, 1, 500}) {
        VirtualClock clock;
        LoopbackNetwork network(clock);
        const WatchedTransport transport(network.open(1), {1'000'000, drift_ppm});
        for (const std::uint64_t local_us : {1'000'001ULL, 1'016'667ULL, 30'000'000ULL}) {
            const std::uint64_t network_us = transport.network_us(local_us);
            clock.advance_to(network_us);
            EXPECT_GE(transport.clock_us(), local_us);
            EXPECT_LE(transport.clock_us(), local_us + 2);
        }
    }
}

TEST(Report, FailsWhereTooLittleHappened) {
    SeedResult rich;
    rich.figures.contacts = rich.figures.drops = rich.figures.reconnects = 1;
    rich.figures.late_joins = rich.figures.partitions = rich.figures.kills = 1;
    rich.figures.packets_lost = rich.figures.packets_duplicated = 1;
    rich.figures.packets_reordered = rich.figures.substituted_inputs = 1;
    const SwarmReport few = sum_up(std::vector<SeedResult>(kSeedsForVacuity - 1, rich));
    EXPECT_TRUE(passed(few)) << "a few seeds may be quiet";
    const SwarmReport many = sum_up(std::vector<SeedResult>(kSeedsForVacuity, rich));
    EXPECT_FALSE(passed(many));
    EXPECT_EQ(many.vacuous, std::vector<std::string>{"stalls"});
}

SeedResult lucky_number(std::uint64_t seed) {
    SeedResult result;
    result.seed = seed;
    result.figures.ticks = seed;
    result.digest = 2 * seed;
    if (seed == 4) {
        std::abort();
    }
    if (seed >= 6) {
        result.failures = {"one", "two"};
    }
    return result;
}

TEST(Workers, BringEveryResultHomeEvenOfASeedThatDies) {
    int calls = 0;
    const auto results =
        run_seeds({3, 4, 3}, lucky_number, [&](const SeedResult& /*result*/) { ++calls; });
    ASSERT_EQ(results.size(), 4U);
    EXPECT_EQ(calls, 4);
    EXPECT_EQ(results[0].seed, 3U);
    EXPECT_EQ(results[0].figures.ticks, 3U);
    EXPECT_EQ(results[0].digest, 6U);
    EXPECT_TRUE(results[0].failures.empty());
    EXPECT_EQ(results[1].seed, 4U);
    EXPECT_EQ(results[1].failures,
              std::vector<std::string>{"the process died of signal " + std::to_string(SIGABRT)});
    EXPECT_EQ(results[3].failures, (std::vector<std::string>{"one", "two"}));
}

TEST(Workers, StopAtTheFirstFailureWhoeverElseIsRunning) {
    for (const std::uint32_t jobs : {1U, 2U, 5U}) {
        const auto results =
            run_seeds({5, 100, jobs, true}, lucky_number, [](const SeedResult& /*result*/) {});
        ASSERT_EQ(results.size(), 2U);
        EXPECT_EQ(results.back().seed, 6U);
    }
}

TEST(SeedRun, TellsWhyAMatchCannotBePlayed) {
    SwarmSettings settings;
    settings.scene_text = load_scene_text(settings.scene_name).value();
    settings.folder = "/no/such/folder";
    const SeedResult result = run_seed(1, settings);
    ASSERT_FALSE(result.failures.empty());
    EXPECT_NE(result.failures[0].find(settings.folder), std::string::npos);
}

} // namespace
} // namespace lockwind::swarm
