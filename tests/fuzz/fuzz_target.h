#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// One target a program: it must take any bytes, and answers only by not crashing. libFuzzer's
// names, so that libFuzzer (preset fuzz) and smoke_main.cpp (every preset) both call it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace lockwind::fuzz {

inline std::span<const std::byte> bytes_of(const std::uint8_t* data, std::size_t size) {
    return std::as_bytes(std::span(data, size));
}

} // namespace lockwind::fuzz
