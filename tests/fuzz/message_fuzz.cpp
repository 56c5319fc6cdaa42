#include "codec/codec.h"
#include "tests/fuzz/fuzz_target.h"

#include "lockwind/assert.h"
#include "lockwind/session.h"

namespace lockwind::fuzz {
namespace {

constexpr PeerId kPlayer = 5;
constexpr PeerId kStranger = 6;
constexpr std::uint64_t kNowUs = 200'000;

MatchConfig config() {
    MatchConfig config;
    config.match = "fuzz";
    config.mode = "lockstep";
    config.players = 1;
    config.ticks = 100;
    return config;
}

/// Does what a driver does, with a simulation whose hash is its tick.
void drive(LockstepServer& server, std::uint64_t now_us) {
    server.update(now_us);
    for (const Request& request : server.take_requests()) {
        if (const auto* advance = std::get_if<AdvanceRequest>(&request)) {
            server.advanced(advance->tick, advance->tick, now_us);
        } else if (const auto* snapshot = std::get_if<SnapshotRequest>(&request)) {
            server.snapshot_saved(snapshot->slot, snapshot->tick, snapshot->tick, {});
        }
    }
}

/// A match in which kPlayer plays, some ticks old; `halted`: his hash of tick 1 was another one.
LockstepServer running_server(bool halted) {
    LockstepServerSettings settings;
    settings.config = config();
    settings.sim_version = "v1";
    LockstepServer server(settings);
    drive(server, 1);
    server.receive(kPlayer, Hello{kProtocolVersion, "v1", "", 7, 1}, 2);
    server.receive(kPlayer, Ready{0, 0}, 3);
    InputBatch inputs;
    inputs.first_tick = 1;
    inputs.inputs.resize(20);
    server.receive(kPlayer, inputs, 4);
    for (std::uint64_t now_us = 5; now_us < kNowUs; now_us += 5'000) {
        drive(server, now_us);
    }
    LOCKWIND_ASSERT(server.phase() == MatchPhase::running && server.advanced_tick() > 3);
    if (halted) {
        HashReport report;
        report.entries = {{1, 99}};
        server.receive(kPlayer, report, kNowUs);
        LOCKWIND_ASSERT(server.phase() == MatchPhase::halted);
    }
    return server;
}

void drive(LockstepClient& client, std::uint64_t now_us) {
    while (client.wants_input()) {
        client.add_local_input(client.next_input_tick(), SlotInput{});
    }
    client.update(now_us);
    for (const Request& request : client.take_requests()) {
        if (std::holds_alternative<CreateRequest>(request)) {
            client.created(0, 1);
        } else if (const auto* advance = std::get_if<AdvanceRequest>(&request)) {
            client.advanced(advance->tick, advance->tick);
        } else if (const auto* restore = std::get_if<RestoreRequest>(&request)) {
            client.restored(restore->tick);
        }
    }
}

/// A player some ticks into a match, or one who awaits a snapshot of it.
LockstepClient playing_client(bool awaits_snapshot) {
    LockstepClientSettings settings;
    settings.sim_version = "v1";
    LockstepClient client(settings);
    drive(client, 1);
    Welcome welcome;
    welcome.config = config();
    welcome.sim_version = "v1";
    welcome.attempt = 1;
    welcome.resume_tick = awaits_snapshot ? 10 : 0;
    welcome.transfer = awaits_snapshot ? 1 : 0;
    client.receive(kServerPeer, welcome, 2);
    drive(client, 3);
    if (awaits_snapshot) {
        LOCKWIND_ASSERT(client.phase() == ClientPhase::receiving);
        return client;
    }
    Confirmation confirmation;
    confirmation.first_tick = 1;
    confirmation.confirmed_tick = 5;
    confirmation.acks.resize(1);
    confirmation.acks[0].attached = true;
    confirmation.ticks.resize(5);
    for (ConfirmedTick& tick : confirmation.ticks) {
        tick.inputs.resize(1);
    }
    client.receive(kServerPeer, confirmation, 4);
    drive(client, 5);
    LOCKWIND_ASSERT(client.phase() == ClientPhase::playing && client.advanced_tick() == 5);
    return client;
}

} // namespace
} // namespace lockwind::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lockwind;
    const Result<Message> message = decode(fuzz::bytes_of(data, size));
    if (!message) {
        LOCKWIND_ASSERT(!message.error().message.empty());
        return 0;
    }
    // What is accepted can be sent, and says the same again.
    LOCKWIND_ASSERT(check(message.value()).ok());
    const std::vector<std::byte> bytes = encode(message.value());
    const Result<Message> again = decode(bytes);
    LOCKWIND_ASSERT(again.ok());
    LOCKWIND_ASSERT(encode(again.value()) == bytes);
    // No message of anybody's brings a session down.
    for (const bool halted : {false, true}) {
        for (const PeerId from : {fuzz::kPlayer, fuzz::kStranger}) {
            LockstepServer server = fuzz::running_server(halted);
            server.receive(from, message.value(), fuzz::kNowUs);
            fuzz::drive(server, fuzz::kNowUs);
        }
    }
    for (const bool awaits_snapshot : {false, true}) {
        LockstepClient client = fuzz::playing_client(awaits_snapshot);
        client.receive(kServerPeer, message.value(), 6);
        fuzz::drive(client, 7);
        fuzz::drive(client, fuzz::kNowUs);
    }
    return 0;
}
