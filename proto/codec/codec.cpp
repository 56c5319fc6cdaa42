#include "codec/codec.h"

#include "codec/rules.h"
#include "codec/utf8.h"
#include "codec/wire.h"

#include "lockwind/assert.h"

#include <array>
#include <google/protobuf/stubs/logging.h>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

namespace lockwind {
namespace {

/// What is fixed for a kind of message. Its number is its field in wire::Packet.
struct Kind {
    std::uint32_t number = 0;
    std::string_view name;
    Direction direction = Direction::either;
    bool reliable = true;
    std::size_t size_bytes_max = 0; // of the body: refused before it is parsed
};

constexpr std::size_t kFrameSizeBytesMax = 4; // tag, and the length of up to 64,000 bytes
constexpr std::size_t kBodySizeBytesMax = kMessageSizeBytesMax - kFrameSizeBytesMax;
constexpr std::size_t kSmallSizeBytesMax = 256;
constexpr std::size_t kTextsSizeBytesMax = 4'096;
constexpr std::size_t kInputBatchSizeBytesMax =
    kInputBatchTicksMax * kInputSizeBytesMax + kSmallSizeBytesMax;
constexpr std::size_t kHashReportSizeBytesMax = kHashReportEntriesMax * 24 + kSmallSizeBytesMax;

/// By index of the Message variant.
constexpr std::array<Kind, std::variant_size_v<Message>> kKinds = {{
    {1, "Hello", Direction::to_server, true, kTextsSizeBytesMax},
    {2, "Welcome", Direction::to_client, true, kBodySizeBytesMax},
    {3, "Refuse", Direction::to_client, true, kTextsSizeBytesMax},
    {4, "Ready", Direction::to_server, true, kSmallSizeBytesMax},
    {5, "InputBatch", Direction::to_server, false, kInputBatchSizeBytesMax},
    {6, "Confirmation", Direction::to_client, false, kBodySizeBytesMax},
    {7, "HashReport", Direction::to_server, true, kHashReportSizeBytesMax},
    {8, "Chunk", Direction::either, true, kChunkSizeBytesMax + kSmallSizeBytesMax},
    {9, "ChunkAck", Direction::either, true, kSmallSizeBytesMax},
    {10, "DesyncQuery", Direction::to_client, true, kSmallSizeBytesMax},
    {11, "End", Direction::either, true, kTextsSizeBytesMax},
}};

const Kind& kind_of(const Message& message) {
    return kKinds[message.index()];
}

void append_varint(std::uint64_t value, std::vector<std::byte>& out) {
    while (value >= 0x80) {
        out.push_back(static_cast<std::byte>(value | 0x80U));
        value >>= 7U;
    }
    out.push_back(static_cast<std::byte>(value));
}

/// Takes a protobuf varint off the front of `bytes`; none where it is cut off or too long.
std::optional<std::uint64_t> take_varint(std::span<const std::byte>& bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size() && i < 9; ++i) {
        const auto byte = std::to_integer<std::uint64_t>(bytes[i]);
        value |= (byte & 0x7fU) << (7 * i);
        if (byte < 0x80) {
            bytes = bytes.subspan(i + 1);
            return value;
        }
    }
    return std::nullopt;
}

struct Frame {
    std::size_t kind_index = 0;
    std::span<const std::byte> body;
};

constexpr std::uint64_t kLengthDelimited = 2; // protobuf's wire type of a submessage

Result<Frame> read_frame(std::span<const std::byte> bytes) {
    if (bytes.size() > kMessageSizeBytesMax) {
        return Error{"message: has " + std::to_string(bytes.size()) + " bytes, allowed are " +
                     std::to_string(kMessageSizeBytesMax)};
    }
    std::span<const std::byte> rest = bytes;
    const std::optional<std::uint64_t> tag = take_varint(rest);
    const std::optional<std::uint64_t> size = tag ? take_varint(rest) : std::nullopt;
    if (!size) {
        return Error{"message: " + std::to_string(bytes.size()) +
                     " bytes are too short for a kind and a length"};
    }
    if ((*tag & 7U) != kLengthDelimited) {
        return Error{"message: does not begin with a kind"};
    }
    const std::uint64_t number = *tag >> 3U;
    for (std::size_t i = 0; i < kKinds.size(); ++i) {
        const Kind& kind = kKinds[i];
        if (kind.number != number) {
            continue;
        }
        if (*size != rest.size()) {
            return Error{std::string(kind.name) + ": announces " + std::to_string(*size) +
                         " bytes, has " + std::to_string(rest.size())};
        }
        if (rest.size() > kind.size_bytes_max) {
            return Error{std::string(kind.name) + ": has " + std::to_string(rest.size()) +
                         " bytes, allowed are " + std::to_string(kind.size_bytes_max)};
        }
        return Frame{i, rest};
    }
    return Error{"message: unknown kind " + std::to_string(number)};
}

template <class WireMessage, class SessionMessage>
Result<Message> read_body(std::span<const std::byte> body, Rules& rules) {
    WireMessage wire_message;
    {
        // Protobuf would report a peer's malformed text on stderr.
        const google::protobuf::LogSilencer silencer;
        rules.require(wire_message.ParseFromArray(body.data(), static_cast<int>(body.size())),
                      "is not well-formed protobuf, or a text in it is not UTF-8");
    }
    SessionMessage message;
    if (rules.kept()) {
        from_wire(wire_message, rules, message);
    }
    if (rules.kept()) {
        apply_rules(message, rules);
    }
    const Status status = rules.status();
    if (!status) {
        return status.error();
    }
    return Message(std::move(message));
}

using ReadBody = Result<Message> (*)(std::span<const std::byte> body, Rules& rules);

/// By index of the Message variant.
constexpr std::array<ReadBody, std::variant_size_v<Message>> kReaders = {
    read_body<wire::Hello, Hello>,
    read_body<wire::Welcome, Welcome>,
    read_body<wire::Refuse, Refuse>,
    read_body<wire::Ready, Ready>,
    read_body<wire::InputBatch, InputBatch>,
    read_body<wire::Confirmation, Confirmation>,
    read_body<wire::HashReport, HashReport>,
    read_body<wire::Chunk, Chunk>,
    read_body<wire::ChunkAck, ChunkAck>,
    read_body<wire::DesyncQuery, DesyncQuery>,
    read_body<wire::End, End>,
};

template <class WireMessage, class SessionMessage>
void write_body(const SessionMessage& message, std::vector<std::byte>& out) {
    WireMessage wire_message;
    to_wire(message, wire_message);
    const std::size_t size = wire_message.ByteSizeLong();
    LOCKWIND_ASSERT(size <= kBodySizeBytesMax);
    append_varint(size, out);
    const std::size_t begin = out.size();
    out.resize(begin + size);
    const bool written = wire_message.SerializeToArray(out.data() + begin, static_cast<int>(size));
    LOCKWIND_ASSERT(written);
}

struct BodyWriter {
    std::vector<std::byte>& out;

