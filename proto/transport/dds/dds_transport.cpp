#include "transport/dds/dds_transport.h"

#include "envelope.h"
#include "transport/dds/dds_error.h"
#include "transport/dds/wait.h"

#include "lockwind/assert.h"

#include <algorithm>
#include <cstring>
#include <dds/dds.h>
#include <limits>
#include <utility>

namespace lockwind {
namespace {

struct DeleteQos {
    void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, DeleteQos>;

/// Both ends set every policy that must agree.
Qos flow_qos(Channel channel) {
    Qos qos(dds_create_qos());
    // Never block the tick: a full reliable writer answers TIMEOUT.
    dds_qset_reliability(qos.get(),
                         channel == Channel::reliable ? DDS_RELIABILITY_RELIABLE
                                                      : DDS_RELIABILITY_BEST_EFFORT,
                         0);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
    dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, DDS_MSECS(500));
    dds_qset_writer_data_lifecycle(qos.get(), false);
    dds_qset_destination_order(qos.get(), DDS_DESTINATIONORDER_BY_RECEPTION_TIMESTAMP);
    return qos;
}

/// Also keeps '*', '?' and '[' out: in a partition's name they match other matches.
bool is_match_name(std::string_view name) {
    constexpr std::size_t kMatchNameSizeMax = 64;
    const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_' || c == '.';
    };
    return !name.empty() && name.size() <= kMatchNameSizeMax &&
           std::all_of(name.begin(), name.end(), allowed);
}

/// FNV-1a, 64 bits: http://www.isthe.com/chongo/tech/comp/fnv/
std::uint64_t match_id_of(std::string_view name) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char c : name) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    }
    return hash;
}

std::string_view policy_name(std::uint32_t policy_id) {
    switch (policy_id) {
    case DDS_DURABILITY_QOS_POLICY_ID:
        return "durability";
    case DDS_RELIABILITY_QOS_POLICY_ID:
        return "reliability";
    case DDS_LIVELINESS_QOS_POLICY_ID:
        return "liveliness";
    case DDS_DESTINATIONORDER_QOS_POLICY_ID:
        return "destination order";
    case DDS_OWNERSHIP_QOS_POLICY_ID:
        return "ownership";
    case DDS_PRESENTATION_QOS_POLICY_ID:
        return "presentation";
    default:
        return "another";
    }
}

constexpr std::array<Channel, 2> kChannels = {Channel::best_effort, Channel::reliable};

std::size_t index_of(Channel channel) {
    return static_cast<std::size_t>(channel);
}

} // namespace

Result<std::unique_ptr<DdsTransport>> DdsTransport::open(
    std::shared_ptr<DdsParticipant> participant, std::string_view match, std::uint32_t address) {
    const bool server = participant->role() == DdsRole::server;
    LOCKWIND_ASSERT(server == (address == kServerAddress) && address != kEveryAddress);
    if (!is_match_name(match)) {
        return Error{"match name \"" + std::string(match) +
                     "\": 1 to 64 letters, digits, '-', '_' or '.' are allowed"};
    }
    std::unique_ptr<DdsTransport> self(new DdsTransport);
    self->participant_ = std::move(participant);
    self->address_ = address;
    self->match_id_ = match_id_of(match);
    const Status created = self->create_entities("lockwind/" + std::string(match));
    if (!created) {
        return created.error();
    }
    return self;
}

// Writers before readers, and both before the participant, which other endpoints may hold.
DdsTransport::~DdsTransport() = default;

Status DdsTransport::create_entities(const std::string& partition) {
    const dds_entity_t participant = participant_->participant_.get();
    const Qos qos(dds_create_qos());
    const char* name = partition.c_str();
    dds_qset_partition(qos.get(), 1, &name);
    const std::pair<DdsEntity*, dds_return_t> created[] = {
        {&publisher_, dds_create_publisher(participant, qos.get(), nullptr)},
        {&subscriber_, dds_create_subscriber(participant, qos.get(), nullptr)},
        {&waitset_, dds_create_waitset(participant)},
    };
    for (const auto& [entity, code] : created) {
        *entity = DdsEntity(code);
        if (code < 0) {
            return dds_error("creating a DDS endpoint", code);
        }
    }
    for (const Channel channel : kChannels) {
        Status flow = create_flow(channel);
        if (!flow) {
            return flow;
        }
    }
    return Success{};
}

Status DdsTransport::create_flow(Channel channel) {
    const std::size_t index = index_of(channel);
    const Qos qos = flow_qos(channel);
    Flow& flow = flows_[index];
    dds_return_t code = dds_create_reader(
        subscriber_.get(), participant_->topics_in_[index].get(), qos.get(), nullptr);
    if (code < 0) {
        return dds_error("creating a DDS reader", code);
    }
    flow.reader = DdsEntity(code);
    code = dds_create_writer(
        publisher_.get(), participant_->topics_out_[index].get(), qos.get(), nullptr);
    if (code < 0) {
        return dds_error("creating a DDS writer", code);
    }
    flow.writer = DdsEntity(code);
    code = dds_create_readcondition(flow.reader.get(), DDS_ANY_STATE);
    if (code < 0) {
        return dds_error("creating a DDS read condition", code);
    }
    flow.condition = DdsEntity(code);
    for (const dds_entity_t waitset : {waitset_.get(), participant_->waitset_.get()}) {
        code = dds_waitset_attach(waitset, flow.condition.get(), 0);
        if (code < 0) {
            return dds_error("attaching to a DDS waitset", code);
        }
    }
    return Success{};
}

