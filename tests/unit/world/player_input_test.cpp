#include "lockwind/player_input.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

TEST(PlayerInput, IsSixBytesLittleEndian) {
    SlotInput slot;
    slot.status = InputStatus::predicted;
    slot.bytes.fill(0xee);
    encode({-2, 0x0102, 0x0304}, slot);
    const std::array<std::uint8_t, kPlayerInputSizeBytes> expected{0xfe, 0xff, 2, 1, 4, 3};
    for (std::size_t index = 0; index < slot.bytes.size(); ++index) {
        EXPECT_EQ(slot.bytes[index], index < expected.size() ? expected[index] : 0) << index;
    }
    EXPECT_EQ(slot.status, InputStatus::predicted);
}

TEST(PlayerInput, RoundTripsExtremes) {
    for (const PlayerInput& input : {PlayerInput{},
                                     PlayerInput{32767, -32767, 0xffff},
                                     PlayerInput{-32768, 32767, PlayerInput::kJump},
                                     PlayerInput{1, -1, PlayerInput::kShoot}}) {
        SlotInput slot;
        encode(input, slot);
        EXPECT_EQ(decode_player_input(slot), input);
    }
}

TEST(PlayerInput, ADisconnectedSlotAsksForNothing) {
    EXPECT_EQ(decode_player_input(SlotInput{}), PlayerInput{});
}

} // namespace
} // namespace lockwind