    void operator()(const Hello& m) const { write_body<wire::Hello>(m, out); }
    void operator()(const Welcome& m) const { write_body<wire::Welcome>(m, out); }
    void operator()(const Refuse& m) const { write_body<wire::Refuse>(m, out); }
    void operator()(const Ready& m) const { write_body<wire::Ready>(m, out); }
    void operator()(const InputBatch& m) const { write_body<wire::InputBatch>(m, out); }
    void operator()(const Confirmation& m) const { write_body<wire::Confirmation>(m, out); }
    void operator()(const HashReport& m) const { write_body<wire::HashReport>(m, out); }
    void operator()(const Chunk& m) const { write_body<wire::Chunk>(m, out); }
    void operator()(const ChunkAck& m) const { write_body<wire::ChunkAck>(m, out); }
    void operator()(const DesyncQuery& m) const { write_body<wire::DesyncQuery>(m, out); }
    void operator()(const End& m) const { write_body<wire::End>(m, out); }
};

void encode_checked(const Message& message, std::vector<std::byte>& out) {
    LOCKWIND_ASSERT(check(message).ok());
    out.clear();
    append_varint(std::uint64_t{kind_of(message).number} << 3U | kLengthDelimited, out);
    std::visit(BodyWriter{out}, message);
}

} // namespace

std::string_view kind_name(const Message& message) {
    return kind_of(message).name;
}

bool is_reliable(const Message& message) {
    return kind_of(message).reliable;
}

Status check(const Message& message, const MessageLimits& limits) {
    Rules rules(kind_name(message), limits);
    std::visit([&](const auto& content) { apply_rules(content, rules); }, message);
    return rules.status();
}

void encode(const Message& message, std::vector<std::byte>& out) {
    if (const auto* refuse = std::get_if<Refuse>(&message)) {
        Refuse clean = *refuse;
        clean.message = clean_text(clean.message, kTextSizeBytesMax);
        encode_checked(clean, out);
    } else if (const auto* end = std::get_if<End>(&message)) {
        End clean = *end;
        clean.message = clean_text(clean.message, kTextSizeBytesMax);
        encode_checked(clean, out);
    } else {
        encode_checked(message, out);
    }
}

std::vector<std::byte> encode(const Message& message) {
    std::vector<std::byte> out;
    encode(message, out);
    return out;
}

Result<Message> decode(std::span<const std::byte> bytes, const MessageLimits& limits) {
    const Result<Frame> frame = read_frame(bytes);
    if (!frame) {
        return frame.error();
    }
    const Kind& kind = kKinds[frame.value().kind_index];
    const bool wrong_way = limits.direction != Direction::either &&
                           kind.direction != Direction::either &&
                           kind.direction != limits.direction;
    if (wrong_way) {
        return Error{std::string(kind.name) + ": does not travel " +
                     (limits.direction == Direction::to_server ? "to a server" : "to a client")};
    }
    Rules rules(kind.name, limits);
    return kReaders[frame.value().kind_index](frame.value().body, rules);
}

} // namespace lockwind
