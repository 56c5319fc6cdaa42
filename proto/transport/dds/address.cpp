#include "transport/dds/address.h"

#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <ifaddrs.h>
#include <memory>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>

namespace lockwind {
namespace {

std::string dotted(const sockaddr_in& address) {
    std::array<char, INET_ADDRSTRLEN> text{};
    inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
    return text.data();
}

std::string system_message(int code) {
    return std::generic_category().message(code);
}

} // namespace

Result<std::string> resolve_ipv4(const std::string& host) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    const int code = getaddrinfo(host.c_str(), nullptr, &hints, &found);
    if (code != 0) {
        return Error{"server address \"" + host + "\": " + gai_strerror(code) +
                     "; give an IPv4 address or a host name that has one"};
    }
    sockaddr_in address{};
    std::memcpy(&address, found->ai_addr, sizeof address);
    freeaddrinfo(found);
    return dotted(address);
}

Result<std::string> local_address_towards(const std::string& address) {
    sockaddr_in remote{};
    remote.sin_family = AF_INET;
    remote.sin_port = htons(1); // any: connecting a datagram socket sends nothing
    sockaddr_in local{};
    socklen_t local_size = sizeof local;
    const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const bool ok = fd >= 0 && inet_pton(AF_INET, address.c_str(), &remote.sin_addr) == 1 &&
                    connect(fd, reinterpret_cast<const sockaddr*>(&remote), sizeof remote) == 0 &&
                    getsockname(fd, reinterpret_cast<sockaddr*>(&local), &local_size) == 0;
    const int code = errno;
    if (fd >= 0) {
        close(fd);
    }
    if (!ok) {
        return Error{"no network interface leads to " + address + ": " + system_message(code)};
    }
    return dotted(local);
}

bool is_local_interface(const std::string& name) {
    ifaddrs* list = nullptr;
    if (getifaddrs(&list) != 0) {
        return false;
    }
    const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
    for (const ifaddrs* it = list; it != nullptr; it = it->ifa_next) {
        if (it->ifa_addr == nullptr || it->ifa_addr->sa_family != AF_INET) {
            continue;
        }
        sockaddr_in address{};
        std::memcpy(&address, it->ifa_addr, sizeof address);
        if (name == it->ifa_name || name == dotted(address)) {
            return true;
        }
    }
    return false;
}

} // namespace lockwind
