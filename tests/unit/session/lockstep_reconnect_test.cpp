#include "tests/unit/session/virtual_match.h"

namespace lockwind::testing {
namespace {

TEST(LockstepReconnect, ANewProcessGetsItsSlotBackAndTheSameChain) {
    for (const std::size_t padding : {std::size_t{0}, std::size_t{300'000}}) {
        VirtualMatch match(VirtualMatch::server_settings(2, 600));
        match.server.simulation.pad_snapshots(padding);
        match.add_clients(2);
        ASSERT_TRUE(match.run_to_tick(100));
        match.clients[1]->alive = false;
        ASSERT_TRUE(match.run([&] { return match.server.count(SessionEventKind::dropped) == 1; }));
        ASSERT_TRUE(match.run_to_tick(match.server.session.confirmed_tick() + 50));
        ClientDriver& back = match.add_client(101);
        ASSERT_TRUE(match.run_to_end());

        EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
        EXPECT_EQ(back.session.slot(), 1U);
        EXPECT_EQ(back.session.end_reason(), EndReason::complete);
        const LockstepServerCounters& counters = match.server.session.counters();
        EXPECT_EQ(counters.drops, 1U);
        EXPECT_EQ(counters.reconnects, 1U);
        EXPECT_EQ(counters.joins, 2U);
        EXPECT_EQ(match.server.snapshots, 1U);
        EXPECT_EQ(match.server.log.at(600)[1].status, InputStatus::confirmed);
        ASSERT_NE(match.server.find(SessionEventKind::reconnected), nullptr);
        const Tick live = match.server.find(SessionEventKind::reconnected)->tick;
        EXPECT_EQ(match.server.log.at(live - 1)[1].status, InputStatus::disconnected);
        EXPECT_EQ(match.server.log.at(live)[1].status, InputStatus::confirmed);
        EXPECT_GT(back.chain.begin()->first, 100U); // from the snapshot on
        EXPECT_EQ(back.chain.size(), 600U - back.chain.begin()->first + 1);
        match.expect_one_chain();
    }
}

TEST(LockstepReconnect, ALivePartOfThePartitionComesBackByItself) {
    Conditions conditions;
    conditions.latency_us = 30'000;
    conditions.jitter_us = 10'000;
    conditions.loss_per_mille = 50;
    VirtualMatch match(VirtualMatch::server_settings(2, 900), conditions);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(100));
    match.network.cut.insert(match.clients[1]->peer);
    match.run_for(4'000'000);
    match.network.cut.clear();
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.session.counters().reconnects, 1U);
    EXPECT_EQ(match.clients[1]->session.counters().reconnects, 1U);
    EXPECT_EQ(match.clients[1]->count(SessionEventKind::dropped), 1U);
    EXPECT_EQ(match.clients[1]->count(SessionEventKind::reconnected), 1U);
    EXPECT_EQ(match.server.log.at(900)[1].status, InputStatus::confirmed);
    EXPECT_EQ(match.server.session.counters().violations.total(), 0U);
    match.expect_one_chain();
}

TEST(LockstepReconnect, AClientThatTheServerDroppedIsToldAndComesBack) {
    // Its inputs stop but it goes on talking: only the server knows that it was dropped.
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 400);
    settings.stall_policy = StallPolicy::drop;
    VirtualMatch match(settings);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(60));
    match.clients[1]->gives_inputs = false;
    ASSERT_TRUE(match.run([&] { return match.server.count(SessionEventKind::dropped) == 1; }));
    match.clients[1]->gives_inputs = true;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.counters().reconnects, 1U);
    EXPECT_EQ(match.server.log.at(400)[1].status, InputStatus::confirmed);
    match.expect_one_chain();
}

