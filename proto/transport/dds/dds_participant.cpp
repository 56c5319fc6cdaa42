#include "transport/dds/dds_participant.h"

#include "envelope.h"
#include "transport/dds/address.h"
#include "transport/dds/dds_error.h"
#include "transport/dds/wait.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <dds/dds.h>

namespace lockwind {
namespace {

struct Topology {
    DdsRole role = DdsRole::client;
    std::uint32_t domain = 0;
    std::string interface;      // name or IPv4 address
    std::string server_address; // IPv4, a client's only
};

bool is_ipv4(const std::string& text) {
    return text.find_first_not_of("0123456789.") == std::string::npos;
}

/// A star: the server at a fixed port, a client with the server as its only peer, no multicast. The
/// write cache is large and of fixed size, so that one stopped reader does not stall a shared
/// writer.
std::string domain_xml(const Topology& topology) {
    std::string xml = "<CycloneDDS><Domain><General><Interfaces><NetworkInterface ";
    xml += is_ipv4(topology.interface) ? "address=\"" : "name=\"";
    xml += topology.interface + "\"/></Interfaces><AllowMulticast>false</AllowMulticast></General>";
    xml += "<Discovery><ExternalDomainId>" + std::to_string(topology.domain);
    xml += "</ExternalDomainId><SPDPInterval>250ms</SPDPInterval>"
           "<LeaseDuration>2s</LeaseDuration>";
    if (topology.role == DdsRole::server) {
        xml += "<ParticipantIndex>0</ParticipantIndex>";
    } else {
        xml += "<ParticipantIndex>none</ParticipantIndex><Peers><Peer Address=\"";
        xml += topology.server_address + ":" + std::to_string(dds_server_port(topology.domain));
        xml += "\"/></Peers>";
    }
    xml += "</Discovery><Internal><Watermarks><WhcHigh>16MB</WhcHigh>"
           "<WhcHighInit>16MB</WhcHighInit><WhcAdaptive>false</WhcAdaptive></Watermarks>"
           "<NackDelay>10ms</NackDelay></Internal></Domain></CycloneDDS>";
    return xml;
}

Result<Topology> resolve(const DdsSettings& settings) {
    if (settings.domain < 1 || settings.domain > kDdsDomainMax) {
        return Error{"DDS domain " + std::to_string(settings.domain) + " is not in 1 .. " +
                     std::to_string(kDdsDomainMax)};
    }
    Topology topology{settings.role, settings.domain, settings.interface, ""};
    if (settings.role == DdsRole::client) {
        Result<std::string> server = resolve_ipv4(settings.server_address);
        if (!server) {
            return server.error();
        }
        topology.server_address = server.value();
        if (topology.interface.empty()) {
            Result<std::string> local = local_address_towards(topology.server_address);
            if (!local) {
                return local.error();
            }
            topology.interface = local.value();
        }
    } else if (topology.interface.empty()) {
        topology.interface = "lo";
    }
    // Also keeps anything out of the XML that is not a name.
    if (!is_local_interface(topology.interface)) {
        return Error{"\"" + topology.interface +
                     "\" is no network interface of this machine that has an IPv4 address, and no "
                     "such address"};
    }
    return topology;
}

/// Cyclone allows one domain object per id and process. The id on the wire is ExternalDomainId; the
/// one in here is the first that is free, so that a process may hold a server and clients of one
/// domain.
Result<DdsEntity> create_domain(const Topology& topology) {
    constexpr std::uint32_t kDomainsPerProcessMax = 64;
    const std::string xml = domain_xml(topology);
    dds_return_t code = DDS_RETCODE_ERROR;
    for (std::uint32_t i = 0; i < kDomainsPerProcessMax; ++i) {
        code = dds_create_domain(topology.domain + i * (kDdsDomainMax + 1), xml.c_str());
        if (code != DDS_RETCODE_PRECONDITION_NOT_MET) {
            break;
        }
    }
    if (code < 0) {
        return dds_error("creating the DDS domain", code);
    }
    return DdsEntity(code);
}

Error open_error(const Topology& topology, const Error& cause, const std::string& log) {
    std::string message =
        "DDS domain " + std::to_string(topology.domain) + " on " + topology.interface + ": ";
    if (topology.role == DdsRole::server) {
        message += "UDP port " + std::to_string(dds_server_port(topology.domain)) +
                   " cannot be opened; if another server runs on this domain, choose another with "
                   "--domain. ";
    }
    message += "(" + cause.message;
    std::string first_line = log.substr(0, log.find('\n'));
    if (!first_line.empty()) {
        message += "; " + first_line;
    }
    return Error{message + ")"};
}

constexpr std::array<const char*, 2> kClientTopics = {"lockwind_c2s_best_effort",
                                                      "lockwind_c2s_reliable"};
constexpr std::array<const char*, 2> kServerTopics = {"lockwind_s2c_best_effort",
                                                      "lockwind_s2c_reliable"};

} // namespace

Result<std::shared_ptr<DdsParticipant>> DdsParticipant::open(const DdsSettings& settings) {
    const Result<Topology> resolved = resolve(settings);
    if (!resolved) {
        return resolved.error();
    }
    const Topology& topology = resolved.value();
    const DdsLogCapture log;
    std::shared_ptr<DdsParticipant> self(new DdsParticipant);
    self->role_ = settings.role;
    Result<DdsEntity> domain = create_domain(topology);
    if (!domain) {
        return open_error(topology, domain.error(), log.text());
    }
    self->domain_ = std::move(domain).value();
    const Status created = self->create_entities();
    if (!created) {
        return open_error(topology, created.error(), log.text());
    }
    return self;
}

Status DdsParticipant::create_entities() {
    dds_domainid_t id = 0;
    dds_return_t code = dds_get_domainid(domain_.get(), &id);
    if (code < 0) {
        return dds_error("reading the DDS domain's id", code);
    }
    code = dds_create_participant(id, nullptr, nullptr);
    if (code < 0) {
        return dds_error("creating the DDS participant", code);
    }
    participant_ = DdsEntity(code);
    const bool server = role_ == DdsRole::server;
    for (std::size_t channel = 0; channel < 2; ++channel) {
        const char* client_topic = kClientTopics[channel];
        const char* server_topic = kServerTopics[channel];
        for (const bool out : {false, true}) {
            const char* name = server == out ? server_topic : client_topic;
            code = dds_create_topic(
                participant_.get(), &lockwind_Envelope_desc, name, nullptr, nullptr);
            if (code < 0) {
                return dds_error("creating the DDS topic", code);
            }
            (out ? topics_out_ : topics_in_)[channel] = DdsEntity(code);
        }
    }
    code = dds_create_waitset(participant_.get());
    if (code < 0) {
        return dds_error("creating the DDS waitset", code);
    }
    waitset_ = DdsEntity(code);
    return Success{};
}

// Deleting the domain deletes the participant and all below it in one go, and says farewell to
// peers.
DdsParticipant::~DdsParticipant() {
    domain_.reset();
}

void DdsParticipant::wait_until(std::uint64_t deadline_us) {
    wait_on(waitset_.get(), deadline_us);
}

std::uint64_t DdsParticipant::clock_us() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

} // namespace lockwind
