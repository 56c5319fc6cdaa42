#pragma once

#include "envelope.h"
#include "transport/dds/dds_entity.h"
#include "transport/dds/dds_participant.h"
#include "transport/transport.h"

#include <cstdint>
#include <dds/dds.h>
#include <string>
#include <string_view>

namespace lockwind::testing {

/// A client that is not of this project: plain DDS, which writes what it likes.
class ForeignPeer {
public:
    ForeignPeer(std::uint32_t domain, std::string_view match, dds_reliability_kind_t reliability)
        : match_id_(fnv1a(match)) {
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
        const std::string partition = "lockwind/" + std::string(match);
        const char* partitions = partition.c_str();
        dds_qset_partition(qos, 1, &partitions);
        const dds_entity_t publisher = dds_create_publisher(participant, qos, nullptr);
        dds_qset_reliability(qos, reliability, DDS_SECS(1));
        dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
        dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_MSECS(500));
        const dds_entity_t topic = dds_create_topic(
            participant, &lockwind_Envelope_desc, "lockwind_c2s_reliable", nullptr, nullptr);
        writer_ = dds_create_writer(publisher, topic, qos, nullptr);
        dds_delete_qos(qos);
    }

    std::uint64_t match_id() const { return match_id_; }
    bool matched() const {
        dds_publication_matched_status_t status{};
        (void)dds_get_publication_matched_status(writer_, &status);
        return status.current_count > 0;
    }

    bool write(std::uint64_t match_id, std::uint32_t sender, std::string_view payload) const {
        lockwind_Envelope envelope{};
        envelope.match_id = match_id;
        envelope.sender = sender;
        envelope.receiver = kServerAddress;
        envelope.payload._buffer = const_cast<std::uint8_t*>( // DDS only reads it
            reinterpret_cast<const std::uint8_t*>(payload.data()));
        envelope.payload._length = static_cast<std::uint32_t>(payload.size());
        envelope.payload._maximum = envelope.payload._length;
        return dds_write(writer_, &envelope) >= 0;
    }

private:
    /// FNV-1a 64.
    static std::uint64_t fnv1a(std::string_view text) {
        std::uint64_t hash = 0xcbf29ce484222325U;
        for (const char c : text) {
            hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
        }
        return hash;
    }

    std::uint64_t match_id_;
    DdsEntity domain_;
    dds_entity_t writer_ = 0;
};

} // namespace lockwind::testing
