#pragma once

#include "transport/transport.h"

#include <string>
#include <string_view>
#include <vector>

namespace lockwind {

inline std::vector<std::byte> bytes_of(std::string_view text) {
    const auto* data = reinterpret_cast<const std::byte*>(text.data());
    return {data, data + text.size()};
}

/// What `transport` has received, as "from:text", with a '!' behind what came reliably.
inline std::vector<std::string> received(Transport& transport) {
    std::vector<Packet> packets;
    transport.receive(packets);
    std::vector<std::string> texts;
    texts.reserve(packets.size());
    for (const Packet& packet : packets) {
        texts.push_back(
            std::to_string(packet.from) + ":" +
            std::string(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size()) +
            (packet.channel == Channel::reliable ? "!" : ""));
    }
    return texts;
}

using Texts = std::vector<std::string>;

} // namespace lockwind
