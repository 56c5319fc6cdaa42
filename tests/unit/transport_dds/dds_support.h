#pragma once

#include "transport/dds/dds_transport.h"

#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

namespace lockwind {

inline constexpr std::uint32_t kFirstDomain = 40;
inline constexpr std::uint32_t kDomainCount = 21;
inline constexpr std::uint64_t kPatienceUs = 20'000'000; // only a failing test waits this long

inline Result<std::shared_ptr<DdsParticipant>> open(DdsRole role, std::uint32_t domain) {
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
inline ServerOnDomain open_server() {
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

inline std::shared_ptr<DdsParticipant> open_client(std::uint32_t domain) {
    Result<std::shared_ptr<DdsParticipant>> opened = open(DdsRole::client, domain);
    EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : opened.error().message);
    return opened.ok() ? std::move(opened).value() : nullptr;
}

inline std::unique_ptr<DdsTransport> endpoint(const std::shared_ptr<DdsParticipant>& owner,
                                              const std::string& match,
                                              std::uint32_t address) {
    Result<std::unique_ptr<DdsTransport>> opened = DdsTransport::open(owner, match, address);
    EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : opened.error().message);
    return opened.ok() ? std::move(opened).value() : nullptr;
}

inline std::vector<std::byte> bytes_of(std::string_view text) {
    const auto* data = reinterpret_cast<const std::byte*>(text.data());
    return {data, data + text.size()};
}

inline std::string text_of(const Packet& packet) {
    return {reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size()};
}

/// Waits on `owner` until `done`, or until patience ends.
inline bool wait_for(DdsParticipant& owner, const std::function<bool()>& done) {
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
inline std::vector<Packet>
collect(DdsParticipant& owner, DdsTransport& transport, std::size_t count) {
    std::vector<Packet> packets;
    wait_for(owner, [&] {
        transport.receive(packets);
        return packets.size() >= count;
    });
    return packets;
}

} // namespace lockwind
