#include "codec/codec.h"
#include "messages.pb.h"
#include "tests/unit/codec/sample_messages.h"

#include <functional>
#include <gtest/gtest.h>

namespace lockwind {
namespace {

std::string error_of(const std::vector<std::byte>& bytes, const MessageLimits& limits = {}) {
    const Result<Message> decoded = decode(bytes, limits);
    return decoded.ok() ? "accepted" : decoded.error().message;
}

std::vector<std::byte> bytes_of(const std::string& text) {
    const auto* data = reinterpret_cast<const std::byte*>(text.data());
    return {data, data + text.size()};
}

/// The wire form of a valid sample message, after `edit`: what a peer that ignores the rules sends.
std::vector<std::byte> edited(std::size_t sample, const std::function<void(wire::Packet&)>& edit) {
    const std::vector<std::byte> bytes = encode(sample_messages()[sample]);
    wire::Packet packet;
    EXPECT_TRUE(packet.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
    edit(packet);
    return bytes_of(packet.SerializeAsString());
}

struct Case {
    std::size_t sample;
    std::function<void(wire::Packet&)> edit;
    std::string error;
};

void expect_errors(const std::vector<Case>& cases) {
    for (const Case& broken : cases) {
        EXPECT_EQ(error_of(edited(broken.sample, broken.edit)), broken.error);
    }
}

constexpr std::uint64_t kTickTooLate = (std::uint64_t{1} << 40U) + 1;
const std::string kTickRange = " is 1099511627777, allowed are 0 .. 1099511627776";

TEST(CodecLimits, RefusesHello) {
    const auto hello = [](wire::Packet& packet) -> wire::Hello& { return *packet.mutable_hello(); };
    expect_errors({
        {0,
         [&](auto& p) { hello(p).set_sim_version(std::string(65, 'v')); },
         "Hello: sim_version has 65 bytes, allowed are 64"},
        {0,
         [&](auto& p) { hello(p).set_build_info(std::string(1025, 'v')); },
         "Hello: build_info has 1025 bytes, allowed are 1024"},
        {0,
         [&](auto& p) { hello(p).set_build_info(std::string(5000, 'v')); },
         "Hello: has 5026 bytes, allowed are 4096"},
    });
}

TEST(CodecLimits, RefusesWelcome) {
    const auto welcome = [](wire::Packet& p) -> wire::Welcome& { return *p.mutable_welcome(); };
    const auto config = [](wire::Packet& p) -> wire::MatchConfig& {
        return *p.mutable_welcome()->mutable_config();
    };
    expect_errors({
        {1, [&](auto& p) { welcome(p).clear_config(); }, "Welcome: config is missing"},
        {1, [&](auto& p) { welcome(p).set_slot(64); }, "Welcome: slot is 64, allowed are 0 .. 63"},
        {1,
         [&](auto& p) { welcome(p).set_resume_tick(kTickTooLate); },
         "Welcome: resume_tick" + kTickRange},
        {1,
         [&](auto& p) { config(p).set_ticks(kTickTooLate); },
         "Welcome: config.ticks" + kTickRange},
        {1,
         [&](auto& p) { config(p).set_match(std::string(65, 'm')); },
         "Welcome: config.match has 65 bytes, allowed are 64"},
        {1,
         [&](auto& p) { config(p).set_mode(std::string(65, 'm')); },
         "Welcome: config.mode has 65 bytes, allowed are 64"},
        {1,
         [&](auto& p) { config(p).set_scene_name(std::string(257, 'm')); },
         "Welcome: config.scene_name has 257 bytes, allowed are 256"},
        {1,
         [&](auto& p) { config(p).set_scene_text(std::string(60'001, 'm')); },
         "Welcome: config.scene_text has 60001 bytes, allowed are 60000"},
        {1,
         [&](auto& p) { config(p).set_tick_rate_hz(0); },
         "Welcome: config.tick_rate_hz is 0, allowed are 1 .. 1000"},
        {1,
         [&](auto& p) { config(p).set_tick_rate_hz(1'001); },
         "Welcome: config.tick_rate_hz is 1001, allowed are 1 .. 1000"},
        {1,
         [&](auto& p) { config(p).set_players(0); },
         "Welcome: config.players is 0, allowed are 1 .. 64"},
        {1,
         [&](auto& p) { config(p).set_players(65); },
         "Welcome: config.players is 65, allowed are 1 .. 64"},
        {1,
         [&](auto& p) { config(p).set_input_delay_ticks(31); },
         "Welcome: config.input_delay_ticks is 31, allowed are 0 .. 30"},
        {1,
         [&](auto& p) { config(p).set_hash_interval_ticks(61); },
         "Welcome: config.hash_interval_ticks is 61, allowed are 1 .. 60"},
    });
}

TEST(CodecLimits, RefusesEnumsOutOfRange) {
    expect_errors({
        {2,
         [](auto& p) { p.mutable_refuse()->set_reason(static_cast<wire::RefuseReason>(7)); },
         "Refuse: reason is 7, allowed are 0 .. 6"},
        {2,
         [](auto& p) { p.mutable_refuse()->set_reason(static_cast<wire::RefuseReason>(-1)); },
         "Refuse: reason is 4294967295, allowed are 0 .. 6"},
        {2,
         [](auto& p) { p.mutable_refuse()->set_reason(static_cast<wire::RefuseReason>(256)); },
         "Refuse: reason is 256, allowed are 0 .. 6"},
        {7,
         [](auto& p) { p.mutable_chunk()->set_kind(static_cast<wire::BlobKind>(2)); },
         "Chunk: kind is 2, allowed are 0 .. 1"},
        {10,
         [](auto& p) { p.mutable_end()->set_reason(static_cast<wire::EndReason>(6)); },
         "End: reason is 6, allowed are 0 .. 5"},
    });
}

TEST(CodecLimits, RefusesTextsThatAreTooLong) {
    expect_errors({
        {2,
         [](auto& p) { p.mutable_refuse()->set_field(std::string(65, 'x')); },
         "Refuse: field has 65 bytes, allowed are 64"},
        {2,
         [](auto& p) { p.mutable_refuse()->set_message(std::string(1025, 'x')); },
         "Refuse: message has 1025 bytes, allowed are 1024"},
        {10,
         [](auto& p) { p.mutable_end()->set_message(std::string(1025, 'x')); },
         "End: message has 1025 bytes, allowed are 1024"},
    });
}

TEST(CodecLimits, RefusesTicksTooFarAway) {
    expect_errors({
        {3, [](auto& p) { p.mutable_ready()->set_tick(kTickTooLate); }, "Ready: tick" + kTickRange},
        {4,
         [](auto& p) { p.mutable_input_batch()->set_first_tick(kTickTooLate); },
         "InputBatch: first_tick" + kTickRange},
        {4,
         [](auto& p) { p.mutable_input_batch()->set_confirmed_tick(kTickTooLate); },
         "InputBatch: confirmed_tick" + kTickRange},
        {5,
         [](auto& p) { p.mutable_confirmation()->set_first_tick(kTickTooLate); },
         "Confirmation: first_tick" + kTickRange},
        {5,
         [](auto& p) { p.mutable_confirmation()->set_confirmed_tick(kTickTooLate); },
         "Confirmation: confirmed_tick" + kTickRange},
        {5,
         [](auto& p) { p.mutable_confirmation()->mutable_acks(0)->set_input_tick(kTickTooLate); },
         "Confirmation: acks.input_tick" + kTickRange},
        {5,
         [](auto& p) { p.mutable_confirmation()->mutable_acks(1)->set_hash_tick(kTickTooLate); },
         "Confirmation: acks.hash_tick" + kTickRange},
        {6,
         [](auto& p) { p.mutable_hash_report()->mutable_entries(1)->set_tick(kTickTooLate); },
         "HashReport: entries.tick" + kTickRange},
        {9,
         [](auto& p) { p.mutable_desync_query()->set_bad_tick(kTickTooLate); },
         "DesyncQuery: bad_tick" + kTickRange},
        {10,
         [](auto& p) { p.mutable_end()->set_last_tick(~std::uint64_t{0}); },
         "End: last_tick is 18446744073709551615, allowed are 0 .. 1099511627776"},
    });
}

TEST(CodecLimits, RefusesInputBatch) {
    const auto batch = [](wire::Packet& p) -> wire::InputBatch& {
        return *p.mutable_input_batch();
    };
    expect_errors({
        {4, [&](auto& p) { batch(p).set_slot(64); }, "InputBatch: slot is 64, allowed are 0 .. 63"},
        {4,
         [&](auto& p) { batch(p).set_tick_count(129); },
         "InputBatch: tick_count is 129, allowed are 0 .. 128"},
        {4,
         [&](auto& p) { batch(p).set_input_size_bytes(33); },
         "InputBatch: input_size_bytes is 33, allowed are 0 .. 32"},
        {4,
         [&](auto& p) { batch(p).mutable_inputs()->pop_back(); },
         "InputBatch: bytes of inputs is 17, expected tick_count x input_size_bytes = 18"},
        {4,
         [&](auto& p) { batch(p).set_inputs(std::string(5'000, 'i')); },
         "InputBatch: has 5020 bytes, allowed are 4352"},
    });
}

TEST(CodecLimits, RefusesConfirmation) {
    const auto confirmation = [](wire::Packet& p) -> wire::Confirmation& {
        return *p.mutable_confirmation();
    };
    const std::string product = "tick_count x slot_count x input_size_bytes = ";
    expect_errors({
        {5,
         [&](auto& p) { confirmation(p).set_tick_count(1'025); },
         "Confirmation: tick_count is 1025, allowed are 0 .. 1024"},
        {5,
         [&](auto& p) { confirmation(p).set_slot_count(65); },
         "Confirmation: slot_count is 65, allowed are 1 .. 64"},
        {5,
         [&](auto& p) { confirmation(p).set_slot_count(0); },
         "Confirmation: slot_count is 0, allowed are 1 .. 64"},
        {5,
         [&](auto& p) { confirmation(p).set_input_size_bytes(33); },
         "Confirmation: input_size_bytes is 33, allowed are 0 .. 32"},
        {5,
         [&](auto& p) { confirmation(p).set_tick_count(3); },
         "Confirmation: bytes of inputs is 24, expected " + product + "36"},
        {5,
         [&](auto& p) { confirmation(p).mutable_statuses()->push_back(0); },
         "Confirmation: bytes of statuses is 5, expected tick_count x slot_count = 4"},
        {5,
         [&](auto& p) { (*confirmation(p).mutable_statuses())[1] = 3; },
         "Confirmation: status is 3, allowed are 0 .. 2"},
        {5,
         [&](auto& p) {
             for (int i = 0; i < 63; ++i) {
                 confirmation(p).add_acks();
             }
         },
         "Confirmation: acks is 65, allowed are 0 .. 64"},
        {5,
         [&](auto& p) {
             confirmation(p).Clear();
             confirmation(p).set_tick_count(1'024);
             confirmation(p).set_slot_count(64);
         },
         "Confirmation: bytes of statuses is 0, expected tick_count x slot_count = 65536"},
    });
}

TEST(CodecLimits, RefusesHashReport) {
    expect_errors({
        {6,
         [](auto& p) { p.mutable_hash_report()->set_slot(64); },
         "HashReport: slot is 64, allowed are 0 .. 63"},
        {6,
         [](auto& p) {
             for (int i = 0; i < 255; ++i) {
                 p.mutable_hash_report()->add_entries();
             }
         },
         "HashReport: entries is 257, allowed are 0 .. 256"},
    });
}

TEST(CodecLimits, RefusesChunk) {
    const auto chunk = [](wire::Packet& p) -> wire::Chunk& { return *p.mutable_chunk(); };
    expect_errors({
        {7,
         [&](auto& p) { chunk(p).set_transfer(0); },
         "Chunk: transfer is 0; transfers count from 1"},
        {7, [&](auto& p) { chunk(p).set_index(3); }, "Chunk: index is not below count"},
        {7, [&](auto& p) { chunk(p).set_count(2); }, "Chunk: count is 2, allowed are 3 .. 150000"},
        {7,
         [&](auto& p) { chunk(p).set_count(150'001); },
         "Chunk: count is 150001, allowed are 3 .. 150000"},
        {7,
         [&](auto& p) { chunk(p).set_blob_size_bytes((64U << 20U) + 1); },
         "Chunk: blob_size_bytes is 67108865, allowed are 0 .. 67108864"},
        {7,
         [&](auto& p) { chunk(p).set_bytes(std::string(60'001, 'b')); },
         "Chunk: bytes is 60001, allowed are 0 .. 60000"},
        {7,
         [&](auto& p) {
             chunk(p).set_blob_size_bytes(1);
             chunk(p).set_count(1);
             chunk(p).set_index(0);
         },
         "Chunk: bytes has more bytes than the blob"},
        {8,
         [](auto& p) { p.mutable_chunk_ack()->set_transfer(0); },
         "ChunkAck: transfer is 0; transfers count from 1"},
        {8,
         [](auto& p) { p.mutable_chunk_ack()->set_index((64U << 20U) + 1); },
         "ChunkAck: index is 67108865, allowed are 0 .. 67108864"},
    });
}

TEST(CodecLimits, RefusesDesyncQuery) {
    const auto query = [](wire::Packet& p) -> wire::DesyncQuery& {
        return *p.mutable_desync_query();
    };
    expect_errors({
        {9,
         [&](auto& p) { query(p).set_bad_tick(597); },
         "DesyncQuery: bad_tick is not after agreed_tick"},
        {9,
         [&](auto& p) { query(p).set_bad_tick(597 + 65'537); },
         "DesyncQuery: bad_tick - agreed_tick is 65537, allowed are 0 .. 65536"},
    });
}

TEST(CodecLimits, RefusesBytesThatAreNoMessage) {
    EXPECT_EQ(error_of({}), "message: 0 bytes are too short for a kind and a length");
    EXPECT_EQ(error_of(bytes_of("\x0a")), "message: 1 bytes are too short for a kind and a length");
    EXPECT_EQ(error_of(bytes_of("\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff")),
              "message: 11 bytes are too short for a kind and a length");
    EXPECT_EQ(error_of(bytes_of(std::string("\x08\x00", 2))),
              "message: does not begin with a kind");
    EXPECT_EQ(error_of(bytes_of(std::string("\x62\x00", 2))), "message: unknown kind 12");
    EXPECT_EQ(error_of(bytes_of(std::string("\x02\x00", 2))), "message: unknown kind 0");
    EXPECT_EQ(error_of(bytes_of(std::string("\xfa\xff\xff\xff\x7f\x00", 6))),
              "message: unknown kind 4294967295");
    EXPECT_EQ(error_of(bytes_of("\x22\x05xyz")), "Ready: announces 5 bytes, has 3");
    EXPECT_EQ(error_of(bytes_of("\x22\x02xyz")), "Ready: announces 2 bytes, has 3");
    EXPECT_EQ(error_of(bytes_of("\x22\x01\x07")),
              "Ready: is not well-formed protobuf, or a text in it is not UTF-8");
    EXPECT_EQ(error_of(bytes_of("\x0a\x03\x12\x01\xff")),
              "Hello: is not well-formed protobuf, or a text in it is not UTF-8");
    EXPECT_EQ(error_of(std::vector<std::byte>(64'001)),
              "message: has 64001 bytes, allowed are 64000");
}

TEST(CodecLimits, RefusesMessagesThatTravelTheOtherWay) {
    MessageLimits at_server;
    at_server.direction = Direction::to_server;
    MessageLimits at_client;
    at_client.direction = Direction::to_client;
    // By kind: H hello .. E end; what each side accepts.
    const std::vector<bool> to_server = {
        true, false, false, true, true, false, true, true, true, false, true};
    const std::vector<bool> to_client = {
        false, true, true, false, false, true, false, true, true, true, true};
    const std::vector<Message> messages = sample_messages();
    for (std::size_t i = 0; i < messages.size(); ++i) {
        const std::string name(kind_name(messages[i]));
        EXPECT_EQ(error_of(encode(messages[i]), at_server),
                  to_server[i] ? "accepted" : name + ": does not travel to a server");
        EXPECT_EQ(error_of(encode(messages[i]), at_client),
                  to_client[i] ? "accepted" : name + ": does not travel to a client");
    }
}

TEST(CodecLimits, FollowsTheReceiversLimits) {
    MessageLimits limits;
    limits.players_max = 3;
    EXPECT_EQ(error_of(encode(Welcome{3, sample_config(), "", "", 0, 0, 1}), limits),
              "Welcome: slot is 3, allowed are 0 .. 2");
    limits.blob_size_bytes_max = 100;
    EXPECT_EQ(error_of(encode(sample_messages()[7]), limits),
              "Chunk: blob_size_bytes is 150000, allowed are 0 .. 100");
    limits.tick_max = 10;
    EXPECT_EQ(error_of(encode(Ready{11, 0}), limits), "Ready: tick is 11, allowed are 0 .. 10");
    limits.query_ticks_max = 1;
    EXPECT_EQ(error_of(encode(DesyncQuery{1, 3, 0, 0}), limits),
              "DesyncQuery: bad_tick - agreed_tick is 2, allowed are 0 .. 1");
}

TEST(CodecLimits, ChecksBeforeSendingToo) {
    EXPECT_TRUE(check(sample_messages()[1]).ok());
    Welcome large{0, sample_config(), "", "", 0, 0, 1};
    large.config.scene_text.assign(60'001, ' ');
    EXPECT_EQ(check(large).error().message,
              "Welcome: config.scene_text has 60001 bytes, allowed are 60000");
    large.config.scene_text = "\xff";
    EXPECT_EQ(check(large).error().message, "Welcome: config.scene_text is not UTF-8");
    Confirmation confirmation;
    confirmation.ticks.assign(
        1'000, {std::vector<SlotInput>(8, sample_input(InputStatus::confirmed, 1, 32))});
    EXPECT_EQ(check(confirmation).error().message,
              "Confirmation: size in bytes is 264064, allowed are 0 .. 64000");
    confirmation.ticks.resize(2);
    confirmation.ticks[1].inputs.pop_back();
    EXPECT_EQ(check(confirmation).error().message,
              "Confirmation: inputs of a tick is 7, expected slot_count = 8");
    confirmation.ticks = {{{sample_input(InputStatus::predicted, 1, 1)}}};
    EXPECT_EQ(check(confirmation).error().message, "Confirmation: status is 3, allowed are 0 .. 2");
}

TEST(CodecLimitsDeathTest, AssertsOnACallersMisuse) {
    EXPECT_DEATH((void)encode(DesyncQuery{5, 5, 0, 0}), "check");
}

} // namespace
} // namespace lockwind
