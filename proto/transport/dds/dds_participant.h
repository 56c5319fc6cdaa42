#pragma once

#include "transport/dds/dds_entity.h"

#include "lockwind/result.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>

namespace lockwind {

enum class DdsRole : std::uint8_t { server = 0, client = 1 };

inline constexpr std::uint32_t kDdsDomainDefault = 1;
inline constexpr std::uint32_t kDdsDomainMax = 100; // ports of higher ones are the system's own

struct DdsSettings {
    DdsRole role = DdsRole::client;
    std::uint32_t domain = kDdsDomainDefault; // 1 .. kDdsDomainMax; one server each
    /// Network interface by name or IPv4 address. "": lo for a server, the one that leads to the
    /// server for a client.
    std::string interface;
    std::string server_address = "127.0.0.1"; // IPv4 address or host name; a client's only peer
};

/// The UDP port a server of `domain` is discovered at.
constexpr std::uint32_t dds_server_port(std::uint32_t domain) {
    return 7'410 + 250 * domain;
}

/// A process's place on a DDS domain; its endpoints (DdsTransport) share it and keep it alive. Owns
/// the domain, its threads and sockets, which live until the last endpoint and the last pointer are
/// gone.
class DdsParticipant {
public:
    /// An Error where the interface or the server's name does not exist, or the domain has a server
    /// already on this machine.
    static Result<std::shared_ptr<DdsParticipant>> open(const DdsSettings& settings);

    DdsParticipant(const DdsParticipant&) = delete;
    DdsParticipant& operator=(const DdsParticipant&) = delete;
    ~DdsParticipant();

    DdsRole role() const { return role_; }

    /// Waits for all endpoints of this participant at once: returns when something has arrived for
    /// one of them or at `deadline_us` (clock_us()).
    void wait_until(std::uint64_t deadline_us);
    /// CLOCK_MONOTONIC, us.
    static std::uint64_t clock_us();

private:
    friend class DdsTransport;
    DdsParticipant() = default;
    Status create_entities();

    DdsRole role_ = DdsRole::client;
    DdsEntity domain_;
    DdsEntity participant_;
    /// By Channel: what this role writes, what it reads.
    std::array<DdsEntity, 2> topics_out_;
    std::array<DdsEntity, 2> topics_in_;
    DdsEntity waitset_;
};

} // namespace lockwind
