#include "tests/unit/session/virtual_match.h"

namespace lockwind::testing {
namespace {

/// Two honest players; messages are injected in their or a stranger's name while they play.
class LockstepHostile : public ::testing::Test {
protected:
    LockstepHostile() : match(VirtualMatch::server_settings(2, 200)) {
        match.add_clients(2);
        match.clients[1]->keeps_sent = true;
        EXPECT_TRUE(match.run_to_tick(100));
        peer = match.clients[1]->peer;
        slot = match.clients[1]->session.slot();
        other_slot = match.clients[0]->session.slot();
        confirmed = match.server.session.confirmed_tick();
    }

    std::uint64_t counted(Violation violation) const {
        return match.server.session.counters().violations.of(violation);
    }

    InputBatch batch(Tick first_tick, std::size_t count, std::uint8_t byte = 0) const {
        InputBatch batch;
        batch.slot = slot;
        batch.first_tick = first_tick;
        batch.inputs.resize(count);
        for (SlotInput& input : batch.inputs) {
            input.bytes[0] = byte;
        }
        return batch;
    }

    /// Whatever happened, the match is played to its end in one chain.
    void expect_honest_end() {
        ASSERT_TRUE(match.run_to_end());
        EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
        EXPECT_EQ(match.server.log.size(), 200U);
        EXPECT_EQ(match.server.session.counters().hashes_agreed, 400U);
        EXPECT_EQ(match.server.session.counters().drops, 0U);
        for (const auto& client : match.clients) {
            for (const auto& [tick, inputs] : match.server.log) {
                EXPECT_EQ(inputs[client->session.slot()].bytes,
                          client->inputs_given.at(tick).bytes);
            }
        }
        match.expect_one_chain();
    }

