#include "tests/unit/session/virtual_match.h"

namespace lockwind::testing {
namespace {

LockstepServerSettings settings_with(StallPolicy policy, Tick ticks) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, ticks);
    settings.stall_policy = policy;
    return settings;
}

TEST(LockstepStall, PauseHoldsTheClockAndRebasesIt) {
    VirtualMatch match(settings_with(StallPolicy::pause, 200));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(60));
    match.clients[1]->gives_inputs = false;
    match.run_for(1'500'000);
    const Tick held_at = match.server.session.confirmed_tick();
    EXPECT_LT(held_at, 70U);
    match.clients[1]->gives_inputs = true;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);

    const LockstepServerCounters& counters = match.server.session.counters();
    EXPECT_EQ(counters.stalls, 1U);
    EXPECT_GE(counters.stall_ms_max, 1300U);
    EXPECT_EQ(counters.tick_lateness_us.max(), 0U); // the pause moved all that followed
    EXPECT_EQ(counters.substituted_inputs, 0U);
    EXPECT_EQ(match.server.count(SessionEventKind::paused), 1U);
    EXPECT_EQ(match.server.count(SessionEventKind::unpaused), 1U);
    ASSERT_EQ(match.server.count(SessionEventKind::stalled), 1U);
    EXPECT_EQ(match.server.find(SessionEventKind::stalled)->slot, 1U);
    EXPECT_EQ(match.server.find(SessionEventKind::stalled)->tick, held_at + 1);
    EXPECT_GE(match.clients[0]->session.counters().stalls, 1U);
    EXPECT_GE(match.clients[0]->session.counters().stall_ms_max, 1300U);
    match.expect_one_chain();
}

TEST(LockstepStall, AShortStallIsCaughtUpWithoutAPause) {
    VirtualMatch match(settings_with(StallPolicy::pause, 200));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(60));
    match.clients[1]->gives_inputs = false;
    match.run_for(200'000);
    match.clients[1]->gives_inputs = true;
    ASSERT_TRUE(match.run_to_end());
    const LockstepServerCounters& counters = match.server.session.counters();
    EXPECT_EQ(counters.stalls, 1U); // catching up is no other
    EXPECT_EQ(match.server.count(SessionEventKind::paused), 0U);
    EXPECT_GT(counters.tick_lateness_us.max(), 100'000U);
    EXPECT_EQ(counters.tick_lateness_us.quantile(500), 0U); // on time again
    match.expect_one_chain();
}

TEST(LockstepStall, SubstituteRepeatsTheLastInputUntilTheSlotIsInTime) {
    VirtualMatch match(settings_with(StallPolicy::substitute, 300));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(60));
    match.clients[1]->gives_inputs = false;
    ASSERT_TRUE(match.run_to_tick(160));
    match.clients[1]->gives_inputs = true;
    ASSERT_TRUE(match.run_to_tick(200));
    match.clients[1]->gives_inputs = false; // who was in time again is waited for again
    ASSERT_TRUE(match.run_to_tick(250));
    match.clients[1]->gives_inputs = true;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);

    const LockstepServerCounters& counters = match.server.session.counters();
    EXPECT_GE(counters.substituted_inputs, 90U);
    EXPECT_EQ(counters.stalls, 2U); // who lags is not waited for
    EXPECT_EQ(match.server.count(SessionEventKind::stalled), 2U);
    std::uint64_t substituted = 0;
    for (const auto& [tick, inputs] : match.server.log) {
        EXPECT_EQ(inputs[0].status, InputStatus::confirmed);
        if (inputs[1].status == InputStatus::substituted) {
            EXPECT_EQ(inputs[1].bytes, match.server.log.at(tick - 1)[1].bytes);
            ++substituted;
        }
    }
    EXPECT_EQ(substituted, counters.substituted_inputs);
    EXPECT_EQ(match.server.log.at(300)[1].status, InputStatus::confirmed);
    EXPECT_EQ(counters.drops, 0U);
    match.expect_one_chain();
}

TEST(LockstepStall, InputsBehindTheirSubstituteAreCountedLate) {
    VirtualMatch match(settings_with(StallPolicy::substitute, 300));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(60));
    match.network.conditions.latency_us = 400'000; // sent in time, as far as the clients knew
    ASSERT_TRUE(match.run_to_end());
    const LockstepServerCounters& counters = match.server.session.counters();
    EXPECT_GT(counters.late_inputs, 0U);
    EXPECT_GT(counters.substituted_inputs, 0U);
    EXPECT_LE(counters.late_inputs, counters.substituted_inputs);
    match.expect_one_chain();
}

