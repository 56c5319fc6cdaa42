#include "tests/unit/transport_dds/dds_support.h"
#include "transport/dds/dds_transport.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <unistd.h>
#include <vector>

namespace lockwind {
namespace {

/// A server and three clients of one match: two in one participant, one in another. The processes'
/// boundaries are domains of their own here; what they say crosses the loopback interface.
class DdsMatch : public testing::Test {
protected:
    void SetUp() override {
        const ServerOnDomain opened = open_server();
        server_process = opened.participant;
        domain = opened.domain;
        pair_process = open_client(domain);
        single_process = open_client(domain);
        ASSERT_TRUE(server_process && pair_process && single_process);
        server = endpoint(server_process, "match-1", kServerAddress);
        clients.push_back(endpoint(pair_process, "match-1", 11));
        clients.push_back(endpoint(pair_process, "match-1", 12));
        clients.push_back(endpoint(single_process, "match-1", 13));
        ASSERT_TRUE(wait_for(*server_process, [&] {
            return server->peer_count() == 3 &&
                   std::all_of(clients.begin(), clients.end(), [](const auto& client) {
                       return client->peer_count() == 1;
                   });
        }));
    }

    DdsParticipant& process_of(std::size_t client) {
        return client < 2 ? *pair_process : *single_process;
    }