    VirtualMatch match;
    PeerId peer = 0;
    Slot slot = 0;
    Slot other_slot = 0;
    Tick confirmed = 0;
};

TEST_F(LockstepHostile, NobodySpeaksForAnotherSlot) {
    InputBatch inputs = batch(confirmed + 5, 3, 9);
    inputs.slot = other_slot;
    match.inject(peer, inputs);
    HashReport report;
    report.slot = other_slot;
    report.entries = {{confirmed, 1}};
    match.inject(peer, report);
    inputs.slot = 77;
    match.inject(peer, inputs);
    expect_honest_end();
    EXPECT_EQ(counted(Violation::wrong_slot), 3U);
}

TEST_F(LockstepHostile, ReplayedMessagesChangeNothing) {
    std::size_t replayed = 0;
    for (const Message& message : match.clients[1]->sent) {
        if (!std::holds_alternative<End>(message)) {
            match.inject(peer, message);
            ++replayed;
        }
    }
    EXPECT_GT(replayed, 100U);
    expect_honest_end();
    EXPECT_EQ(match.server.session.counters().late_inputs, 0U);
    EXPECT_EQ(match.server.session.counters().joins, 2U);
}

TEST_F(LockstepHostile, TheFirstInputOfATickStays) {
    // Far enough ahead that it comes before the player's own: then his own is the changed one.
    const Tick tick = confirmed - 2;
    match.inject(peer, batch(tick, 2, 0xee));
    expect_honest_end();
    EXPECT_EQ(counted(Violation::input_changed), 1U);
}

TEST_F(LockstepHostile, InputsOutsideTheWindowAreRefused) {
    match.inject(peer, batch(confirmed + 500, 1));
    EXPECT_TRUE(match.run_to_tick(confirmed + 5));
    EXPECT_EQ(counted(Violation::input_too_new), 1U);
    match.inject(peer, batch(~Tick{0}, 1));
    match.inject(peer, batch(Tick{1} << 63U, 100));
    EXPECT_TRUE(match.run_to_tick(confirmed + 10));
    EXPECT_EQ(counted(Violation::input_too_new), 3U);
    match.inject(peer, batch(0, 1));
    EXPECT_TRUE(match.run_to_tick(confirmed + 15));
    EXPECT_EQ(counted(Violation::input_too_old), 1U);
    EXPECT_TRUE(match.run_to_tick(150));
    match.inject(peer, batch(1, 2));
    expect_honest_end();
    EXPECT_EQ(counted(Violation::input_too_old), 2U);
}

TEST_F(LockstepHostile, MalformedInputsAreRefused) {
    InputBatch inputs = batch(confirmed + 60, 1);
    inputs.inputs[0].bytes[CounterSimulation::kInputSizeBytes] = 1;
    match.inject(peer, inputs);
    match.inject(peer, batch(confirmed + 60, kInputBatchTicksMax + 1));
    expect_honest_end();
    EXPECT_EQ(counted(Violation::input_malformed), 2U);
}

TEST_F(LockstepHostile, EmptyBatchesAreOnlyHeard) {
    for (int i = 0; i < 100; ++i) {
        match.inject(peer, batch(~Tick{0}, 0));
    }
    expect_honest_end();
    EXPECT_EQ(match.server.session.counters().violations.total(), 0U);
}

TEST_F(LockstepHostile, AcknowledgingTheFutureIsRefused) {
    InputBatch inputs = batch(confirmed + 60, 0);
    inputs.confirmed_tick = confirmed + 50;
    match.inject(peer, inputs);
    inputs.confirmed_tick = ~Tick{0};
    match.inject(peer, inputs);
    expect_honest_end();
    EXPECT_EQ(counted(Violation::ack_unconfirmed), 2U);
}

TEST_F(LockstepHostile, HashesOfTheFutureAreRefusedAndNoDesync) {
    HashReport report;
    report.slot = slot;
    report.entries = {{confirmed + 50, 1}};
    match.inject(peer, report);
    report.entries = {{~Tick{0}, 1}};
    match.inject(peer, report);
    expect_honest_end();
    EXPECT_EQ(counted(Violation::hash_unconfirmed), 2U);
    EXPECT_EQ(match.server.session.counters().desyncs, 0U);
}

TEST_F(LockstepHostile, MalformedHashReportsAreRefused) {
    HashReport report;
    report.slot = slot;
    report.entries = {{5, 1}, {5, 2}};
    match.inject(peer, report);
    report.entries = {{0, 1}};
    match.inject(peer, report);
    report.entries.assign(kHashReportEntriesMax + 1, {1, 1});
    match.inject(peer, report);
    expect_honest_end();
    EXPECT_EQ(counted(Violation::hash_malformed), 3U);
}

TEST_F(LockstepHostile, HashesOfLongAgreedTicksAreNotLookedAt) {
    HashReport report;
    report.slot = slot;
    report.entries = {{5, 12345}};
    match.inject(peer, report);
    expect_honest_end();
    EXPECT_EQ(match.server.session.counters().violations.total(), 0U);
    EXPECT_EQ(match.server.session.counters().desyncs, 0U);
}

TEST_F(LockstepHostile, StrangersAreNotListenedTo) {
    match.inject(4711, batch(confirmed + 60, 1));
    match.inject(4711, Ready{0, 0});
    match.inject(4711, End{EndReason::left, 0, 1, ""});
    match.inject(kAllPeers, Hello{kProtocolVersion, "v1", "", 5, 1});
    match.inject(kServerPeer, Hello{kProtocolVersion, "v1", "", 5, 1});
    expect_honest_end();
    EXPECT_EQ(counted(Violation::unknown_peer), 5U);
}

TEST_F(LockstepHostile, UnsolicitedChunksAreNotTaken) {
    Chunk chunk;
    chunk.kind = BlobKind::desync_report;
    chunk.transfer = 1;
    chunk.count = chunk_count(kBlobSizeBytesMax);
    chunk.blob_size_bytes = kBlobSizeBytesMax;
    chunk.bytes.resize(kChunkSizeBytesMax);
    match.inject(peer, chunk);
    chunk.kind = BlobKind::snapshot;
    match.inject(peer, chunk);
    match.inject(peer, ChunkAck{1, 0});
    match.inject(peer, ChunkAck{0xffffffff, 0xffffffff});
    expect_honest_end();
    EXPECT_EQ(counted(Violation::chunk_unsolicited), 2U);
}

TEST_F(LockstepHostile, TheServersOwnMessagesAreNoClients) {
    match.inject(peer, Welcome{});
    match.inject(peer, Refuse{});
    match.inject(peer, Confirmation{});
    match.inject(peer, DesyncQuery{});
    expect_honest_end();
    EXPECT_EQ(counted(Violation::unexpected_message), 4U);
}

TEST_F(LockstepHostile, RepeatedAndBadHellosDisturbNobody) {
    match.inject(peer, Hello{kProtocolVersion, "v1", "", 101, 1});   // doubled
    match.inject(4711, Hello{kProtocolVersion, "v1", "", 101, 1});   // another's token
    match.inject(4711, Hello{kProtocolVersion, "v1", "", 5, 1});     // full
    match.inject(4711, Hello{kProtocolVersion + 1, "v1", "", 5, 1}); // version
    match.inject(4711, Hello{kProtocolVersion, "v0", "", 5, 1});     // version
    match.inject(4711, Hello{kProtocolVersion, "v1", "", 0, 1});     // token
    expect_honest_end();
    EXPECT_EQ(counted(Violation::bad_hello), 3U);
    EXPECT_EQ(match.server.session.counters().joins, 2U);
    EXPECT_EQ(match.server.session.counters().reconnects, 0U);
}

TEST(LockstepHostileServer, ClientsIgnoreWhatNoServerSays) {
    LockstepServerSettings settings = VirtualMatch::server_settings(2, 200);
    VirtualMatch match(settings);
    match.add_clients(2);
    ASSERT_TRUE(match.run_to_tick(100));
    LockstepClient& client = match.clients[0]->session;
    const auto tell = [&](PeerId from, const Message& message) {
        client.receive(from, message, match.now_us);
    };
    Confirmation confirmation;
    confirmation.acks.resize(2);
    confirmation.acks[0].attached = confirmation.acks[1].attached = true;
    confirmation.confirmed_tick = match.server.session.confirmed_tick();
    confirmation.first_tick = client.confirmed_tick();
    confirmation.ticks.resize(1);
    tell(0, confirmation); // a tick without inputs
    confirmation.ticks[0].inputs.resize(2);
    confirmation.ticks[0].inputs[0].bytes[0] = 0x77;
    tell(0, confirmation); // other inputs for a confirmed tick
    confirmation.first_tick = ~Tick{0};
    tell(0, confirmation);
    confirmation.first_tick = 0;
    tell(0, confirmation);
    confirmation.acks.resize(1);
    tell(0, confirmation);
    confirmation.acks.resize(2);
    confirmation.ticks.clear();
    confirmation.confirmed_tick = ~Tick{0};
    tell(0, confirmation);
    EXPECT_EQ(client.counters().violations.of(Violation::confirmation_malformed), 5U);
    EXPECT_EQ(client.counters().violations.of(Violation::confirmation_changed), 1U);
    tell(match.clients[1]->peer, End{EndReason::complete, 0, 0, ""});
    EXPECT_EQ(client.counters().violations.of(Violation::unknown_peer), 1U);
    tell(0, DesyncQuery{5, ~Tick{0}, 0, 0});
    tell(0, DesyncQuery{50, 50, 0, 0});
    tell(0, Hello{});
    EXPECT_EQ(client.counters().violations.of(Violation::unexpected_message), 3U);
    tell(0, Welcome{});
    tell(0, Refuse{});
    Chunk chunk; // no snapshot was promised
    chunk.transfer = 1;
    chunk.count = 1;
    tell(0, chunk);
    for (const Request& request : client.take_requests()) {
        const auto* send = std::get_if<SendRequest>(&request);
        EXPECT_TRUE(send == nullptr || !std::holds_alternative<ChunkAck>(send->message));
    }
    tell(0, End{EndReason::dropped, 0, 99, "of another connection"});
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.session.counters().hashes_agreed, 400U);
    EXPECT_EQ(client.counters().reconnects, 0U);
}

TEST_F(LockstepHostile, AFloodOfHellosSeatsAtMostOneAnew) {
    for (std::uint32_t attempt = 2; attempt < 102; ++attempt) {
        match.inject(peer, Hello{kProtocolVersion, "v1", "", 101, attempt});
    }
    ASSERT_TRUE(match.run_to_end());
    EXPECT_EQ(counted(Violation::hello_flood), 99U);
    EXPECT_EQ(match.server.session.counters().drops, 1U);
    EXPECT_EQ(match.server.snapshots, 1U);
    EXPECT_EQ(match.server.session.counters().reconnects, 1U); // the honest player's
    EXPECT_EQ(match.server.session.end_reason(), EndReason::complete);
    EXPECT_EQ(match.server.log.size(), 200U);
}

/// Who breaks the rules again and again loses the slot for good; the others play on.
class LockstepMisconduct : public LockstepHostile {
protected:
    void expect_banned(Violation violation, std::uint64_t count_min) {
        ASSERT_TRUE(match.run_to_end());
        const LockstepServer& server = match.server.session;
        EXPECT_GE(counted(violation), count_min);
        EXPECT_EQ(server.slot_status(slot).state, SlotState::left); // free for others
        EXPECT_EQ(server.counters().drops, 1U);
        EXPECT_EQ(server.counters().reconnects, 0U);
        EXPECT_EQ(server.end_reason(), EndReason::complete);
        EXPECT_EQ(match.server.log.size(), 200U);
        EXPECT_EQ(match.clients[1]->session.end_reason(), EndReason::failed);
        EXPECT_TRUE(match.clients[1]->session.refused());
        EXPECT_EQ(match.clients[1]->session.end_message(),
                  "this player broke the protocol again and again and has no place any more");
        EXPECT_EQ(match.clients[0]->session.end_reason(), EndReason::complete);
        EXPECT_EQ(match.clients[0]->chain.at(200), match.server.chain.at(200));
    }
};

TEST_F(LockstepMisconduct, SpeakingForAnotherSlot) {
    InputBatch inputs = batch(confirmed + 5, 3, 9);
    inputs.slot = other_slot;
    for (int i = 0; i < 65; ++i) {
        match.inject(peer, inputs);
    }
    expect_banned(Violation::wrong_slot, 65);
    for (const auto& [tick, played] : match.server.log) {
        EXPECT_EQ(played[other_slot].bytes, match.clients[0]->inputs_given.at(tick).bytes);
    }
}

TEST_F(LockstepMisconduct, FloodsOfValidMessages) {
    const std::vector<Message>& sent = match.clients[1]->sent;
    const auto repeated = std::find_if(sent.rbegin(), sent.rend(), [](const Message& message) {
        return std::holds_alternative<InputBatch>(message);
    });
    ASSERT_NE(repeated, sent.rend());
    for (int i = 0; i < 6000; ++i) {
        match.inject(peer, *repeated);
    }
    expect_banned(Violation::message_flood, 65);
}

TEST_F(LockstepMisconduct, BytesThatAreNoMessage) {
    for (int i = 0; i < 65; ++i) {
        match.server.session.receive_undecodable(peer, match.now_us);
    }
    match.server.session.receive_undecodable(4711, match.now_us); // who sits nowhere costs nobody
    expect_banned(Violation::undecodable, 66);
}

TEST(LockstepHostileServer, NobodyKeepsOthersOutOfFreeSlots) {
    LockstepServer server(VirtualMatch::server_settings(2, 200));
    std::uint64_t token = 1000;
    int attacker_welcomes = 0;
    bool honest_welcome = false;
    for (std::uint64_t now_us = 1000; now_us < 3'000'000; now_us += 1000) {
        server.update(now_us);
        server.receive(6, Hello{kProtocolVersion, "v1", "", token, 1}, now_us);
        if (now_us % 250'000 == 0) {
            server.receive(5, Hello{kProtocolVersion, "v1", "", 7, 1}, now_us);
        }
        for (const Request& request : server.take_requests()) {
            const auto* send = std::get_if<SendRequest>(&request);
            if (send != nullptr && std::holds_alternative<Welcome>(send->message)) {
                honest_welcome = honest_welcome || send->to == 5;
                attacker_welcomes += send->to == 6 ? 1 : 0;
                if (send->to == 6) { // takes a seat, leaves, asks for the next one
                    server.receive(6, End{EndReason::left, 0, 1, ""}, now_us);
                    ++token;
                }
            }
        }
    }
    EXPECT_TRUE(honest_welcome);
    EXPECT_GE(attacker_welcomes, 2);
    EXPECT_LE(attacker_welcomes, 7); // one each 500 ms
}

TEST_F(LockstepHostile, AskingAgainAndAgainForAWelcomeGivesFewOfThem) {
    VirtualMatch gathering(VirtualMatch::server_settings(2, 200));
    LockstepServer& server = gathering.server.session;
    int welcomes = 0;
    for (std::uint64_t now_us = 1; now_us < 1'000'000; now_us += 1000) {
        server.update(now_us);
        server.receive(5, Hello{kProtocolVersion, "v1", "", 101, 1}, now_us);
        for (const Request& request : server.take_requests()) {
            const auto* send = std::get_if<SendRequest>(&request);
            welcomes += send != nullptr && std::holds_alternative<Welcome>(send->message) ? 1 : 0;
        }
    }
    EXPECT_GE(welcomes, 4); // who asks each 250 ms is answered each time
    EXPECT_LE(welcomes, 10);
}

TEST(LockstepHostileServer, AnImpossibleMatchIsLeft) {
    const auto ends_with = [](const Welcome& welcome) {
        LockstepClient client(VirtualMatch::client_settings(1));
        client.update(1);
        client.receive(kServerPeer, welcome, 2);
        EXPECT_TRUE(client.ended());
        EXPECT_EQ(client.end_reason(), EndReason::failed);
        return client.end_message();
    };
    Welcome welcome;
    welcome.sim_version = "v1";
    welcome.config = VirtualMatch::server_settings(2, 10).config;
    welcome.slot = 2;
    EXPECT_EQ(ends_with(welcome), "the server's Welcome names no slot of the match");
    welcome.slot = 0;
    welcome.config.tick_rate_hz = 0;
    EXPECT_EQ(ends_with(welcome), "match config: tick_rate_hz is 0; allowed are 1 to 1000");
    welcome.config.tick_rate_hz = 60;
    welcome.config.mode = "chess";
    EXPECT_EQ(ends_with(welcome), "match config: mode is \"chess\"; supported is \"lockstep\"");
    welcome.config.mode = "lockstep";
    welcome.sim_version = "v9";
    EXPECT_EQ(ends_with(welcome), "the server simulates with version v9, this client with v1");
}

} // namespace
} // namespace lockwind::testing
