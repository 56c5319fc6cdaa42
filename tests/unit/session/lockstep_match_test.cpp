#include "tests/unit/session/virtual_match.h"

namespace lockwind::testing {
namespace {

TEST(LockstepMatch, GivesEveryoneTheChainOfAStraightRun) {
    VirtualMatch match(VirtualMatch::server_settings(3, 300));
    match.add_clients(3);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.log.size(), 300U);
    match.expect_one_chain();
    for (const auto& client : match.clients) {
        EXPECT_EQ(client->chain.size(), 300U);
        EXPECT_EQ(client->session.end_reason(), EndReason::complete);
        EXPECT_EQ(client->session.state_hash_tick(), 300U);
        EXPECT_EQ(client->session.state_hash(), match.server.session.state_hash());
        EXPECT_EQ(client->session.counters().ticks_confirmed, 300U);
        EXPECT_EQ(client->session.counters().stalls, 0U);
        EXPECT_EQ(client->inputs_given.rbegin()->first, 300U); // none for ticks that never come
    }
    const LockstepServerCounters& counters = match.server.session.counters();
    EXPECT_EQ(counters.joins, 3U);
    EXPECT_EQ(counters.hashes_agreed, 900U);
    EXPECT_EQ(counters.stalls, 0U);
    EXPECT_EQ(counters.late_inputs, 0U);
    EXPECT_EQ(counters.violations.total(), 0U);
    EXPECT_EQ(counters.tick_lateness_us.count(), 300U);
    EXPECT_EQ(counters.tick_lateness_us.max(), 0U);
    EXPECT_GE(match.server.confirmed_ticks_checked, 300U);
}

TEST(LockstepMatch, ConfirmsEachSlotsOwnInputs) {
    VirtualMatch match(VirtualMatch::server_settings(2, 100));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_end());
    std::size_t compared = 0;
    for (const auto& client : match.clients) {
        for (const auto& [tick, inputs] : match.server.log) {
            const SlotInput& confirmed = inputs[client->session.slot()];
            EXPECT_EQ(confirmed.status, InputStatus::confirmed);
            EXPECT_EQ(confirmed.bytes, client->inputs_given.at(tick).bytes);
            ++compared;
        }
    }
    EXPECT_EQ(compared, 200U);
}

TEST(LockstepMatch, OtherInputsGiveAnotherChain) {
    std::set<std::uint64_t> hashes;
    for (const std::uint64_t token : {1U, 2U, 3U}) {
        VirtualMatch match(VirtualMatch::server_settings(1, 50));
        match.add_client(token);
        ASSERT_TRUE(match.run_to_end());
        hashes.insert(match.server.session.state_hash());
    }
    EXPECT_EQ(hashes.size(), 3U);
}

TEST(LockstepMatch, SurvivesLossDuplicationReorderingAndLatePackets) {
    Conditions conditions;
    conditions.latency_us = 40'000;
    conditions.jitter_us = 30'000;
    conditions.loss_per_mille = 100;
    conditions.duplicate_per_mille = 100;
    conditions.late_per_mille = 20;
    conditions.reliable_loss_per_mille = 50;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        SCOPED_TRACE(seed);
        VirtualMatch match(VirtualMatch::server_settings(4, 400), conditions, seed);
        match.add_clients(4);
        ASSERT_TRUE(match.run_to_end());
        EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
        EXPECT_EQ(match.server.log.size(), 400U);
        match.expect_one_chain();
        EXPECT_EQ(match.server.session.counters().violations.total(), 0U);
        EXPECT_EQ(match.server.session.counters().desyncs, 0U);
        EXPECT_EQ(match.server.session.counters().substituted_inputs, 0U);
        EXPECT_EQ(match.server.session.counters().hashes_agreed, 1600U);
        EXPECT_GT(match.network.lost, 100U);
        EXPECT_GT(match.network.duplicated, 100U);
        EXPECT_GT(match.network.reordered, 100U);
        EXPECT_GT(match.network.late, 10U);
        std::uint64_t doubled = 0;
        for (const auto& client : match.clients) {
            doubled += client->session.counters().confirmations_doubled;
        }
        EXPECT_GT(doubled, 100U);
    }
}

