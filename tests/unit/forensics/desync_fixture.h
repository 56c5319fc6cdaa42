#pragma once

#include "forensics/bundle.h"
#include "forensics/diff.h"
#include "tests/unit/forensics/fake_simulation.h"
#include "tests/unit/log/log_fixture.h"

namespace lockwind::test {

/// A server and a client that agreed on tick 3 and report hashes of tick 6. Tests plant a cause in
/// one of them, then let the client answer and the server judge.
struct Desync {
    static constexpr Tick kAgreedTick = 3;
    static constexpr Tick kBadTick = 6;

    FakeSimulation server;
    FakeSimulation client;
    Party server_party = party("g++ 12");
    Party client_party = party("g++ 12");
    std::vector<std::vector<SlotInput>> server_inputs;
    std::vector<std::vector<SlotInput>> client_inputs;
    std::vector<std::byte> server_agreed;
    std::vector<std::byte> client_agreed;
    std::vector<std::byte> server_state;
    std::vector<std::byte> client_state;
    std::uint64_t server_hash = 0;
    std::uint64_t client_hash = 0;
    std::vector<std::byte> report;

    static Party party(const std::string& build_info) {
        return {"sim 1", build_info, golden_header().config};
    }

    Desync() {
        for (Tick tick = kAgreedTick + 1; tick <= kBadTick; ++tick) {
            server_inputs.push_back(fake_inputs(tick));
        }
        client_inputs = server_inputs;
    }

    /// Both play to the bad tick; `corrupt_client` and `corrupt_server` come before their hash is
    /// taken.
    void play(const std::function<void(FakeSimulation&)>& corrupt_client = {},
              const std::function<void(FakeSimulation&)>& corrupt_server = {}) {
        play_one(server, server_inputs, server_agreed, corrupt_server);
        play_one(client, client_inputs, client_agreed, corrupt_client);
        server_state = server.saved();
        client_state = client.saved();
        server_hash = server.state_hash();
        client_hash = client.state_hash();
    }

    void answer() {
        const auto blob = build_desync_report(client,
                                              {kAgreedTick, client_agreed, client_inputs},
                                              client_party,
                                              {1, client_hash, client_state});
        ASSERT_TRUE(blob.ok()) << blob.error().message;
        report = blob.value();
    }

    Bundle judge() {
        DesyncEvidence evidence;
        evidence.slot = 1;
        evidence.interval = {kAgreedTick, server_agreed, server_inputs};
        evidence.server_hash = server_hash;
        evidence.client_hash = client_hash;
        evidence.server_state = server_state;
        evidence.server = server_party;
        Result<Bundle> bundle = make_bundle(server, evidence, report);
        EXPECT_TRUE(bundle.ok());
        return std::move(bundle).value();
    }

private:
    static void play_one(FakeSimulation& simulation,
                         const std::vector<std::vector<SlotInput>>& inputs,
                         std::vector<std::byte>& agreed,
                         const std::function<void(FakeSimulation&)>& corrupt) {
        for (Tick tick = 1; tick <= kAgreedTick; ++tick) {
            EXPECT_TRUE(simulation.advance(fake_inputs(tick)).ok());
        }
        agreed = simulation.saved();
        for (const std::vector<SlotInput>& tick : inputs) {
            EXPECT_TRUE(simulation.advance(tick).ok());
        }
        if (corrupt) {
            corrupt(simulation);
        }
    }
};

} // namespace lockwind::test