TEST(LockstepStall, DropGoesOnWithoutTheSlot) {
    VirtualMatch match(settings_with(StallPolicy::drop, 200));
    match.add_client(100);
    LockstepClientSettings sleeper = VirtualMatch::client_settings(101);
    sleeper.reconnect = false;
    match.add_client(sleeper);
    ASSERT_TRUE(match.run_to_tick(60));
    match.clients[1]->gives_inputs = false;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.session.counters().drops, 1U);
    EXPECT_EQ(match.clients[1]->session.end_reason(), EndReason::dropped);
    EXPECT_EQ(match.server.log.at(200)[1].status, InputStatus::disconnected);
    EXPECT_EQ(match.server.log.at(200)[1].bytes, SlotInput{}.bytes);
    EXPECT_EQ(match.server.log.at(200)[0].status, InputStatus::confirmed);
    match.expect_one_chain();
}

TEST(LockstepStall, ASilentPlayerIsInterruptedThenDroppedWhateverThePolicy) {
    for (const StallPolicy policy :
         {StallPolicy::pause, StallPolicy::substitute, StallPolicy::drop}) {
        VirtualMatch match(settings_with(policy, 400));
        match.add_clients(2);
        ASSERT_TRUE(match.run_to_tick(60));
        match.clients[1]->alive = false;
        ASSERT_TRUE(match.run_to_end());
        EXPECT_EQ(match.server.session.counters().drops, 1U);
        EXPECT_EQ(match.server.count(SessionEventKind::dropped), 1U);
        EXPECT_EQ(match.server.count(SessionEventKind::interrupted),
                  policy == StallPolicy::drop ? 0U : 1U);
        EXPECT_EQ(match.server.log.at(400)[1].status, InputStatus::disconnected);
        match.expect_one_chain();
    }
}

TEST(LockstepStall, AShortSilenceIsInterruptedAndResumed) {
    VirtualMatch match(settings_with(StallPolicy::pause, 200));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(60));
    match.network.cut.insert(match.clients[1]->peer);
    match.run_for(1'000'000);
    match.network.cut.clear();
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.count(SessionEventKind::interrupted), 1U);
    EXPECT_EQ(match.server.count(SessionEventKind::resumed), 1U);
    EXPECT_EQ(match.clients[1]->count(SessionEventKind::interrupted), 1U);
    EXPECT_EQ(match.clients[1]->count(SessionEventKind::resumed), 1U);
    EXPECT_EQ(match.server.session.counters().drops, 0U);
    EXPECT_EQ(match.server.session.counters().reconnects, 0U);
    match.expect_one_chain();
}

TEST(LockstepStall, ASlowClientSlowsTheMatchInsteadOfFallingBehind) {
    VirtualMatch match(settings_with(StallPolicy::pause, 200));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(20));
    // Client 1 runs only every 50 ms: about 3 ticks of time for each that it steps.
    Tick behind_max = 0;
    for (int i = 0; i < 40; ++i) {
        match.clients[1]->alive = false;
        match.run_for(50'000);
        match.clients[1]->alive = true;
        match.run_for(1'000);
        behind_max = std::max(behind_max,
                              match.server.session.confirmed_tick() -
                                  match.clients[1]->session.advanced_tick());
    }
    EXPECT_LE(behind_max, 8U);
    EXPECT_GT(match.server.session.counters().stalls, 0U);
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.counters().drops, 0U);
    match.expect_one_chain();
}

TEST(LockstepStall, AStoppedServerGoesOnWhereItWas) {
    VirtualMatch match(VirtualMatch::server_settings(2, 300));
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(100));
    const Tick before = match.server.session.confirmed_tick();
    // The process is stopped; its players miss it, and ask for their slots again and again.
    match.server_stopped = true;
    match.run_for(10'000'000);
    match.server_stopped = false;
    const std::uint64_t resumed_us = match.now_us;
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    // Ticks are played in their time: none of those ten seconds is made up for.
    EXPECT_GE(match.now_us - resumed_us, (300 - before - 2) * 1'000'000 / 60);
    ASSERT_NE(match.server.find(SessionEventKind::unpaused), nullptr);
    EXPECT_GE(match.server.find(SessionEventKind::unpaused)->duration_us, 9'900'000U);
    for (const auto& client : match.clients) {
        EXPECT_EQ(client->session.end_reason(), EndReason::complete);
        // It plays again soon.
        EXPECT_GE(client->chain.size(), 300U - 20U);
    }
    match.expect_one_chain();
}

TEST(LockstepStall, AnHonestPlayerIsNeverBannedHoweverLateHisMessages) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 4000);
    settings.config.tick_rate_hz = 240;
    Conditions conditions;
    conditions.duplicate_per_mille = 200;
    VirtualMatch match(settings, conditions);
    match.add_clients(2);
    match.network.extra_latency_us[match.clients[1]->peer] = 300'000;
    match.network.conditions.jitter_us = 600'000; // 144 ticks: more than the window
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    const ViolationCounts& violations = match.server.session.counters().violations;
    EXPECT_GT(violations.of(Violation::input_too_old), 64U);
    EXPECT_EQ(violations.offences(), 0U);
    for (const auto& client : match.clients) {
        EXPECT_FALSE(client->session.refused()) << client->session.end_message();
    }
}

} // namespace
} // namespace lockwind::testing
