#include "codec/codec.h"
#include "messages.pb.h"
#include "tests/unit/codec/sample_messages.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

TEST(Codec, GivesBackEveryFieldOfEveryMessage) {
    const std::vector<Message> messages = sample_messages();
    ASSERT_EQ(messages.size(), std::variant_size_v<Message>);
    for (std::size_t i = 0; i < messages.size(); ++i) {
        ASSERT_EQ(messages[i].index(), i) << "one sample of each kind";
        const Result<Message> decoded = decode(encode(messages[i]));
        ASSERT_TRUE(decoded.ok()) << decoded.error().message;
        EXPECT_TRUE(same(decoded.value(), messages[i])) << kind_name(messages[i]);
    }
}

/// Bytes of sample_messages(). They are what every released program of protocol version 1 sends: a
/// change here is a change of kProtocolVersion.
TEST(Codec, WritesTheGoldenBytesOfProtocolVersion1) {
    const std::vector<std::string> golden = {
        "0a260807120873696d2d316132621a0d672b2b203132207838362d3634211032547698badcfe2802",
        ("1268080312430a076d617463682d3712086c6f636b737465701a056172656e612213626f6479207b2069"
         "643a2031207d202320c3a929efcdab8967452301307838044003480550b0091a0873696d2d3161326222"
         "0e636c616e6720313420733339307828d80430093802"),
        "1a200802120b636f6e6669672e736565641a0f796f75727320312c206d696e652032",
        "220c08d804118097a6b5c4d3e2f1",
        "2a25080310d604180320062a1201020304050680818283000000000000000030d50438959aef3a",
        ("324c08d60410d8041802200228063218010203040506090a000000008081828300000000000000003a04"
         "00010002421008d90410ce0418959aef3a20dc0b2801420c08d70410cc04180120142801"),
        "3a1e0803120c08d604118197a6b5c4d3e2f1120c08d704118297a6b5c4d3e2f1",
        "4210080110021801200328f093093202dead",
        "4a0408021001",
        "521808d50410d704198397a6b5c4d3e2f1218497a6b5c4d3e2f1",
        "5a1d080510af09180222146e6f20696e70757420666f722032303030206d73",
    };
    const std::vector<Message> messages = sample_messages();
    ASSERT_EQ(golden.size(), messages.size());
    EXPECT_EQ(kProtocolVersion, 1U);
    for (std::size_t i = 0; i < messages.size(); ++i) {
        EXPECT_EQ(hex(encode(messages[i])), golden[i]) << kind_name(messages[i]);
    }
}

