#include "tests/unit/session/virtual_match.h"

namespace lockwind::testing {
namespace {

TEST(LockstepDesync, IsDetectedAtExactlyItsTickWithTheTickBeforeAgreed) {
    for (const Tick bad_tick : {Tick{1}, Tick{57}, Tick{128}, Tick{299}, Tick{300}}) {
        SCOPED_TRACE(bad_tick);
        VirtualMatch match(VirtualMatch::server_settings(3, 300));
        match.add_clients(3);
        match.clients[1]->corrupt_at = bad_tick;
        ASSERT_TRUE(match.run_to_end());
        EXPECT_EQ(match.server.session.end_reason(), EndReason::desync);
        ASSERT_EQ(match.server.session.desyncs().size(), 1U);
        const HashMismatch& desync = match.server.session.desyncs()[0];
        EXPECT_EQ(desync.slot, match.clients[1]->session.slot());
        EXPECT_EQ(desync.bad_tick, bad_tick);
        EXPECT_EQ(desync.agreed_tick, bad_tick - 1);
        EXPECT_EQ(desync.server_hash, match.server.chain.at(bad_tick));
        EXPECT_EQ(desync.client_hash, match.clients[1]->chain.at(bad_tick));
        EXPECT_NE(desync.server_hash, desync.client_hash);
        ASSERT_EQ(match.server.bundles.size(), 1U);
        EXPECT_EQ(match.server.bundles[0].report.size(), 1000U);
        EXPECT_EQ(match.clients[1]->report_requests.size(), 1U);
        EXPECT_EQ(match.clients[0]->report_requests.size(), 0U);
        for (const auto& client : match.clients) {
            EXPECT_EQ(client->session.end_reason(), EndReason::desync);
        }
        ASSERT_NE(match.server.find(SessionEventKind::desync_detected), nullptr);
        EXPECT_EQ(match.server.find(SessionEventKind::desync_detected)->tick, bad_tick);
        // Policy halt: the tick under way when the report came is the last one.
        EXPECT_LE(match.server.log.size(), std::min<Tick>(bad_tick + 2, 300));
    }
}

TEST(LockstepDesync, IsBoundedByTheHashIntervalWhereNotEveryTickIsHashed) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 203);
    settings.config.hash_interval_ticks = 4;
    const std::vector<std::array<Tick, 3>> cases = {
        // corrupt at, agreed, bad
        {1, 0, 4},
        {57, 56, 60},
        {60, 56, 60},
        {201, 200, 203},
        {203, 200, 203},
    };
    for (const auto& [corrupt_at, agreed_tick, bad_tick] : cases) {
        SCOPED_TRACE(corrupt_at);
        VirtualMatch match(settings);
        match.add_clients(2);
        match.clients[0]->corrupt_at = corrupt_at;
        ASSERT_TRUE(match.run_to_end());
        ASSERT_EQ(match.server.session.desyncs().size(), 1U);
        EXPECT_EQ(match.server.session.desyncs()[0].agreed_tick, agreed_tick);
        EXPECT_EQ(match.server.session.desyncs()[0].bad_tick, bad_tick);
        EXPECT_EQ(match.server.bundles.size(), 1U);
    }
}

TEST(LockstepDesync, IsFoundUnderLossTooAtTheSameTick) {
    Conditions conditions;
    conditions.latency_us = 50'000;
    conditions.jitter_us = 50'000;
    conditions.loss_per_mille = 100;
    conditions.reliable_loss_per_mille = 100;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        VirtualMatch match(VirtualMatch::server_settings(2, 300), conditions, seed);
        match.add_clients(2);
        match.clients[1]->corrupt_at = 150;
        match.clients[1]->report_size_bytes = 500'000;
        ASSERT_TRUE(match.run_to_end());
        ASSERT_EQ(match.server.session.desyncs().size(), 1U);
        EXPECT_EQ(match.server.session.desyncs()[0].bad_tick, 150U);
        EXPECT_EQ(match.server.session.desyncs()[0].agreed_tick, 149U);
        ASSERT_EQ(match.server.bundles.size(), 1U);
        EXPECT_EQ(match.server.bundles[0].report, std::vector<std::byte>(500'000, std::byte{0x5a}));
        EXPECT_GT(match.network.lost, 20U);
    }
}

TEST(LockstepDesync, TwoSlotsAreBothAsked) {
    VirtualMatch match(VirtualMatch::server_settings(3, 300));
    match.add_clients(3);
    match.network.extra_latency_us[match.clients[2]->peer] = 40'000;
    match.clients[0]->corrupt_at = 100;
    match.clients[2]->corrupt_at = 100;
    ASSERT_TRUE(match.run_to_end());
    ASSERT_EQ(match.server.session.desyncs().size(), 2U);
    EXPECT_EQ(match.server.session.counters().desyncs, 2U);
    for (const HashMismatch& desync : match.server.session.desyncs()) {
        EXPECT_EQ(desync.bad_tick, 100U);
        EXPECT_EQ(desync.agreed_tick, 99U);
        EXPECT_NE(desync.slot, match.clients[1]->session.slot());
    }
    EXPECT_EQ(match.server.bundles.size(), 2U);
    EXPECT_EQ(match.server.session.end_message(), "desync at tick 100 in 2 of 3 slots");
}

TEST(LockstepDesync, AQueryThatIsRepeatedIsAnsweredOnce) {
    Conditions conditions;
    conditions.latency_us = 400'000; // the query is repeated after 500 ms
    VirtualMatch match(VirtualMatch::server_settings(1, 300), conditions);
    match.add_clients(1);
    match.clients[0]->corrupt_at = 100;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.clients[0]->report_requests.size(), 1U);
    EXPECT_EQ(match.clients[0]->session.counters().desyncs, 1U);
    ASSERT_EQ(match.server.bundles.size(), 1U);
    EXPECT_EQ(match.server.bundles[0].report.size(), 1000U);
}

