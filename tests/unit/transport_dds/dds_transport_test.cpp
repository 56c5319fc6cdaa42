#include "transport/dds/dds_transport.h"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <unistd.h>
#include <vector>

namespace lockwind {
namespace {

constexpr std::uint32_t kFirstDomain = 40;
constexpr std::uint32_t kDomainCount = 21;
constexpr std::uint64_t kPatienceUs = 20'000'000; // only a failing test waits this long

Result<std::shared_ptr<DdsParticipant>> open(DdsRole role, std::uint32_t domain) {
    DdsSettings settings;
    settings.role = role;
    settings.domain = domain;
    return DdsParticipant::open(settings);
}

struct ServerOnDomain {
    std::shared_ptr<DdsParticipant> participant;
    std::uint32_t domain = 0;
};

/// Test programs run side by side: takes the first domain that no server holds.
ServerOnDomain open_server() {
    for (std::uint32_t i = 0; i < kDomainCount; ++i) {
        const std::uint32_t domain =
            kFirstDomain + (static_cast<std::uint32_t>(getpid()) + i) % kDomainCount;
        Result<std::shared_ptr<DdsParticipant>> opened = open(DdsRole::server, domain);
        if (opened.ok()) {
            return {std::move(opened).value(), domain};
        }
    }
    ADD_FAILURE() << "no free DDS domain";
    return {};
}

std::shared_ptr<DdsParticipant> open_client(std::uint32_t domain) {
    Result<std::shared_ptr<DdsParticipant>> opened = open(DdsRole::client, domain);
    EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : opened.error().message);
    return opened.ok() ? std::move(opened).value() : nullptr;
}

std::unique_ptr<DdsTransport> endpoint(const std::shared_ptr<DdsParticipant>& owner,
                                       const std::string& match,
                                       std::uint32_t address) {
    Result<std::unique_ptr<DdsTransport>> opened = DdsTransport::open(owner, match, address);
    EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : opened.error().message);
    return opened.ok() ? std::move(opened).value() : nullptr;
}

std::vector<std::byte> bytes_of(std::string_view text) {
    const auto* data = reinterpret_cast<const std::byte*>(text.data());
    return {data, data + text.size()};
}

std::string text_of(const Packet& packet) {
    return {reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size()};
}

