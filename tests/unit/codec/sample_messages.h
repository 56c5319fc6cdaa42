#pragma once

#include "codec/codec.h"

#include <array>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

namespace lockwind {

/// An input whose first `size` bytes are first, first + 1, ...
inline SlotInput sample_input(InputStatus status, std::uint8_t first, std::size_t size) {
    SlotInput input;
    input.status = status;
    for (std::size_t i = 0; i < size; ++i) {
        input.bytes[i] = static_cast<std::uint8_t>(first + i);
    }
    return input;
}

inline MatchConfig sample_config() {
    MatchConfig config;
    config.match = "match-7";
    config.mode = "lockstep";
    config.scene_name = "arena";
    config.scene_text = "body { id: 1 } # \xc3\xa9";
    config.seed = 0x0123456789abcdefU;
    config.tick_rate_hz = 120;
    config.players = 4;
    config.input_delay_ticks = 3;
    config.hash_interval_ticks = 5;
    config.ticks = 1200;
    return config;
}

/// One message of every kind, no field at its default.
inline std::vector<Message> sample_messages() {
    const auto hash = [](std::uint64_t i) { return 0xf1e2d3c4b5a69780U + i; };
    using S = InputStatus;
    return {
        Hello{7, "sim-1a2b", "g++ 12 x86-64", 0xfedcba9876543210U, 2},
        Welcome{3, sample_config(), "sim-1a2b", "clang 14 s390x", 600, 9, 2},
        Refuse{RefuseReason::config, "config.seed", "yours 1, mine 2"},
        Ready{600, hash(0)},
        InputBatch{3,
                   598,
                   {sample_input(S::confirmed, 1, 6),
                    sample_input(S::confirmed, 0x80, 4),
                    sample_input(S::confirmed, 0, 0)},
                   597,
                   123'456'789},
        Confirmation{598,
                     600,
                     {{{sample_input(S::confirmed, 1, 6), sample_input(S::substituted, 9, 2)}},
                      {{sample_input(S::confirmed, 0x80, 4), sample_input(S::disconnected, 0, 0)}}},
                     {{601, 590, 123'456'789, 1'500, true}, {599, 588, 1, 20, true}}},
        HashReport{3, {{598, hash(1)}, {599, hash(2)}}},
        Chunk{BlobKind::desync_report, 2, 1, 3, 150'000, {std::byte{0xde}, std::byte{0xad}}},
        ChunkAck{2, 1},
        DesyncQuery{597, 599, hash(3), hash(4)},
        End{EndReason::dropped, 1199, 2, "no input for 2000 ms"},
    };
}

/// All fields. The structured bindings stop compiling when a message gets another one.
inline auto fields(const Hello& m) {
    const auto& [a, b, c, d, e] = m;
    return std::tie(a, b, c, d, e);
}
inline auto fields(const MatchConfig& m) {
    const auto& [a, b, c, d, e, f, g, h, i, j] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j);
}
static_assert(std::tuple_size_v<decltype(fields(MatchConfig{}))> == 10, "sample_config sets all");
inline auto fields(const Welcome& m) {
    const auto& [a, b, c, d, e, f, g] = m;
    return std::tie(a, b, c, d, e, f, g);
}
inline auto fields(const Refuse& m) {
    const auto& [a, b, c] = m;
    return std::tie(a, b, c);
}
inline auto fields(const Ready& m) {
    const auto& [a, b] = m;
    return std::tie(a, b);
}
inline auto fields(const InputBatch& m) {
    const auto& [a, b, c, d, e] = m;
    return std::tie(a, b, c, d, e);
}
inline auto fields(const Confirmation& m) {
    const auto& [a, b, c, d] = m;
    return std::tie(a, b, c, d);
}
inline auto fields(const HashReport& m) {
    const auto& [a, b] = m;
    return std::tie(a, b);
}
inline auto fields(const Chunk& m) {
    const auto& [a, b, c, d, e, f] = m;
    return std::tie(a, b, c, d, e, f);
}
inline auto fields(const ChunkAck& m) {
    const auto& [a, b] = m;
    return std::tie(a, b);
}
inline auto fields(const DesyncQuery& m) {
    const auto& [a, b, c, d] = m;
    return std::tie(a, b, c, d);
}
inline auto fields(const End& m) {
    const auto& [a, b, c, d] = m;
    return std::tie(a, b, c, d);
}

inline bool operator==(const ConfirmedTick& a, const ConfirmedTick& b) {
    return a.inputs == b.inputs;
}
inline auto fields(const SlotAck& m) {
    const auto& [a, b, c, d, e] = m;
    return std::tie(a, b, c, d, e);
}
inline bool operator==(const SlotAck& a, const SlotAck& b) {
    return fields(a) == fields(b);
}
inline bool operator==(const HashReport::Entry& a, const HashReport::Entry& b) {
    return a.tick == b.tick && a.hash == b.hash;
}

inline bool same(const Message& a, const Message& b) {
    return a.index() == b.index() && std::visit(
                                         [&](const auto& content) {
                                             using Content = std::decay_t<decltype(content)>;
                                             return fields(content) == fields(std::get<Content>(b));
                                         },
                                         a);
}

inline std::string hex(const std::vector<std::byte>& bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const std::byte byte : bytes) {
        text += kDigits[std::to_integer<std::size_t>(byte >> 4)];
        text += kDigits[std::to_integer<std::size_t>(byte & std::byte{15})];
    }
    return text;
}

} // namespace lockwind
