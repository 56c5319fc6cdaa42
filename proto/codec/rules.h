#pragma once

#include "codec/codec.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lockwind {

/// Collects the first broken rule of one message.
class Rules {
public:
    Rules(std::string_view kind, const MessageLimits& limits) : kind_(kind), limits_(limits) {}

    const MessageLimits& limits() const { return limits_; }
    bool kept() const { return !broken_; }
    Status status() const;

    /// min <= value <= max.
    void
    in_range(std::string_view field, std::uint64_t value, std::uint64_t min, std::uint64_t max);
    void at_most(std::string_view field, std::uint64_t value, std::uint64_t max) {
        in_range(field, value, 0, max);
    }
    void equal(std::string_view field,
               std::uint64_t value,
               std::uint64_t expected,
               std::string_view expected_name);
    /// At most size_bytes_max bytes of UTF-8.
    void text(std::string_view field, std::string_view value, std::size_t size_bytes_max);
    void slot(std::uint64_t value) { in_range("slot", value, 0, limits_.players_max - 1); }
    void tick(std::string_view field, Tick value) { at_most(field, value, limits_.tick_max); }
    void require(bool kept, std::string_view rule);

private:
    void fail(const std::string& rule);

    std::string_view kind_;
    const MessageLimits& limits_;
    std::optional<Error> broken_;
};

/// The rules of each kind, on what has been read or is about to be written.
void apply_rules(const Hello& message, Rules& rules);
void apply_rules(const Welcome& message, Rules& rules);
void apply_rules(const Refuse& message, Rules& rules);
void apply_rules(const Ready& message, Rules& rules);
void apply_rules(const InputBatch& message, Rules& rules);
void apply_rules(const Confirmation& message, Rules& rules);
void apply_rules(const HashReport& message, Rules& rules);
void apply_rules(const Chunk& message, Rules& rules);
void apply_rules(const ChunkAck& message, Rules& rules);
void apply_rules(const DesyncQuery& message, Rules& rules);
void apply_rules(const End& message, Rules& rules);

inline constexpr auto kRefuseReasonMax = static_cast<std::uint64_t>(RefuseReason::misconduct);
inline constexpr auto kEndReasonMax = static_cast<std::uint64_t>(EndReason::dropped);
inline constexpr auto kBlobKindMax = static_cast<std::uint64_t>(BlobKind::desync_report);
inline constexpr auto kSentStatusMax = static_cast<std::uint64_t>(InputStatus::disconnected);

/// Size of an input without the zero bytes at its end.
std::size_t input_size_bytes(const SlotInput& input);
/// Of the longest input in a message, by the same measure.
std::size_t input_size_bytes(const InputBatch& message);
std::size_t input_size_bytes(const Confirmation& message);

} // namespace lockwind
