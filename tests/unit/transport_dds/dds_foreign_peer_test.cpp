#include "tests/support/foreign_peer.h"
#include "tests/unit/transport_dds/dds_support.h"
#include "transport/dds/dds_transport.h"

#include <gtest/gtest.h>
#include <memory>
#include <string>

namespace lockwind {
namespace {

using testing::ForeignPeer;

class DdsForeignPeer : public ::testing::Test {
protected:
    void SetUp() override {
        const ServerOnDomain opened = open_server();
        process = opened.participant;
        domain = opened.domain;
        ASSERT_TRUE(process);
        server = endpoint(process, "match-1", kServerAddress);
        ASSERT_TRUE(server);
    }

    std::shared_ptr<DdsParticipant> process;
    std::uint32_t domain = 0;
    std::unique_ptr<DdsTransport> server;
};

TEST_F(DdsForeignPeer, IsHeardOnlyWhereItKeepsTheRules) {
    const ForeignPeer peer(domain, "match-1", DDS_RELIABILITY_RELIABLE);
    ASSERT_TRUE(wait_for(*process, [&] { return peer.matched(); }));
    EXPECT_TRUE(peer.write(peer.match_id() + 1, 21, "another match"));
    EXPECT_TRUE(peer.write(peer.match_id(), kServerAddress, "as the server"));
    EXPECT_TRUE(peer.write(peer.match_id(), kEveryAddress, "as everybody"));
    EXPECT_TRUE(peer.write(peer.match_id(), 21, "as 21"));
    EXPECT_TRUE(peer.write(peer.match_id(), 22, "as 22, from the writer of 21"));
    EXPECT_TRUE(peer.write(peer.match_id(), 21, "end"));
    const std::vector<Packet> packets = collect(*process, *server, 2);
    ASSERT_EQ(packets.size(), 2U);
    EXPECT_EQ(text_of(packets[0]), "as 21");
    EXPECT_EQ(text_of(packets[1]), "end");
    EXPECT_EQ(server->stats().packets_malformed, 3U);
    EXPECT_EQ(server->stats().packets_spoofed, 1U);
    EXPECT_EQ(server->peer_count(), 0U) << "it has no reader: it is no peer of a match";
}

TEST_F(DdsForeignPeer, IsNamedWhereItsPolicyDiffers) {
    const ForeignPeer peer(domain, "match-1", DDS_RELIABILITY_BEST_EFFORT);
    EXPECT_TRUE(wait_for(*process, [&] { return !server->compatible().ok(); }));
    EXPECT_NE(server->compatible().error().message.find("DDS reliability policy"),
              std::string::npos)
        << server->compatible().error().message;
    EXPECT_FALSE(peer.matched());
}

} // namespace
} // namespace lockwind