/// Waits on `owner` until `done`, or until patience ends.
bool wait_for(DdsParticipant& owner, const std::function<bool()>& done) {
    const std::uint64_t end_us = DdsParticipant::clock_us() + kPatienceUs;
    while (!done()) {
        const std::uint64_t now_us = DdsParticipant::clock_us();
        if (now_us >= end_us) {
            return false;
        }
        owner.wait_until(now_us + 5'000);
    }
    return true;
}

/// Collects what `transport` receives until there are `count` packets.
std::vector<Packet> collect(DdsParticipant& owner, DdsTransport& transport, std::size_t count) {
    std::vector<Packet> packets;
    wait_for(owner, [&] {
        transport.receive(packets);
        return packets.size() >= count;
    });
    return packets;
}

/// A server and three clients of one match: two in one participant, one in another. The processes'
/// boundaries are domains of their own here; what they say crosses the loopback interface.
class DdsMatch : public testing::Test {
protected:
    void SetUp() override {
        const ServerOnDomain server = open_server();
        server_process_ = server.participant;
        domain_ = server.domain;
        pair_process_ = open_client(domain_);
        single_process_ = open_client(domain_);
        ASSERT_TRUE(server_process_ && pair_process_ && single_process_);
        server_ = endpoint(server_process_, "match-1", kServerAddress);
        clients_.push_back(endpoint(pair_process_, "match-1", 11));
        clients_.push_back(endpoint(pair_process_, "match-1", 12));
        clients_.push_back(endpoint(single_process_, "match-1", 13));
        ASSERT_TRUE(wait_for(*server_process_, [&] {
            return server_->peer_count() == 3 &&
                   std::all_of(clients_.begin(), clients_.end(), [](const auto& client) {
                       return client->peer_count() == 1;
                   });
        }));
    }

    DdsParticipant& process_of(std::size_t client) {
        return client < 2 ? *pair_process_ : *single_process_;
    }

    std::uint32_t domain_ = 0;
    std::shared_ptr<DdsParticipant> server_process_;
    std::shared_ptr<DdsParticipant> pair_process_;
    std::shared_ptr<DdsParticipant> single_process_;
    std::unique_ptr<DdsTransport> server_;
    std::vector<std::unique_ptr<DdsTransport>> clients_;
};

TEST_F(DdsMatch, CarriesBothChannelsToTheServer) {
    for (std::size_t i = 0; i < clients_.size(); ++i) {
        const std::string name = std::to_string(i);
        for (const Channel channel : {Channel::best_effort, Channel::reliable}) {
            const std::string text = name + (channel == Channel::reliable ? "r" : "b");
            EXPECT_EQ(clients_[i]->send(kServerAddress, channel, bytes_of(text)), SendResult::sent);
        }
    }
    const std::vector<Packet> packets = collect(*server_process_, *server_, 6);
    ASSERT_EQ(packets.size(), 6U);
    for (const Packet& packet : packets) {
        const std::string expected =
            std::to_string(packet.from - 11) + (packet.channel == Channel::reliable ? "r" : "b");
        EXPECT_EQ(text_of(packet), expected);
    }
    EXPECT_EQ(server_->stats().packets_in, 6U);
    EXPECT_EQ(server_->stats().bytes_in, 12U);
    EXPECT_EQ(clients_[0]->stats().packets_out, 2U);
    EXPECT_EQ(clients_[0]->stats().bytes_out, 4U);
}

TEST_F(DdsMatch, DeliversToTheReceiverAlone) {
    for (const Channel channel : {Channel::best_effort, Channel::reliable}) {
        EXPECT_EQ(server_->send(12, channel, bytes_of("for 12")), SendResult::sent);
        EXPECT_EQ(server_->send(kEveryAddress, channel, bytes_of("for all")), SendResult::sent);
    }
    for (std::size_t i = 0; i < clients_.size(); ++i) {
        const std::size_t expected = i == 1 ? 4 : 2;
        std::vector<std::string> texts;
        for (const Packet& packet : collect(process_of(i), *clients_[i], expected)) {
            EXPECT_EQ(packet.from, kServerAddress);
            texts.push_back(text_of(packet));
        }
        EXPECT_EQ(texts.size(), expected);
        EXPECT_EQ(std::count(texts.begin(), texts.end(), "for all"), 2);
        EXPECT_EQ(std::count(texts.begin(), texts.end(), "for 12"), i == 1 ? 2 : 0);
    }
}

TEST_F(DdsMatch, NeverCarriesFromClientToClient) {
    EXPECT_EQ(clients_[0]->send(13, Channel::reliable, bytes_of("psst")), SendResult::sent);
    EXPECT_EQ(clients_[0]->send(kServerAddress, Channel::reliable, bytes_of("done")),
              SendResult::sent);
    const std::vector<Packet> packets = collect(*server_process_, *server_, 1);
    ASSERT_EQ(packets.size(), 1U);
    EXPECT_EQ(text_of(packets[0]), "done");
    EXPECT_EQ(server_->counters().addressed_elsewhere, 1U);
    EXPECT_EQ(server_->send(13, Channel::reliable, bytes_of("last")), SendResult::sent);
    const std::vector<Packet> seen = collect(*single_process_, *clients_[2], 1);
    ASSERT_EQ(seen.size(), 1U);
    EXPECT_EQ(text_of(seen[0]), "last");
}

TEST_F(DdsMatch, CarriesTheLargestPayloadWhole) {
    std::vector<std::byte> large(kPayloadSizeBytesMax);
    for (std::size_t i = 0; i < large.size(); ++i) {
        large[i] = static_cast<std::byte>(i * 31 % 251);
    }
    EXPECT_EQ(server_->send(13, Channel::reliable, large), SendResult::sent);
    EXPECT_EQ(clients_[2]->send(kServerAddress, Channel::reliable, large), SendResult::sent);
    const std::vector<Packet> down = collect(*single_process_, *clients_[2], 1);
    const std::vector<Packet> up = collect(*server_process_, *server_, 1);
    ASSERT_EQ(down.size(), 1U);
    ASSERT_EQ(up.size(), 1U);
    EXPECT_EQ(down[0].bytes, large);
    EXPECT_EQ(up[0].bytes, large);
}

TEST_F(DdsMatch, KeepsTheOrderOfReliablePackets) {
    constexpr std::size_t kCount = 500;
    for (std::size_t i = 0; i < kCount; ++i) {
        ASSERT_EQ(clients_[0]->send(kServerAddress, Channel::reliable, bytes_of(std::to_string(i))),
                  SendResult::sent);
    }
    const std::vector<Packet> packets = collect(*server_process_, *server_, kCount);
    ASSERT_EQ(packets.size(), kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
        ASSERT_EQ(text_of(packets[i]), std::to_string(i));
    }
}

TEST_F(DdsMatch, DeliversWhatWasSentJustBeforeTheEnd) {
    for (std::size_t i = 0; i < 20; ++i) {
        ASSERT_EQ(clients_[2]->send(kServerAddress, Channel::reliable, bytes_of(std::to_string(i))),
                  SendResult::sent);
    }
    clients_.pop_back();
    single_process_.reset();
    EXPECT_EQ(collect(*server_process_, *server_, 20).size(), 20U);
    EXPECT_EQ(server_->counters().spoofed, 0U);
}

TEST_F(DdsMatch, CountsPeersAsTheyComeAndGo) {
    clients_.pop_back();
    EXPECT_TRUE(wait_for(*server_process_, [&] { return server_->peer_count() == 2; }));
    clients_.push_back(endpoint(single_process_, "match-1", 14));
    EXPECT_TRUE(wait_for(*server_process_, [&] { return server_->peer_count() == 3; }));
    EXPECT_TRUE(wait_for(*single_process_, [&] { return clients_[2]->peer_count() == 1; }));
    server_.reset();
    EXPECT_TRUE(wait_for(*single_process_, [&] {
        return std::all_of(clients_.begin(), clients_.end(), [](const auto& client) {
            return client->peer_count() == 0;
        });
    }));
}

TEST_F(DdsMatch, KeepsMatchesApart) {
    const auto other_server = endpoint(server_process_, "match-2", kServerAddress);
    const auto other_client = endpoint(single_process_, "match-2", 13);
    ASSERT_TRUE(wait_for(*server_process_, [&] {
        return other_server->peer_count() == 1 && other_client->peer_count() == 1;
    }));
    EXPECT_EQ(server_->peer_count(), 3U);
    EXPECT_EQ(other_server->send(kEveryAddress, Channel::reliable, bytes_of("two")),
              SendResult::sent);
    EXPECT_EQ(server_->send(kEveryAddress, Channel::reliable, bytes_of("one")), SendResult::sent);
    const std::vector<Packet> in_two = collect(*single_process_, *other_client, 1);
    const std::vector<Packet> in_one = collect(*single_process_, *clients_[2], 1);
    ASSERT_EQ(in_two.size(), 1U);
    ASSERT_EQ(in_one.size(), 1U);
    EXPECT_EQ(text_of(in_two[0]), "two");
    EXPECT_EQ(text_of(in_one[0]), "one");
    EXPECT_EQ(clients_[2]->counters().malformed, 0U);
    EXPECT_EQ(clients_[2]->counters().addressed_elsewhere, 0U);
}

TEST_F(DdsMatch, DropsASenderThatBelongsToAnotherProcess) {
    EXPECT_EQ(clients_[2]->send(kServerAddress, Channel::reliable, bytes_of("mine")),
              SendResult::sent);
    ASSERT_EQ(collect(*server_process_, *server_, 1).size(), 1U);
    const auto thief = endpoint(pair_process_, "match-1", 13);
    ASSERT_TRUE(wait_for(*pair_process_,
                         [&] { return thief->peer_count() == 1 && server_->peer_count() == 4; }));
    EXPECT_EQ(thief->send(kServerAddress, Channel::reliable, bytes_of("stolen")), SendResult::sent);
    EXPECT_EQ(thief->send(kServerAddress, Channel::best_effort, bytes_of("stolen")),
              SendResult::sent);
    std::vector<Packet> packets;
    EXPECT_TRUE(wait_for(*server_process_, [&] {
        server_->receive(packets);
        return server_->counters().spoofed == 2;
    }));
    EXPECT_TRUE(packets.empty());
}

TEST_F(DdsMatch, AgreesOnEveryPolicy) {
    EXPECT_TRUE(server_->compatible().ok());
    for (const auto& client : clients_) {
        EXPECT_TRUE(client->compatible().ok());
    }
}

TEST_F(DdsMatch, WaitsForAllEndpointsOfAParticipantAtOnce) {
    EXPECT_EQ(server_->send(12, Channel::reliable, bytes_of("wake up")), SendResult::sent);
    std::vector<Packet> packets;
    const std::uint64_t end_us = DdsParticipant::clock_us() + kPatienceUs;
    while (packets.empty() && DdsParticipant::clock_us() < end_us) {
        pair_process_->wait_until(end_us);
        clients_[0]->receive(packets);
        clients_[1]->receive(packets);
    }
    EXPECT_EQ(packets.size(), 1U);
    EXPECT_LT(DdsParticipant::clock_us(), end_us);
}

TEST_F(DdsMatch, ReturnsFromAWaitAtItsDeadline) {
    std::vector<Packet> packets;
    const std::uint64_t deadline_us = clients_[0]->clock_us() + 3'000;
    while (clients_[0]->clock_us() < deadline_us) {
        clients_[0]->wait_until(deadline_us);
    }
    clients_[0]->wait_until(deadline_us);
    clients_[0]->wait_until(0);
    clients_[0]->receive(packets);
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