SendResult DdsTransport::send(std::uint32_t to, Channel channel, std::span<const std::byte> bytes) {
    LOCKWIND_ASSERT(bytes.size() <= kPayloadSizeBytesMax);
    lockwind_Envelope envelope{};
    envelope.match_id = match_id_;
    envelope.sender = address_;
    envelope.receiver = to;
    // Borrowed: dds_write serializes before it returns and does not write to it.
    envelope.payload._buffer =
        const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(bytes.data()));
    envelope.payload._length = static_cast<std::uint32_t>(bytes.size());
    envelope.payload._maximum = envelope.payload._length;
    envelope.payload._release = false;
    if (dds_write(flows_[index_of(channel)].writer.get(), &envelope) < 0) {
        ++counters_.writes_full;
        return SendResult::full;
    }
    ++stats_.packets_out;
    stats_.bytes_out += bytes.size();
    return SendResult::sent;
}

void DdsTransport::receive(std::vector<Packet>& out) {
    for (const Channel channel : kChannels) {
        receive_flow(channel, out);
    }
}

void DdsTransport::receive_flow(Channel channel, std::vector<Packet>& out) {
    constexpr std::uint32_t kBatch = 64;
    const dds_entity_t reader = flows_[index_of(channel)].reader.get();
    std::array<void*, kBatch> samples{}; // all null: DDS lends its own
    std::array<dds_sample_info_t, kBatch> infos;
    std::int32_t count = 0;
    do {
        count = dds_take(reader, samples.data(), infos.data(), kBatch, kBatch);
        for (std::int32_t i = 0; i < count; ++i) {
            const auto row = static_cast<std::size_t>(i);
            if (infos[row].valid_data) {
                accept(*static_cast<const lockwind_Envelope*>(samples[row]),
                       infos[row].publication_handle,
                       channel,
                       out);
            }
        }
        if (count > 0) {
            (void)dds_return_loan(reader, samples.data(), count);
        }
    } while (count == static_cast<std::int32_t>(kBatch));
}

void DdsTransport::accept(const lockwind_Envelope& envelope,
                          std::uint64_t writer,
                          Channel channel,
                          std::vector<Packet>& out) {
    const bool server = address_ == kServerAddress;
    const bool sender_possible =
        server ? envelope.sender != kServerAddress && envelope.sender != kEveryAddress
               : envelope.sender == kServerAddress;
    if (envelope.match_id != match_id_ || !sender_possible ||
        envelope.payload._length > kPayloadSizeBytesMax) {
        ++stats_.packets_malformed;
        return;
    }
    if (!senders_.admit(writer, envelope.sender, [this] { return matched_writers(); })) {
        ++stats_.packets_spoofed;
        return;
    }
    if (envelope.receiver != address_ && (server || envelope.receiver != kEveryAddress)) {
        ++counters_.addressed_elsewhere;
        return;
    }
    const auto* bytes = reinterpret_cast<const std::byte*>(envelope.payload._buffer);
    out.push_back({envelope.sender, channel, {bytes, bytes + envelope.payload._length}});
    ++stats_.packets_in;
    stats_.bytes_in += envelope.payload._length;
}

std::vector<SenderRegistry::Writer> DdsTransport::matched_writers() const {
    std::vector<SenderRegistry::Writer> writers;
    for (const Flow& flow : flows_) {
        const dds_return_t count = dds_get_matched_publications(flow.reader.get(), nullptr, 0);
        if (count <= 0) {
            continue;
        }
        std::vector<dds_instance_handle_t> handles(static_cast<std::size_t>(count));
        const dds_return_t now =
            dds_get_matched_publications(flow.reader.get(), handles.data(), handles.size());
        handles.resize(static_cast<std::size_t>(std::clamp(now, 0, count)));
        for (const dds_instance_handle_t handle : handles) {
            dds_builtintopic_endpoint_t* endpoint =
                dds_get_matched_publication_data(flow.reader.get(), handle);
            if (endpoint != nullptr) {
                writers.push_back({handle, endpoint->participant_instance_handle});
                dds_builtintopic_free_endpoint(endpoint);
            }
        }
    }
    return writers;
}

void DdsTransport::wait_until(std::uint64_t deadline_us) {
    wait_on(waitset_.get(), deadline_us);
}

std::uint64_t DdsTransport::clock_us() const {
    return DdsParticipant::clock_us();
}

std::uint32_t DdsTransport::peer_count() const {
    std::uint32_t count = std::numeric_limits<std::uint32_t>::max();
    for (const Flow& flow : flows_) {
        dds_subscription_matched_status_t writers{};
        dds_publication_matched_status_t readers{};
        (void)dds_get_subscription_matched_status(flow.reader.get(), &writers);
        (void)dds_get_publication_matched_status(flow.writer.get(), &readers);
        count = std::min({count, writers.current_count, readers.current_count});
    }
    return count;
}

Status DdsTransport::compatible() const {
    for (const Flow& flow : flows_) {
        dds_requested_incompatible_qos_status_t requested{};
        dds_offered_incompatible_qos_status_t offered{};
        (void)dds_get_requested_incompatible_qos_status(flow.reader.get(), &requested);
        (void)dds_get_offered_incompatible_qos_status(flow.writer.get(), &offered);
        if (requested.total_count + offered.total_count > 0) {
            const std::uint32_t policy =
                requested.total_count > 0 ? requested.last_policy_id : offered.last_policy_id;
            return Error{"a peer of the match uses another DDS " +
                         std::string(policy_name(policy)) +
                         " policy than this program: the two builds cannot talk"};
        }
    }
    return Success{};
}

} // namespace lockwind