TEST(LockstepMatch, IsNotGatedOnTheRoundTrip) {
    Conditions conditions;
    conditions.latency_us = 100'000; // 12 ticks there and back; the input delay is 2
    VirtualMatch match(VirtualMatch::server_settings(2, 600), conditions);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_end());
    const LockstepServerCounters& counters = match.server.session.counters();
    EXPECT_LE(counters.stalls, 20U); // while the round trip is not known yet
    EXPECT_EQ(counters.tick_lateness_us.quantile(900), 0U);
    for (const auto& client : match.clients) {
        EXPECT_EQ(client->session.counters().rtt_us.max(), 200'000U);
    }
    match.expect_one_chain();
}

TEST(LockstepMatch, WritesEachTickBeforeAnybodyHearsOfIt) {
    // ServerDriver checks every tick of every confirmation against the log at the moment it is
    // sent.
    Conditions conditions;
    conditions.loss_per_mille = 200;
    VirtualMatch match(VirtualMatch::server_settings(2, 200), conditions);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_GT(match.server.confirmed_ticks_checked, 200U);
}

TEST(LockstepMatch, AsksForStepRecordConfirmationInThisOrder) {
    LockstepServerSettings settings = VirtualMatch::server_settings(1, 3);
    settings.start_delay_ms = 0;
    LockstepServer server(settings);
    server.update(1);
    server.receive(5, Hello{kProtocolVersion, "v1", "b", 9, 1}, 2);
    server.receive(5, Ready{0, settings.initial_state_hash}, 3);
    InputBatch batch;
    batch.first_tick = 1;
    batch.inputs.resize(3);
    batch.sent_us = 3;
    server.receive(5, batch, 4);
    server.update(5);
    server.take_requests();
    server.update(5 + 16'666);
    const std::vector<Request> requests = server.take_requests();
    ASSERT_EQ(requests.size(), 3U);
    EXPECT_EQ(std::get<AdvanceRequest>(requests[0]).tick, 1U);
    EXPECT_EQ(std::get<PersistRequest>(requests[1]).tick, 1U);
    const auto& confirmation = std::get<Confirmation>(std::get<SendRequest>(requests[2]).message);
    EXPECT_EQ(confirmation.confirmed_tick, 1U);
    EXPECT_EQ(server.confirmed_tick(), 1U);
    // The next tick waits for advanced(), however late it is.
    server.update(900'000);
    for (const Request& request : server.take_requests()) {
        EXPECT_FALSE(std::holds_alternative<AdvanceRequest>(request));
    }
    server.advanced(1, 77, 5 + 16'666 + 300);
    EXPECT_EQ(server.counters().tick_lateness_us.max(), 300U);
    EXPECT_EQ(server.state_hash(), 77U);
    server.update(900'001);
    EXPECT_EQ(server.confirmed_tick(), 2U);
}

TEST(LockstepMatch, ComparesHashesAtTheIntervalAndOnTheLastTick) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 102);
    settings.config.hash_interval_ticks = 4;
    VirtualMatch match(settings);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.session.counters().hashes_agreed, 2U * (25 + 1));
    EXPECT_EQ(match.server.session.state_hash_tick(), 102U);
    match.expect_one_chain();
}

TEST(LockstepMatch, WrapsTheInputRingManyTimes) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 10 * kInputWindowTicks + 5);
    settings.config.tick_rate_hz = 128;
    Conditions conditions;
    conditions.jitter_us = 20'000;
    VirtualMatch match(settings, conditions);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.log.size(), 10 * kInputWindowTicks + 5);
    match.expect_one_chain();
}

TEST(LockstepMatch, PlaysAtEveryRateAndDelay) {
    for (const std::uint32_t rate : {1U, 30U, 120U, 1000U}) {
        for (const std::uint32_t delay : {0U, 5U}) {
            LockstepServerSettings settings = VirtualMatch::server_settings(2, 40);
            settings.config.tick_rate_hz = rate;
            settings.config.input_delay_ticks = delay;
            VirtualMatch match(settings);
            match.add_clients(2);
            ASSERT_TRUE(match.run_to_end()) << rate << " Hz, delay " << delay;
            EXPECT_EQ(match.server.log.size(), 40U);
            match.expect_one_chain();
        }
    }
}