TEST(LockstepDesync, AClientThatDiesBeforeItsReportEndsTheInquiry) {
    VirtualMatch match(VirtualMatch::server_settings(2, 300));
    match.add_clients(2);
    match.clients[1]->corrupt_at = 100;
    ASSERT_TRUE(match.run([&] { return match.server.session.phase() == MatchPhase::halted; }));
    const std::uint64_t halted_us = match.now_us;
    match.clients[1]->alive = false;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_GE(match.now_us - halted_us, 20'000'000U); // report_timeout_ms
    EXPECT_EQ(match.server.session.end_reason(), EndReason::desync);
    ASSERT_EQ(match.server.bundles.size(), 1U);
    EXPECT_TRUE(match.server.bundles[0].report.empty());
}

TEST(LockstepDesync, AReportTooLargeIsNotTaken) {
    LockstepServerSettings settings = VirtualMatch::server_settings(1, 300);
    settings.report_size_bytes_max = 999;
    settings.report_timeout_ms = 3000;
    VirtualMatch match(settings);
    match.add_clients(1);
    match.clients[0]->corrupt_at = 100;
    ASSERT_TRUE(match.run_to_end());
    ASSERT_EQ(match.server.bundles.size(), 1U);
    EXPECT_TRUE(match.server.bundles[0].report.empty());
    EXPECT_GT(match.server.session.counters().violations.of(Violation::chunk_malformed), 0U);
}

TEST(LockstepDesync, IsFoundAfterAReconnectToo) {
    VirtualMatch match(VirtualMatch::server_settings(2, 600));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(100));
    match.clients[1]->alive = false;
    ASSERT_TRUE(match.run([&] { return match.server.count(SessionEventKind::dropped) == 1; }));
    ClientDriver& back = match.add_client(101);
    back.corrupt_at = 400;
    ASSERT_TRUE(match.run_to_end());
    ASSERT_EQ(match.server.session.desyncs().size(), 1U);
    EXPECT_EQ(match.server.session.desyncs()[0].bad_tick, 400U);
    EXPECT_EQ(match.server.session.desyncs()[0].agreed_tick, 399U);
}

TEST(LockstepDesync, WithheldHashesCostTheSlot) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 400);
    VirtualMatch match(settings);
    match.add_client(1);
    LockstepClientSettings cheat = VirtualMatch::client_settings(2);
    cheat.reconnect = false;
    match.add_client(cheat);
    ASSERT_TRUE(match.run_to_tick(100));
    match.clients[1]->sends_hashes = false;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.session.counters().drops, 1U);
    ASSERT_NE(match.server.find(SessionEventKind::dropped), nullptr);
    const SessionEvent& dropped = *match.server.find(SessionEventKind::dropped);
    EXPECT_EQ(dropped.slot, match.clients[1]->session.slot());
    EXPECT_EQ(dropped.text.find("no state hash since tick "), 0U);
    EXPECT_GE(dropped.tick, 100U + settings.hash_lag_ticks_max);
    EXPECT_LE(dropped.tick, 102U + settings.hash_lag_ticks_max);
    EXPECT_EQ(match.clients[1]->session.end_reason(), EndReason::dropped);
    match.expect_one_chain();
}

TEST(LockstepDesync, TheLastHashesCannotBeWithheldEither) {
    VirtualMatch match(VirtualMatch::server_settings(2, 200));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(150));
    match.clients[1]->sends_hashes = false;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.session.counters().drops, 1U);
}

TEST(LockstepDesync, AStopDoesNotWaitForAReportThatNeverComes) {
    VirtualMatch match(VirtualMatch::server_settings(2, 300));
    match.add_clients(2);
    match.clients[0]->corrupt_at = 100;
    ASSERT_TRUE(match.run([&] { return match.server.session.phase() == MatchPhase::halted; }));
    match.network.deaf.insert(match.clients[0]->peer); // never hears the query, but is there
    const std::uint64_t halted_us = match.now_us;
    match.server.session.stop("interrupted by the operator");
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::desync);
    EXPECT_EQ(match.server.bundles.size(), 1U);
    EXPECT_LE(match.now_us - halted_us, 3'100'000U); // settle_timeout_ms and close_timeout_ms
}

} // namespace
} // namespace lockwind::testing
