#include "lockwind/player_input.h"

namespace lockwind {

namespace {

void put(std::uint16_t value, std::uint8_t* bytes) {
    bytes[0] = static_cast<std::uint8_t>(value & 0xffU);
    bytes[1] = static_cast<std::uint8_t>(value >> 8U);
}

std::uint16_t get(const std::uint8_t* bytes) {
    return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8U);
}

} // namespace

void encode(const PlayerInput& input, SlotInput& out) {
    out.bytes = {};
    put(static_cast<std::uint16_t>(input.thrust), &out.bytes[0]);
    put(static_cast<std::uint16_t>(input.turn), &out.bytes[2]);
    put(input.buttons, &out.bytes[4]);
}

PlayerInput decode_player_input(const SlotInput& input) {
    PlayerInput result;
    result.thrust = static_cast<std::int16_t>(get(&input.bytes[0]));
    result.turn = static_cast<std::int16_t>(get(&input.bytes[2]));
    result.buttons = get(&input.bytes[4]);
    return result;
}

} // namespace lockwind
