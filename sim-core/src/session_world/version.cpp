#include "session_world/version.h"

#include "world/state.h"

#include "lockwind/overflow.h"
#include "lockwind/world_simulation.h"

#include <array>

namespace lockwind {

namespace {

/// FNV-1a, because it runs at compile time.
constexpr std::uint64_t fold(std::uint64_t hash, std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
        hash = (hash ^ (value & 0xffU)) * 0x100000001b3U;
        value >>= 8U;
    }
    return hash;
}

constexpr std::uint64_t fold(std::uint64_t hash, std::string_view text) {
    for (const char letter : text) {
        hash = fold(hash, static_cast<std::uint64_t>(letter));
    }
    return fold(hash, text.size());
}

/// Offsets and sizes are this compiler's, so that a layout which differs is another version.
constexpr std::uint64_t fold(std::uint64_t hash, StateSchema schema) {
    for (const SectionDescriptor& section : schema) {
        hash = fold(fold(hash, section.name), section.stride_bytes);
        for (const FieldDescriptor& field : section.fields) {
            hash = fold(fold(hash, field.name), field.offset_bytes);
            hash = fold(fold(hash, field.components), field.fraction_bits);
            hash = fold(hash, static_cast<std::uint64_t>(field.type));
        }
    }
    return hash;
}

constexpr std::array<char, 16> hex(std::uint64_t value) {
    std::array<char, 16> digits{};
    for (std::size_t index = digits.size(); index > 0; --index) {
        digits[index - 1] = "0123456789abcdef"[value & 0xfU];
        value >>= 4U;
    }
    return digits;
}

constexpr std::array<char, 16> kSimVersion = hex(fold(LOCKWIND_SOURCE_HASH, kWorldSections));

#if defined(__clang__)
#define LOCKWIND_COMPILER "clang "
#else
#define LOCKWIND_COMPILER "g++ "
#endif

#if LOCKWIND_ARITHMETIC_CHECKED
#define LOCKWIND_ARITHMETIC_NAME "checked"
#else
#define LOCKWIND_ARITHMETIC_NAME "wrapping"
#endif

} // namespace

std::string_view sim_version() {
    return {kSimVersion.data(), kSimVersion.size()};
}

std::string_view build_info() {
    return LOCKWIND_COMPILER __VERSION__ "; " LOCKWIND_BUILD_FLAGS "; " LOCKWIND_ARITHMETIC_NAME
                                         " arithmetic; " LOCKWIND_BUILD_ARCHITECTURE
                                         "; commit " LOCKWIND_BUILD_COMMIT;
}

} // namespace lockwind
