#include "codec/codec.h"
#include "tests/unit/codec/sample_messages.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <new>
#include <random>

namespace {

// Bytes that operator new has given out; this program has one thread.
std::size_t g_allocated_bytes = 0;

} // namespace

void* operator new(std::size_t size) {
    g_allocated_bytes += size;
    void* memory = std::malloc(size); // NOLINT(cppcoreguidelines-no-malloc): this is operator new
    if (memory == nullptr) {
        throw std::bad_alloc();
    }
    return memory;
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
    std::free(memory);
}

namespace lockwind {
namespace {

/// Bytes that decode() may take, for good or for a moment, for `size_bytes` received. A wire byte
/// costs most in an empty submessage: two bytes on the wire, some 60 in memory.
constexpr std::size_t allocation_bytes_max(std::size_t size_bytes) {
    return 4'096 + 48 * size_bytes;
}

class Mutator {
public:
    explicit Mutator(std::uint32_t seed) : random_(seed) {}

    std::vector<std::byte> next() {
        if (below(10) == 0) {
            return noise();
        }
        std::vector<std::byte> bytes = encode(samples_[below(samples_.size())]);
        const std::size_t edits = 1 + below(4);
        for (std::size_t i = 0; i < edits; ++i) {
            edit(bytes);
        }
        return bytes;
    }

private:
    std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_()) % bound; }
    std::byte any_byte() { return static_cast<std::byte>(below(256)); }

    std::vector<std::byte> noise() {
        std::vector<std::byte> bytes(below(300));
        for (std::byte& byte : bytes) {
            byte = any_byte();
        }
        return bytes;
    }

    void edit(std::vector<std::byte>& bytes) {
        const std::size_t at = bytes.empty() ? 0 : below(bytes.size());
        const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        switch (below(6)) {
        case 0:
            bytes.insert(place, any_byte());
            break;
        case 1:
            bytes.resize(at);
            break;
        case 2:
            bytes.insert(place, 1 + below(9), std::byte{0xff});
            break;
        case 3:
            bytes.insert(bytes.end(), bytes.begin(), place);
            break;
        default:
            if (!bytes.empty()) {
                bytes[at] ^= static_cast<std::byte>(1U << below(8));
            }
        }
        // Keeps the frame right every other time, so that the edit is not caught at the door.
        if (below(2) == 0 && bytes.size() > 2 && bytes.size() - 2 < 128) {
            bytes[1] = static_cast<std::byte>(bytes.size() - 2);
        }
    }

    std::mt19937 random_;
    std::vector<Message> samples_ = sample_messages();
};

TEST(CodecMutation, NeverCrashesNorAllocatesMuchOnDamagedMessages) {
    constexpr int kCount = 20'000;
    Mutator mutator(20'240'601);
    int accepted = 0;
    int refused = 0;
    for (int i = 0; i < kCount; ++i) {
        const std::vector<std::byte> bytes = mutator.next();
        g_allocated_bytes = 0;
        const Result<Message> decoded = decode(bytes);
        ASSERT_LE(g_allocated_bytes, allocation_bytes_max(bytes.size())) << hex(bytes);
        if (!decoded.ok()) {
            ++refused;
            ASSERT_FALSE(decoded.error().message.empty());
            continue;
        }
        ++accepted;
        // What was accepted is a message like any other: it can be sent and read again.
        ASSERT_TRUE(check(decoded.value()).ok()) << hex(bytes);
        const Result<Message> again = decode(encode(decoded.value()));
        ASSERT_TRUE(again.ok()) << hex(bytes);
        ASSERT_TRUE(same(again.value(), decoded.value())) << hex(bytes);
    }
    EXPECT_GT(accepted, kCount / 20);
    EXPECT_GT(refused, kCount / 4);
}

TEST(CodecMutation, AllocatesLittleForTheCostliestMessages) {
    const auto decode_cost = [](unsigned kind, const std::string& unit) {
        std::vector<std::byte> body;
        while (body.size() + unit.size() < kMessageSizeBytesMax - 4) {
            for (const char c : unit) {
                body.push_back(static_cast<std::byte>(c));
            }
        }
        std::vector<std::byte> bytes = {static_cast<std::byte>(kind << 3U | 2U)};
        bytes.push_back(static_cast<std::byte>((body.size() & 0x7fU) | 0x80U));
        bytes.push_back(static_cast<std::byte>((body.size() >> 7U & 0x7fU) | 0x80U));
        bytes.push_back(static_cast<std::byte>(body.size() >> 14U));
        bytes.insert(bytes.end(), body.begin(), body.end());
        g_allocated_bytes = 0;
        (void)decode(bytes);
        EXPECT_LE(g_allocated_bytes, allocation_bytes_max(bytes.size()));
        return g_allocated_bytes;
    };
    using namespace std::string_literals;
    EXPECT_GT(decode_cost(6, "\x42\x00"s), 500'000U) << "empty acks reach the parser";
    decode_cost(6, "\x9a\x06\x00"s);     // unknown fields: empty strings
    decode_cost(6, "\x98\x06\x00"s);     // unknown fields: integers
    decode_cost(6, "\x9b\x06\x9c\x06"s); // unknown fields: groups
    EXPECT_LT(decode_cost(7, "\x12\x00"s), 4'096U) << "refused by its size, before it is parsed";
}

} // namespace
} // namespace lockwind
