#pragma once

#include "transport/dds/dds_participant.h"
#include "transport/dds/sender_registry.h"
#include "transport/transport.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

struct lockwind_Envelope; // of envelope.idl

namespace lockwind {

/// Samples that arrived for others, and writes that failed; what strangers send is in the stats.
struct DdsCounters {
    std::uint64_t addressed_elsewhere = 0; // to another receiver of the match: ordinary
    std::uint64_t writes_full = 0;         // send() returned full
};

/// One endpoint of one match on DDS: a writer and a reader per channel in the match's partition.
/// Destroying it tells the peers at once.
class DdsTransport final : public Transport {
public:
    /// `match`: 1 .. 64 letters, digits, '-', '_' or '.'. `address`: kServerAddress on a server's
    /// participant, any other but kEveryAddress on a client's.
    static Result<std::unique_ptr<DdsTransport>> open(std::shared_ptr<DdsParticipant> participant,
                                                      std::string_view match,
                                                      std::uint32_t address);
    ~DdsTransport() override;

    SendResult send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) override;
    void receive(std::vector<Packet>& out) override;
    void wait_until(std::uint64_t deadline_us) override;
    std::uint64_t clock_us() const override;
    /// Peers whose readers and writers have all matched ours.
    std::uint32_t peer_count() const override;
    TransportStats stats() const override { return stats_; }

    DdsCounters counters() const { return counters_; }
    /// An Error that names the QoS policy if a peer asked for, or offered, another one than we: the
    /// two builds cannot talk.
    Status compatible() const;

private:
    struct Flow {
        DdsEntity writer;
        DdsEntity reader;
        DdsEntity condition;
    };

    DdsTransport() = default;
    Status create_entities(const std::string& partition);
    Status create_flow(Channel channel);
    void receive_flow(Channel channel, std::vector<Packet>& out);
    void accept(const lockwind_Envelope& envelope,
                std::uint64_t writer,
                Channel channel,
                std::vector<Packet>& out);
    std::vector<SenderRegistry::Writer> matched_writers() const;

    std::shared_ptr<DdsParticipant> participant_;
    std::uint32_t address_ = 0;
    std::uint64_t match_id_ = 0;
    DdsEntity publisher_;
    DdsEntity subscriber_;
    DdsEntity waitset_;
    std::array<Flow, 2> flows_; // by Channel
    SenderRegistry senders_;
    TransportStats stats_;
    DdsCounters counters_;
};

} // namespace lockwind