TEST(LockstepMatch, PlaysWithSixtyFourPlayers) {
    Conditions conditions;
    conditions.loss_per_mille = 20;
    VirtualMatch match(VirtualMatch::server_settings(kPlayersMax, 40), conditions);
    match.add_clients(kPlayersMax);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.counters().hashes_agreed, 40U * kPlayersMax);
    match.expect_one_chain();
}

TEST(LockstepMatch, StartsWithThosePresentAfterTheJoinTimeout) {
    VirtualMatch match(VirtualMatch::server_settings(3, 60));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.log.at(60)[2].status, InputStatus::disconnected);
    EXPECT_EQ(match.server.log.at(60)[1].status, InputStatus::confirmed);
    ASSERT_NE(match.server.find(SessionEventKind::started), nullptr);
    EXPECT_EQ(match.server.find(SessionEventKind::started)->text, "2 of 3 players");
    match.expect_one_chain();
}

TEST(LockstepMatch, FailsWithNobodyPresent) {
    VirtualMatch match(VirtualMatch::server_settings(3, 60));
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::failed);
    EXPECT_EQ(match.server.session.end_message(), "no player joined within 30000 ms");
    EXPECT_TRUE(match.server.log.empty());
}

TEST(LockstepMatch, WithoutALengthEndsWhenAllHaveLeft) {
    VirtualMatch match(VirtualMatch::server_settings(2, 0));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(50));
    match.clients[0]->session.leave();
    ASSERT_TRUE(match.run_to_tick(100));
    match.clients[1]->session.leave();
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.count(SessionEventKind::left), 2U);
    EXPECT_EQ(match.server.log.at(90)[0].status, InputStatus::disconnected);
    EXPECT_EQ(match.server.log.at(90)[1].status, InputStatus::confirmed);
    EXPECT_EQ(match.server.session.counters().drops, 0U);
    match.expect_one_chain();
}

TEST(LockstepMatch, StopSettlesTheHashesAndEnds) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 0);
    settings.config.hash_interval_ticks = 4;
    VirtualMatch match(settings);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(50));
    match.server.session.stop("interrupted by the operator");
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::stopped);
    for (const auto& client : match.clients) {
        EXPECT_EQ(client->session.end_reason(), EndReason::stopped);
        EXPECT_EQ(client->session.end_message(), "interrupted by the operator");
    }
    EXPECT_EQ(match.server.session.counters().hashes_agreed, 2U * (50 / 4));
    match.expect_one_chain();
}

TEST(LockstepMatch, AFailedStepEndsTheMatchForAll) {
    VirtualMatch match(VirtualMatch::server_settings(2, 100));
    match.add_clients(2);
    match.server.simulation.fail_at(30);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::failed);
    EXPECT_EQ(match.server.session.end_message(), "counter: planted failure");
    for (const auto& client : match.clients) {
        EXPECT_EQ(client->session.end_reason(), EndReason::failed);
    }
    EXPECT_EQ(match.server.log.size(), 29U);
    EXPECT_EQ(match.server.session.confirmed_tick(), 29U);
    for (const auto& client : match.clients) {
        EXPECT_EQ(client->session.confirmed_tick(), 29U); // nobody heard of tick 30
    }
}

TEST(LockstepMatch, ClosesOnceEveryClientHasAnsweredTheEnd) {
    VirtualMatch match(VirtualMatch::server_settings(2, 20));
    match.add_clients(2);
    ASSERT_TRUE(match.run([&] { return match.server.session.phase() == MatchPhase::closing; }));
    const std::uint64_t closing_us = match.now_us;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.now_us - closing_us, 2U * 2'000U); // one round trip
    EXPECT_EQ(match.server.count(SessionEventKind::ended), 1U);
}

} // namespace
} // namespace lockwind::testing