TEST(LockstepReconnect, ADroppedClientThatDidNotHearSoIsToldAgain) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 400);
    settings.stall_policy = StallPolicy::drop;
    VirtualMatch match(settings);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(60));
    match.clients[1]->gives_inputs = false;
    match.network.deaf.insert(match.clients[1]->peer);
    ASSERT_TRUE(match.run([&] { return match.server.count(SessionEventKind::dropped) == 1; }));
    match.run_for(50'000);
    match.network.deaf.clear(); // it hears the others' confirmations, so it misses nothing
    match.clients[1]->gives_inputs = true;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.counters().reconnects, 1U);
    EXPECT_EQ(match.server.log.at(400)[1].status, InputStatus::confirmed);
    match.expect_one_chain();
}

TEST(LockstepReconnect, AClientThatHearsNothingConnectsAnewThoughItIsHeard) {
    VirtualMatch match(VirtualMatch::server_settings(2, 400));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(60));
    match.network.deaf.insert(match.clients[1]->peer);
    match.run_for(2'500'000);
    EXPECT_EQ(match.clients[1]->count(SessionEventKind::dropped), 1U);
    EXPECT_EQ(match.server.count(SessionEventKind::interrupted), 0U);
    match.network.deaf.clear();
    match.run_for(1'000'000); // the server need not miss it first
    EXPECT_EQ(match.clients[1]->session.phase(), ClientPhase::playing);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.session.counters().reconnects, 1U);
    EXPECT_EQ(match.server.log.at(400)[1].status, InputStatus::confirmed);
    match.expect_one_chain();
}

TEST(LockstepReconnect, NobodyIsWaitedForWhoseHashesAreFarBehind) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 500);
    settings.ready_timeout_ms = 3000;
    settings.hash_lag_ticks_max = 60;
    VirtualMatch match(settings);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(100));
    match.clients[1]->alive = false;
    ASSERT_TRUE(match.run([&] { return match.server.count(SessionEventKind::dropped) == 1; }));
    match.server.simulation.pad_snapshots(10 * kChunkSizeBytesMax - 100);
    LockstepClientSettings secretive = VirtualMatch::client_settings(101);
    secretive.reconnect = false;
    ClientDriver& back = match.add_client(secretive);
    back.sends_hashes = false;
    match.network.extra_latency_us[back.peer] = 100'000;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_FALSE(back.inputs_given.empty()); // it had caught up
    EXPECT_EQ(match.server.session.counters().reconnects, 0U);
    EXPECT_EQ(match.server.session.counters().drops, 2U);
    EXPECT_EQ(back.session.end_reason(), EndReason::dropped);
    EXPECT_EQ(back.session.end_message(), "not ready within 3000 ms");
    match.expect_one_chain();
}

TEST(LockstepReconnect, SurvivesManyDropsUnderLoss) {
    Conditions conditions;
    conditions.latency_us = 20'000;
    conditions.jitter_us = 20'000;
    conditions.loss_per_mille = 80;
    conditions.duplicate_per_mille = 50;
    conditions.reliable_loss_per_mille = 80;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        SCOPED_TRACE(seed);
        LockstepServerSettings settings = VirtualMatch::server_settings(3, 1500);
        VirtualMatch match(settings, conditions, seed);
        match.server.simulation.pad_snapshots(200'000);
        match.add_clients(3);
        Dice dice(seed);
        while (match.server.session.confirmed_tick() < 1100) {
            const PeerId victim = match.clients[static_cast<std::size_t>(dice.below(3))]->peer;
            ASSERT_TRUE(
                match.run_to_tick(match.server.session.confirmed_tick() + 50 + dice.below(100)));
            match.network.cut.insert(victim);
            match.run_for(dice.below(4'000'000));
            match.network.cut.clear();
        }
        ASSERT_TRUE(match.run_to_end());
        EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
        EXPECT_GT(match.server.session.counters().reconnects, 1U);
        EXPECT_EQ(match.server.session.counters().desyncs, 0U);
        EXPECT_EQ(match.server.session.counters().violations.total(), 0U);
        match.expect_one_chain();
    }
}

