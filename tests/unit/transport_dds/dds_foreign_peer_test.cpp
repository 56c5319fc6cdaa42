#include "envelope.h"
#include "tests/unit/transport_dds/dds_support.h"
#include "transport/dds/dds_transport.h"

#include <dds/dds.h>
#include <gtest/gtest.h>
#include <memory>
#include <string>

namespace lockwind {
namespace {

/// A client that is not of this project: plain DDS, which writes what it likes.
class ForeignPeer {
public:
    ForeignPeer(std::uint32_t domain, dds_reliability_kind_t reliability) {
        // Not one that DdsParticipant uses within a process for domains 40 .. 60.
        constexpr std::uint32_t kInternalDomain = 230;
        const std::string xml =
            "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
            "<AllowMulticast>false</AllowMulticast></General><Discovery><ExternalDomainId>" +
            std::to_string(domain) +
            "</ExternalDomainId><ParticipantIndex>none</ParticipantIndex><Peers><Peer "
            "Address=\"127.0.0.1:" +
            std::to_string(dds_server_port(domain)) +
            "\"/></Peers></Discovery></Domain></CycloneDDS>";
        domain_ = DdsEntity(dds_create_domain(kInternalDomain, xml.c_str()));
        const dds_entity_t participant = dds_create_participant(kInternalDomain, nullptr, nullptr);
        dds_qos_t* qos = dds_create_qos();
        const char* partition = "lockwind/match-1";
        dds_qset_partition(qos, 1, &partition);
        const dds_entity_t publisher = dds_create_publisher(participant, qos, nullptr);
        dds_qset_reliability(qos, reliability, DDS_SECS(1));
        dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
        dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_MSECS(500));
        const dds_entity_t topic = dds_create_topic(
            participant, &lockwind_Envelope_desc, "lockwind_c2s_reliable", nullptr, nullptr);
        writer_ = dds_create_writer(publisher, topic, qos, nullptr);
        dds_delete_qos(qos);
    }

    bool matched() const {
        dds_publication_matched_status_t status{};
        (void)dds_get_publication_matched_status(writer_, &status);
        return status.current_count > 0;
    }

    bool write(std::uint64_t match_id, std::uint32_t sender, std::string payload) const {
        lockwind_Envelope envelope{};
        envelope.match_id = match_id;
        envelope.sender = sender;
        envelope.receiver = kServerAddress;
        envelope.payload._buffer = reinterpret_cast<std::uint8_t*>(payload.data());
        envelope.payload._length = static_cast<std::uint32_t>(payload.size());
        envelope.payload._maximum = envelope.payload._length;
        return dds_write(writer_, &envelope) >= 0;
    }

private:
    DdsEntity domain_;
    dds_entity_t writer_ = 0;
};

/// FNV-1a 64 of "match-1".
constexpr std::uint64_t match_id() {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char c : std::string_view("match-1")) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    }
    return hash;
}

class DdsForeignPeer : public testing::Test {
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
    const ForeignPeer peer(domain, DDS_RELIABILITY_RELIABLE);
    ASSERT_TRUE(wait_for(*process, [&] { return peer.matched(); }));
    EXPECT_TRUE(peer.write(match_id() + 1, 21, "another match"));
    EXPECT_TRUE(peer.write(match_id(), kServerAddress, "as the server"));
    EXPECT_TRUE(peer.write(match_id(), kEveryAddress, "as everybody"));
    EXPECT_TRUE(peer.write(match_id(), 21, "as 21"));
    EXPECT_TRUE(peer.write(match_id(), 22, "as 22, from the writer of 21"));
    EXPECT_TRUE(peer.write(match_id(), 21, "end"));
    const std::vector<Packet> packets = collect(*process, *server, 2);
    ASSERT_EQ(packets.size(), 2U);
    EXPECT_EQ(text_of(packets[0]), "as 21");
    EXPECT_EQ(text_of(packets[1]), "end");
    EXPECT_EQ(server->counters().malformed, 3U);
    EXPECT_EQ(server->counters().spoofed, 1U);
    EXPECT_EQ(server->peer_count(), 0U) << "it has no reader: it is no peer of a match";
}

TEST_F(DdsForeignPeer, IsNamedWhereItsPolicyDiffers) {
    const ForeignPeer peer(domain, DDS_RELIABILITY_BEST_EFFORT);
    EXPECT_TRUE(wait_for(*process, [&] { return !server->compatible().ok(); }));
    EXPECT_NE(server->compatible().error().message.find("DDS reliability policy"),
              std::string::npos)
        << server->compatible().error().message;
    EXPECT_FALSE(peer.matched());
}

} // namespace
} // namespace lockwind
