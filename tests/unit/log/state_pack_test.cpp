#include "log/state_pack.h"
#include "tests/unit/log/log_fixture.h"

#include <gtest/gtest.h>
#include <random>

namespace lockwind::test {
namespace {

std::vector<std::byte> random_state(std::size_t size_bytes, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<std::byte> state(size_bytes);
    for (std::byte& byte : state) {
        byte = static_cast<std::byte>(random() & 0xffU);
    }
    return state;
}

TEST(StatePack, GivesBackWhatItPacked) {
    for (const std::size_t size : {0U, 1U, 100U, 4096U, 1'000'003U}) {
        const std::vector<std::byte> state = random_state(size, 1);
        const auto unpacked = unpack_state(pack_state(state));
        ASSERT_TRUE(unpacked.ok()) << size;
        EXPECT_EQ(unpacked.value(), state);
    }
}

TEST(StatePack, RefusesAnyOtherBytes) {
    const std::vector<std::byte> packed = pack_state(golden_state());
    EXPECT_FALSE(unpack_state({}).ok());
    EXPECT_FALSE(unpack_state(random_state(100, 2)).ok());
    for (std::size_t size = 0; size < packed.size(); ++size) {
        EXPECT_FALSE(unpack_state(std::span(packed).first(size)).ok()) << size;
    }
    std::vector<std::byte> longer = packed;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(unpack_state(longer).ok());
}

TEST(StatePack, RefusesASizeThatNoFrameOfItsLengthCanHave) {
    // Frame header with an 8-byte content size of 2^40, then an empty last block.
    const std::vector<std::uint8_t> bomb{
        0x28, 0xb5, 0x2f, 0xfd, 0xe0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0};
    const auto unpacked = unpack_state(std::as_bytes(std::span(bomb)));
    ASSERT_FALSE(unpacked.ok());
    EXPECT_NE(unpacked.error().message.find("claims 1099511627776 bytes"), std::string::npos);
}

TEST(StateChain, CostsLittleForWhatDidNotChange) {
    std::vector<std::byte> state = random_state(300'000, 3);
    StateChainPacker packer;
    StateChainUnpacker unpacker;
    std::size_t later_bytes = 0;
    for (std::size_t step = 0; step < 10; ++step) {
        state[step * 20'000] ^= std::byte{1};
        const std::vector<std::byte> packed = packer.pack(state);
        later_bytes += step == 0 ? 0 : packed.size();
        const auto unpacked = unpacker.unpack(packed);
        ASSERT_TRUE(unpacked.ok());
        EXPECT_TRUE(std::equal(
            state.begin(), state.end(), unpacked.value().begin(), unpacked.value().end()));
    }
    EXPECT_LT(later_bytes, 9 * 1000U);
}

TEST(StateChain, StaysBrokenBehindABrokenLink) {
    StateChainPacker packer;
    const std::vector<std::byte> first = packer.pack(random_state(1000, 4));
    StateChainUnpacker unpacker;
    EXPECT_FALSE(unpacker.unpack(random_state(10, 5)).ok());
    EXPECT_FALSE(unpacker.unpack(first).ok());
}

} // namespace
} // namespace lockwind::test