TEST(LockstepReconnect, CatchesUpInPiecesAfterALongAbsence) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 1500);
    settings.catch_up_size_bytes = 2000; // about 80 ticks a piece
    VirtualMatch match(settings);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(100));
    match.clients[1]->alive = false;
    ASSERT_TRUE(match.run_to_tick(400));
    // 10 chunks, 2 a round trip of 600 ms: the match goes on for hundreds of ticks meanwhile.
    match.server.simulation.pad_snapshots(10 * kChunkSizeBytesMax - 100);
    ClientDriver& back = match.add_client(101);
    match.network.extra_latency_us[back.peer] = 300'000;
    ASSERT_TRUE(match.run([&] { return match.server.snapshots == 1; }));
    match.server.simulation.pad_snapshots(0);
    ASSERT_TRUE(match.run([&] { return back.session.phase() == ClientPhase::playing; }));
    const Tick backlog = match.server.session.confirmed_tick() - back.session.advanced_tick();
    EXPECT_GT(backlog, 150U);
    const Tick confirmed = match.server.session.confirmed_tick();
    ASSERT_TRUE(match.run_to_end());
    // Inputs of ticks that it knew to be confirmed would have come too late.
    ASSERT_FALSE(back.inputs_given.empty());
    EXPECT_GT(back.inputs_given.begin()->first, confirmed - 50);
    EXPECT_EQ(match.server.session.counters().reconnects, 1U);
    EXPECT_EQ(match.server.log.at(1500)[1].status, InputStatus::confirmed);
    match.expect_one_chain();
}

TEST(LockstepReconnect, WhoLeavesFreesTheSlotForAnotherPlayer) {
    VirtualMatch match(VirtualMatch::server_settings(2, 400));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(100));
    match.clients[0]->session.leave();
    ASSERT_TRUE(match.run_to_tick(150));
    ClientDriver& other = match.add_client(999);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.clients[0]->session.end_reason(), EndReason::left);
    EXPECT_EQ(match.server.count(SessionEventKind::left), 1U);
    EXPECT_EQ(other.session.slot(), 0U);
    EXPECT_EQ(match.server.session.counters().joins, 3U);
    EXPECT_EQ(match.server.session.counters().drops, 0U);
    EXPECT_EQ(match.server.log.at(140)[0].status, InputStatus::disconnected);
    EXPECT_EQ(match.server.log.at(400)[0].status, InputStatus::confirmed);
    match.expect_one_chain();
}

TEST(LockstepReconnect, ADroppedPlayersSlotIsKeptForHisToken) {
    VirtualMatch match(VirtualMatch::server_settings(2, 300));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(50));
    match.clients[1]->alive = false;
    ASSERT_TRUE(match.run([&] { return match.server.count(SessionEventKind::dropped) == 1; }));
    ClientDriver& stranger = match.add_client(999);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_TRUE(stranger.session.refused());
    EXPECT_EQ(stranger.session.end_message(), "all 2 slots of the match are taken");
    EXPECT_TRUE(stranger.chain.empty());
}

TEST(LockstepReconnect, ALivePlayersTokenIsInUseUntilHeFallsSilent) {
    VirtualMatch match(VirtualMatch::server_settings(1, 400));
    match.add_client(7);
    ASSERT_TRUE(match.run_to_tick(50));
    ClientDriver& twin = match.add_client(7);
    match.run_for(1'000'000);
    EXPECT_EQ(twin.session.phase(), ClientPhase::greeting);
    EXPECT_EQ(match.server.session.counters().drops, 0U);
    match.clients[0]->alive = false; // killed; the new process need not wait for the drop timeout
    match.run_for(1'200'000);
    EXPECT_EQ(twin.session.phase(), ClientPhase::playing);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.counters().reconnects, 1U);
    EXPECT_EQ(match.server.log.at(400)[0].status, InputStatus::confirmed);
    match.expect_one_chain();
}

TEST(LockstepReconnect, AJoinerMayComeInTheMiddle) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 400);
    settings.join_timeout_ms = 1000;
    VirtualMatch match(settings);
    match.add_client(1);
    ASSERT_TRUE(match.run_to_tick(100));
    ClientDriver& late = match.add_client(2);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(late.session.slot(), 1U);
    EXPECT_EQ(match.server.session.counters().joins, 2U);
    EXPECT_EQ(match.server.session.counters().reconnects, 0U);
    EXPECT_EQ(match.server.log.at(400)[1].status, InputStatus::confirmed);
    match.expect_one_chain();
}