TEST(Codec, WritesAPacketOfTheProto) {
    const std::vector<Message> messages = sample_messages();
    for (std::size_t i = 0; i < messages.size(); ++i) {
        const std::vector<std::byte> bytes = encode(messages[i]);
        wire::Packet packet;
        ASSERT_TRUE(packet.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
        EXPECT_EQ(static_cast<std::size_t>(packet.message_case()), i + 1);
        const google::protobuf::FieldDescriptor* field =
            wire::Packet::descriptor()->FindFieldByNumber(static_cast<int>(i) + 1);
        EXPECT_EQ(field->message_type()->name(), kind_name(messages[i]));
        EXPECT_EQ(packet.SerializeAsString(),
                  std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    }
}

TEST(Codec, GivesBackDefaults) {
    const std::vector<Message> messages = {
        Hello{}, Refuse{}, Ready{}, InputBatch{}, Confirmation{}, HashReport{}, Welcome{}, End{}};
    for (const Message& message : messages) {
        const Result<Message> decoded = decode(encode(message));
        ASSERT_TRUE(decoded.ok()) << decoded.error().message;
        EXPECT_TRUE(same(decoded.value(), message)) << kind_name(message);
    }
}

TEST(Codec, ReplacesTheReusedBuffer) {
    std::vector<std::byte> buffer(5'000, std::byte{0xff});
    for (const Message& message : sample_messages()) {
        encode(message, buffer);
        EXPECT_EQ(buffer, encode(message));
    }
}

TEST(Codec, SendsInputsAndConfirmationsBestEffortAlone) {
    for (const Message& message : sample_messages()) {
        const bool expected = !std::holds_alternative<InputBatch>(message) &&
                              !std::holds_alternative<Confirmation>(message);
        EXPECT_EQ(is_reliable(message), expected) << kind_name(message);
    }
}

TEST(Codec, SpendsNoByteOnTheUnusedTailOfInputs) {
    InputBatch batch;
    batch.inputs.assign(100, sample_input(InputStatus::confirmed, 1, 6));
    EXPECT_LT(encode(batch).size(), 100 * 6 + 20U);
    batch.inputs[50] = sample_input(InputStatus::confirmed, 1, 32);
    const Result<Message> decoded = decode(encode(batch));
    ASSERT_TRUE(decoded.ok());
    EXPECT_TRUE(same(decoded.value(), batch));
}

TEST(Codec, GivesBackInputsThatAreAllZero) {
    Confirmation confirmation;
    confirmation.first_tick = 1;
    for (const InputStatus status : {InputStatus::confirmed, InputStatus::disconnected}) {
        confirmation.ticks.assign(3, {{sample_input(status, 0, 0), sample_input(status, 0, 0)}});
        const Result<Message> decoded = decode(encode(confirmation));
        ASSERT_TRUE(decoded.ok()) << decoded.error().message;
        EXPECT_TRUE(same(decoded.value(), confirmation));
    }
}

TEST(Codec, CarriesTheLargestOfEachKind) {
    const std::string name(kNameSizeBytesMax, 'n');
    const std::string text(kTextSizeBytesMax, 't');
    Welcome welcome;
    welcome.config = sample_config();
    welcome.config.match = name;
    welcome.config.mode = name;
    welcome.config.scene_name.assign(kSceneNameSizeBytesMax, 's');
    welcome.config.scene_text.assign(kConfigSceneTextSizeBytesMax, 's');
    welcome.sim_version = name;
    welcome.build_info = text;
    InputBatch batch;
    batch.inputs.assign(kInputBatchTicksMax, sample_input(InputStatus::confirmed, 1, 32));
    HashReport report;
    report.entries.assign(kHashReportEntriesMax, {Tick{1} << 40U, ~std::uint64_t{0}});
    Chunk chunk;
    chunk.transfer = 0xffffffffU;
    chunk.blob_size_bytes = static_cast<std::uint32_t>(kBlobSizeBytesMax);
    chunk.count = 0x2000;
    chunk.index = chunk.count - 1;
    chunk.bytes.assign(kChunkSizeBytesMax, std::byte{0xff});
    Confirmation confirmation;
    confirmation.ticks.assign(
        200, {std::vector<SlotInput>(8, sample_input(InputStatus::substituted, 1, 32))});
    confirmation.acks.assign(kPlayersMax,
                             {Tick{1} << 40U, Tick{1} << 40U, ~std::uint64_t{0}, ~0U, true});
    for (const Message& message : std::vector<Message>{Hello{1, name, text, 1, 1},
                                                       welcome,
                                                       Refuse{RefuseReason::config, name, text},
                                                       batch,
                                                       report,
                                                       chunk,
                                                       confirmation,
                                                       End{EndReason::failed, 1, 1, text}}) {
        const Status allowed = check(message);
        ASSERT_TRUE(allowed.ok()) << allowed.error().message;
        const std::vector<std::byte> bytes = encode(message);
        EXPECT_LE(bytes.size(), kMessageSizeBytesMax) << kind_name(message);
        const Result<Message> decoded = decode(bytes);
        ASSERT_TRUE(decoded.ok()) << decoded.error().message;
        EXPECT_TRUE(same(decoded.value(), message)) << kind_name(message);
    }
}

TEST(Codec, CutsAndCleansTextsForAPerson) {
    const std::string too_long = std::string(kTextSizeBytesMax - 1, 'x') + "\xc3\xa9 and more";
    const Result<Message> end = decode(encode(End{EndReason::failed, 1, 1, too_long}));
    ASSERT_TRUE(end.ok());
    EXPECT_EQ(std::get<End>(end.value()).message, std::string(kTextSizeBytesMax - 1, 'x'));
    const Result<Message> refuse =
        decode(encode(Refuse{RefuseReason::config, "field", "a\xff\xc3z"}));
    ASSERT_TRUE(refuse.ok());
    EXPECT_EQ(std::get<Refuse>(refuse.value()).message, "a??z");
}

TEST(Codec, IgnoresFieldsOfNewerVersions) {
    std::vector<std::byte> bytes = encode(Ready{5, 6});
    // Field 99 of Ready, a varint: tag 99 << 3 | 0 in two bytes, value 1.
    for (const unsigned value : {0x98U, 0x06U, 0x01U}) {
        bytes.push_back(static_cast<std::byte>(value));
    }
    bytes[1] = static_cast<std::byte>(std::to_integer<unsigned>(bytes[1]) + 3);
    const Result<Message> decoded = decode(bytes);
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    EXPECT_TRUE(same(decoded.value(), Ready{5, 6}));
}

} // namespace
} // namespace lockwind