    std::uint32_t domain = 0;
    std::shared_ptr<DdsParticipant> server_process;
    std::shared_ptr<DdsParticipant> pair_process;
    std::shared_ptr<DdsParticipant> single_process;
    std::unique_ptr<DdsTransport> server;
    std::vector<std::unique_ptr<DdsTransport>> clients;
};

TEST_F(DdsMatch, CarriesBothChannelsToTheServer) {
    for (std::size_t i = 0; i < clients.size(); ++i) {
        const std::string name = std::to_string(i);
        for (const Channel channel : {Channel::best_effort, Channel::reliable}) {
            const std::string text = name + (channel == Channel::reliable ? "r" : "b");
            EXPECT_EQ(clients[i]->send(kServerAddress, channel, bytes_of(text)), SendResult::sent);
        }
    }
    const std::vector<Packet> packets = collect(*server_process, *server, 6);
    ASSERT_EQ(packets.size(), 6U);
    for (const Packet& packet : packets) {
        const std::string expected =
            std::to_string(packet.from - 11) + (packet.channel == Channel::reliable ? "r" : "b");
        EXPECT_EQ(text_of(packet), expected);
    }
    EXPECT_EQ(server->stats().packets_in, 6U);
    EXPECT_EQ(server->stats().bytes_in, 12U);
    EXPECT_EQ(clients[0]->stats().packets_out, 2U);
    EXPECT_EQ(clients[0]->stats().bytes_out, 4U);
}

TEST_F(DdsMatch, DeliversToTheReceiverAlone) {
    for (const Channel channel : {Channel::best_effort, Channel::reliable}) {
        EXPECT_EQ(server->send(12, channel, bytes_of("for 12")), SendResult::sent);
        EXPECT_EQ(server->send(kEveryAddress, channel, bytes_of("for all")), SendResult::sent);
    }
    for (std::size_t i = 0; i < clients.size(); ++i) {
        const std::size_t expected = i == 1 ? 4 : 2;
        std::vector<std::string> texts;
        for (const Packet& packet : collect(process_of(i), *clients[i], expected)) {
            EXPECT_EQ(packet.from, kServerAddress);
            texts.push_back(text_of(packet));
        }
        EXPECT_EQ(texts.size(), expected);
        EXPECT_EQ(std::count(texts.begin(), texts.end(), "for all"), 2);
        EXPECT_EQ(std::count(texts.begin(), texts.end(), "for 12"), i == 1 ? 2 : 0);
    }
}

TEST_F(DdsMatch, NeverCarriesFromClientToClient) {
    EXPECT_EQ(clients[0]->send(13, Channel::reliable, bytes_of("psst")), SendResult::sent);
    EXPECT_EQ(clients[0]->send(kServerAddress, Channel::reliable, bytes_of("done")),
              SendResult::sent);
    const std::vector<Packet> packets = collect(*server_process, *server, 1);
    ASSERT_EQ(packets.size(), 1U);
    EXPECT_EQ(text_of(packets[0]), "done");
    EXPECT_EQ(server->counters().addressed_elsewhere, 1U);
    EXPECT_EQ(server->send(13, Channel::reliable, bytes_of("last")), SendResult::sent);
    const std::vector<Packet> seen = collect(*single_process, *clients[2], 1);
    ASSERT_EQ(seen.size(), 1U);
    EXPECT_EQ(text_of(seen[0]), "last");
}

TEST_F(DdsMatch, CarriesTheLargestPayloadWhole) {
    std::vector<std::byte> large(kPayloadSizeBytesMax);
    for (std::size_t i = 0; i < large.size(); ++i) {
        large[i] = static_cast<std::byte>(i * 31 % 251);
    }
    EXPECT_EQ(server->send(13, Channel::reliable, large), SendResult::sent);
    EXPECT_EQ(clients[2]->send(kServerAddress, Channel::reliable, large), SendResult::sent);
    const std::vector<Packet> down = collect(*single_process, *clients[2], 1);
    const std::vector<Packet> up = collect(*server_process, *server, 1);
    ASSERT_EQ(down.size(), 1U);
    ASSERT_EQ(up.size(), 1U);
    EXPECT_EQ(down[0].bytes, large);
    EXPECT_EQ(up[0].bytes, large);
}

TEST_F(DdsMatch, KeepsTheOrderOfReliablePackets) {
    constexpr std::size_t kCount = 500;
    for (std::size_t i = 0; i < kCount; ++i) {
        ASSERT_EQ(clients[0]->send(kServerAddress, Channel::reliable, bytes_of(std::to_string(i))),
                  SendResult::sent);
    }
    const std::vector<Packet> packets = collect(*server_process, *server, kCount);
    ASSERT_EQ(packets.size(), kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
        ASSERT_EQ(text_of(packets[i]), std::to_string(i));
    }
}

TEST_F(DdsMatch, DeliversWhatWasSentJustBeforeTheEnd) {
    for (std::size_t i = 0; i < 20; ++i) {
        ASSERT_EQ(clients[2]->send(kServerAddress, Channel::reliable, bytes_of(std::to_string(i))),
                  SendResult::sent);
    }
    clients.pop_back();
    single_process.reset();
    EXPECT_EQ(collect(*server_process, *server, 20).size(), 20U);
    EXPECT_EQ(server->stats().packets_spoofed, 0U);
}

TEST_F(DdsMatch, CountsPeersAsTheyComeAndGo) {
    clients.pop_back();
    EXPECT_TRUE(wait_for(*server_process, [&] { return server->peer_count() == 2; }));
    clients.push_back(endpoint(single_process, "match-1", 14));
    EXPECT_TRUE(wait_for(*server_process, [&] { return server->peer_count() == 3; }));
    EXPECT_TRUE(wait_for(*single_process, [&] { return clients[2]->peer_count() == 1; }));
    server.reset();
    EXPECT_TRUE(wait_for(*single_process, [&] {
        return std::all_of(clients.begin(), clients.end(), [](const auto& client) {
            return client->peer_count() == 0;
        });
    }));
}

TEST_F(DdsMatch, KeepsMatchesApart) {
    const auto other_server = endpoint(server_process, "match-2", kServerAddress);
    const auto other_client = endpoint(single_process, "match-2", 13);
    ASSERT_TRUE(wait_for(*server_process, [&] {
        return other_server->peer_count() == 1 && other_client->peer_count() == 1;
    }));
    EXPECT_EQ(server->peer_count(), 3U);
    EXPECT_EQ(other_server->send(kEveryAddress, Channel::reliable, bytes_of("two")),
              SendResult::sent);
    EXPECT_EQ(server->send(kEveryAddress, Channel::reliable, bytes_of("one")), SendResult::sent);
    const std::vector<Packet> in_two = collect(*single_process, *other_client, 1);
    const std::vector<Packet> in_one = collect(*single_process, *clients[2], 1);
    ASSERT_EQ(in_two.size(), 1U);
    ASSERT_EQ(in_one.size(), 1U);
    EXPECT_EQ(text_of(in_two[0]), "two");
    EXPECT_EQ(text_of(in_one[0]), "one");
    EXPECT_EQ(clients[2]->stats().packets_malformed, 0U);
    EXPECT_EQ(clients[2]->counters().addressed_elsewhere, 0U);
}

TEST_F(DdsMatch, DropsASenderThatBelongsToAnotherProcess) {
    EXPECT_EQ(clients[2]->send(kServerAddress, Channel::reliable, bytes_of("mine")),
              SendResult::sent);
    ASSERT_EQ(collect(*server_process, *server, 1).size(), 1U);
    const auto thief = endpoint(pair_process, "match-1", 13);
    ASSERT_TRUE(wait_for(*pair_process,
                         [&] { return thief->peer_count() == 1 && server->peer_count() == 4; }));
    EXPECT_EQ(thief->send(kServerAddress, Channel::reliable, bytes_of("stolen")), SendResult::sent);
    EXPECT_EQ(thief->send(kServerAddress, Channel::best_effort, bytes_of("stolen")),
              SendResult::sent);
    std::vector<Packet> packets;
    EXPECT_TRUE(wait_for(*server_process, [&] {
        server->receive(packets);
        return server->stats().packets_spoofed == 2;
    }));
    EXPECT_TRUE(packets.empty());
}

TEST_F(DdsMatch, AgreesOnEveryPolicy) {
    EXPECT_TRUE(server->compatible().ok());
    for (const auto& client : clients) {
        EXPECT_TRUE(client->compatible().ok());
    }
}

TEST_F(DdsMatch, WaitsForAllEndpointsOfAParticipantAtOnce) {
    EXPECT_EQ(server->send(12, Channel::reliable, bytes_of("wake up")), SendResult::sent);
    std::vector<Packet> packets;
    const std::uint64_t end_us = DdsParticipant::clock_us() + kPatienceUs;
    while (packets.empty() && DdsParticipant::clock_us() < end_us) {
        pair_process->wait_until(end_us);
        clients[0]->receive(packets);
        clients[1]->receive(packets);
    }
    EXPECT_EQ(packets.size(), 1U);
    EXPECT_LT(DdsParticipant::clock_us(), end_us);
}

TEST_F(DdsMatch, ReturnsFromAWaitAtItsDeadline) {
    std::vector<Packet> packets;
    const std::uint64_t deadline_us = clients[0]->clock_us() + 3'000;
    while (clients[0]->clock_us() < deadline_us) {
        clients[0]->wait_until(deadline_us);
    }
    clients[0]->wait_until(deadline_us);
    clients[0]->wait_until(0);
    clients[0]->receive(packets);
    EXPECT_TRUE(packets.empty());
}

TEST(DdsParticipant, RefusesASecondServerOnTheDomain) {
    const ServerOnDomain first = open_server();
    ASSERT_TRUE(first.participant);
    const auto second = open(DdsRole::server, first.domain);
    ASSERT_FALSE(second.ok());
    const std::string& message = second.error().message;
    const std::string domain = "DDS domain " + std::to_string(first.domain);
    const std::string port = "UDP port " + std::to_string(dds_server_port(first.domain));
    EXPECT_NE(message.find(domain), std::string::npos) << message;
    EXPECT_NE(message.find(port), std::string::npos) << message;
    EXPECT_NE(message.find("--domain"), std::string::npos) << message;
}

TEST(DdsParticipant, OpensADomainAgainAfterItsServerHasGone) {
    bool opened_again = false;
    // A program beside this one may take the domain in between: then another is tried.
    for (std::uint32_t i = 0; i < kDomainCount && !opened_again; ++i) {
        const std::uint32_t domain = open_server().domain;
        opened_again = open(DdsRole::server, domain).ok();
    }
    EXPECT_TRUE(opened_again);
}

TEST(DdsParticipant, NamesTheSettingThatIsWrong) {
    const auto error_of = [](const DdsSettings& settings) {
        const auto opened = DdsParticipant::open(settings);
        return opened.ok() ? std::string() : opened.error().message;
    };
    DdsSettings settings;
    settings.domain = 0;
    EXPECT_NE(error_of(settings).find("domain 0 is not in 1 .. 100"), std::string::npos);
    settings.domain = 101;
    EXPECT_NE(error_of(settings).find("domain 101"), std::string::npos);
    settings.domain = kFirstDomain;
    settings.interface = "no\"such";
    EXPECT_NE(error_of(settings).find("\"no\"such\" is no network interface"), std::string::npos);
    settings.interface = "";
    settings.server_address = "not an address";
    EXPECT_NE(error_of(settings).find("server address \"not an address\""), std::string::npos);
}

TEST(DdsTransport, RefusesMatchNamesThatCouldMatchOthers) {
    const auto owner = open_client(kFirstDomain);
    ASSERT_TRUE(owner);
    for (const std::string name : {"", "*", "a?", "[ab]", "a b", "a/b", "a,b"}) {
        EXPECT_FALSE(DdsTransport::open(owner, name, 1).ok()) << name;
    }
    EXPECT_FALSE(DdsTransport::open(owner, std::string(65, 'a'), 1).ok());
    EXPECT_TRUE(DdsTransport::open(owner, std::string(64, 'a'), 1).ok());
    EXPECT_TRUE(DdsTransport::open(owner, "Match_1.a-b", 1).ok());
}

} // namespace
} // namespace lockwind