TEST(LockstepReconnect, AJoinerWhoWasCutOffGetsAnotherSlotAndItsSnapshot) {
    LockstepServerSettings settings = VirtualMatch::server_settings(3, 900);
    settings.join_timeout_ms = 1000;
    VirtualMatch match(settings);
    match.add_client(1);
    ASSERT_TRUE(match.run_to_tick(100));
    ClientDriver& unlucky = match.add_client(2);
    ASSERT_TRUE(match.run([&] { return match.server.count(SessionEventKind::synchronized) == 2; }));
    ASSERT_EQ(unlucky.session.slot(), 1U);
    match.network.cut.insert(unlucky.peer);
    ASSERT_TRUE(match.run([&] { return match.server.count(SessionEventKind::dropped) == 1; }));
    ClientDriver& other = match.add_client(3);
    ASSERT_TRUE(match.run([&] { return other.session.phase() == ClientPhase::playing; }));
    match.network.cut.clear();
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.snapshots, 3U);
    EXPECT_EQ(other.session.slot(), 1U); // who never played has no claim to it
    EXPECT_EQ(unlucky.session.slot(), 2U);
    EXPECT_EQ(unlucky.session.advanced_tick(), 900U);
    match.expect_one_chain();
}

TEST(LockstepReconnect, AnotherWorldIsRefusedNamingItsHash) {
    VirtualMatch match(VirtualMatch::server_settings(2, 60));
    match.add_client(1);
    ClientDriver& stray = match.add_client(2);
    stray.builds_another_world = true;
    ASSERT_TRUE(match.run([&] { return stray.session.ended(); }));
    EXPECT_TRUE(stray.session.refused());
    EXPECT_NE(stray.session.end_message().find("state of tick 0"), std::string::npos);
    EXPECT_EQ(match.server.session.counters().violations.of(Violation::bad_state_hash), 1U);
    EXPECT_EQ(match.server.session.slot_status(1).state, SlotState::empty);
    match.add_client(3); // the slot is free
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.session.counters().joins, 2U);
}

TEST(LockstepReconnect, AnotherVersionIsRefusedNamingBoth) {
    VirtualMatch match(VirtualMatch::server_settings(1, 60));
    LockstepClientSettings settings = VirtualMatch::client_settings(5);
    settings.sim_version = "v2";
    ClientDriver& stray = match.add_client(settings);
    ASSERT_TRUE(match.run([&] { return stray.session.ended(); }));
    EXPECT_TRUE(stray.session.refused());
    EXPECT_NE(stray.session.end_message().find("v1"), std::string::npos);
    EXPECT_NE(stray.session.end_message().find("v2"), std::string::npos);
}

TEST(LockstepReconnect, AClientWithoutAServerGivesUp) {
    VirtualMatch match(VirtualMatch::server_settings(1, 60));
    ClientDriver& lonely = match.add_client(5);
    match.network.cut.insert(lonely.peer);
    ASSERT_TRUE(match.run([&] { return lonely.session.ended(); }, 31'000'000));
    EXPECT_EQ(lonely.session.end_reason(), EndReason::failed);
    EXPECT_NE(lonely.session.end_message().find("30000 ms"), std::string::npos);
    EXPECT_GT(match.network.lost, 50U); // it asked again and again
}

TEST(LockstepReconnect, WithoutALengthTheMatchWaitsForADroppedPlayerAWhile) {
    VirtualMatch match(VirtualMatch::server_settings(1, 0));
    match.add_client(5);
    ASSERT_TRUE(match.run_to_tick(60));
    match.clients[0]->alive = false;
    const std::uint64_t killed_us = match.now_us;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_message(), "no dropped player came back");
    EXPECT_GE(match.now_us - killed_us, 12'000'000U);
    EXPECT_LE(match.now_us - killed_us, 12'200'000U);
    match.expect_one_chain();
}

} // namespace
} // namespace lockwind::testing
